/* What the springs learn of a push and how they are taken back, in numbers: by the header's prose and the comments
 * beside the constants, for 0.6 m/s and 8 m/s^2, a leg of 0.9 m and a first push-off of 40 mm. */
#include "tests/support/springs_rig.h"

#include <math.h>

static const double harmless_m = 0.12 * 0.04;

/* What a motor comes back in a time, at twice its acceleration. */
static double way_m(double time_s)
{
    return harmless_m + 0.5 * 2.0 * 8.0 * time_s * time_s;
}

/* A push of the left leg: toe-off so long after the opening, found so long before its tick. */
static void push_once(int toe_off_ticks, double before_tick_s)
{
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    ticks(toe_off_ticks);
    gait.event[GAIT_LIFT_OFF] = (struct gait_event){.happened = true,
                                                    .side = SIDE_LEFT,
                                                    .tick = input.tick + 1,
                                                    .before_tick_s = (real)before_tick_s};
    tick();
    ticks(200);
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    ticks(5);
}

/* The first as it is, then a fifth of what is longer and seven tenths of what is shorter; 0.4 s at most. */
START_TEST(the_mean_time_to_toe_off)
{
    push_once(120, 0.0);
    assert_close(springs.push_s[SIDE_LEFT], 0.12, 1e-6, 0.0);
    push_once(160, 0.0);
    assert_close(springs.push_s[SIDE_LEFT], 0.128, 1e-6, 0.0);
    push_once(100, 0.0);
    assert_close(springs.push_s[SIDE_LEFT], 0.128 - 0.7 * 0.028, 1e-6, 0.0);
    setup();
    push_once(120, 0.005); /* found between two ticks */
    assert_close(springs.push_s[SIDE_LEFT], 0.115, 1e-6, 0.0);
    setup();
    push_once(450, 0.0);
    assert_close(springs.push_s[SIDE_LEFT], 0.4, 1e-6, 0.0);
    setup();
    push_once(1, 0.0009); /* a millisecond at least */
    assert_close(springs.push_s[SIDE_LEFT], 0.001, 1e-6, 0.0);
    assert_close(springs.push_s[SIDE_RIGHT], 0.0, 0.0, 0.0); /* each leg its own */
}
END_TEST

/* A latch that was not armed, or opened with the toe-off only, tells of no push. */
START_TEST(no_time_is_learned_without_a_release)
{
    event(GAIT_HEEL_STRIKE, SIDE_LEFT); /* never armed: the step has not decided */
    ticks(50);
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    ticks(50);
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    assert_close(springs.push_s[SIDE_LEFT], 0.0, 0.0, 0.0);
}
END_TEST

/* A fifth of a longer extension, seven tenths of a shorter one, at the time at which the foot leaves: 0.1 s before
 * any is known. */
START_TEST(the_mean_extension_at_toe_off)
{
    static const struct {
        double known_s, before_m, extension_m, after_m;
        int ticks; /* from the opening to where it is learned */
    } cases[] = {
        {0.0, 0.0, 0.01, 0.002, 100}, {0.05, 0.01, 0.02, 0.012, 50}, {0.05, 0.02, 0.01, 0.013, 50}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            setup();
            springs.push_s[side] = (real)cases[i].known_s;
            springs.left_m[side] = (real)cases[i].before_m;
            input.sea[side].latch = LATCH_OPEN;
            input.leg[side].ankle_extension_m = (real)cases[i].extension_m;
            ticks(cases[i].ticks);
            assert_close(springs.left_m[side], cases[i].before_m, 1e-9, 0.0);
            ticks(2);
            assert_close(springs.left_m[side], cases[i].after_m, 1e-7, 0.0);
            ticks(100); /* once a push */
            assert_close(springs.left_m[side], cases[i].after_m, 1e-7, 0.0);
        }
    }
}
END_TEST

/* So far as the motor is back in the time of a push less its lead: 6 % of it, and 10 ms, or 30 ms in a person who was
 * not fitted. */
START_TEST(the_reach_after_a_push)
{
    static const struct {
        double push_s, left_m, bias_s;
    } cases[] = {{0.06, 0.0, 0.0},     {0.06, 0.003, 0.0}, {0.06, 0.003, 0.02},
                 {0.06, 0.003, -0.02}, {0.02, 0.002, 0.0}, {0.12, 0.01, 0.01}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            setup();
            *(side == SIDE_LEFT ? &params.toe_off_bias_left_s : &params.toe_off_bias_right_s) =
                (real)cases[i].bias_s;
            springs.push_s[side] = (real)cases[i].push_s;
            springs.left_m[side] = (real)cases[i].left_m;
            springs.open[side] = true; /* until now */
            tick();
            const double lead_s = 0.06 * cases[i].push_s + (cases[i].bias_s != 0.0 ? 0.01 : 0.03);
            const double back_s = fmax(cases[i].push_s - lead_s, 0.0);
            assert_close(springs.reach_m[side], cases[i].left_m + way_m(back_s), 1e-6, 0.0);
            assert_close(springs.reach_m[1 - side], harmless_m, 1e-7, 0.0);
            ck_assert(!springs.open[side]);
        }
    }
}
END_TEST

/* It sets off when what it has to come back is what it can in the time that is left, less the lead. */
START_TEST(the_motor_sets_off_in_time)
{
    static const struct {
        double left_m, extension_m;
    } cases[] = {{0.0, 0.0}, {0.01, 0.0}, {0.01, 0.015}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setup();
        springs.push_s[SIDE_LEFT] = 0.2f;
        springs.left_m[SIDE_LEFT] = (real)cases[i].left_m;
        springs.reach_m[SIDE_LEFT] = 1.0f;
        load_left();
        ck_assert(request[SIDE_LEFT].latch_armed);
        assert_close(request[SIDE_LEFT].precompression_m, 0.04, 1e-6, 0.0);
        input.sea[SIDE_LEFT].latch = LATCH_OPEN;
        input.leg[SIDE_LEFT].ankle_extension_m = (real)cases[i].extension_m;
        int waited = 0;
        while (springs.sea[SIDE_LEFT].phase == SEA_ARMED && waited < 300) {
            tick();
            waited++;
        }
        ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADING);
        const double ankle_m = fmax(cases[i].left_m, cases[i].extension_m);
        const double back_s = sqrt((0.04 - ankle_m - harmless_m) / 8.0);
        const double lead_s = 0.06 * 0.2 + 0.03;
        assert_close(1e-3 * waited, 0.2 - lead_s - back_s, 0.0021, 0.0);
        /* And goes back at 1.2 times the speed and twice the acceleration of a load. */
        assert_close(springs.sea[SIDE_LEFT].stop_speed_m_s, 0.72, 1e-6, 0.0);
        assert_close(springs.sea[SIDE_LEFT].stop_acceleration_m_s2, 16.0, 1e-5, 0.0);
    }
}
END_TEST

/* Back by 0.3 % of the leg from its farthest. */
START_TEST(an_ankle_comes_back_by_2_7_mm)
{
    for (int enough = 0; enough < 2; enough++) {
        setup();
        springs.push_s[SIDE_LEFT] = 0.3f;
        springs.reach_m[SIDE_LEFT] = 1.0f;
        load_left();
        input.sea[SIDE_LEFT].latch = LATCH_OPEN;
        input.leg[SIDE_LEFT].ankle_extension_m = 0.01f;
        ticks(5);
        input.leg[SIDE_LEFT].ankle_extension_m = 0.02f;
        ticks(5);
        input.leg[SIDE_LEFT].ankle_extension_m = enough ? 0.0172f : 0.0174f;
        ticks(5);
        ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, enough ? SEA_UNLOADING : SEA_ARMED);
    }
}
END_TEST

START_TEST(a_first_push_is_loaded_to_12_percent)
{
    load_left();
    assert_close(request[SIDE_LEFT].precompression_m, harmless_m, 1e-6, 0.0);
}
END_TEST

/* Behind its reference by more than 0.6 % of the leg: 5.4 mm, to either side. */
START_TEST(a_motor_is_behind_by_5_4_mm)
{
    static const struct {
        double measured_m;
        bool behind;
    } cases[] = {{0.0053, false}, {-0.0053, false}, {0.0055, true}, {-0.0055, true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            setup();
            input.sea[side].precompression_m = (real)cases[i].measured_m;
            springs_command(&springs, &params, &input, SUPERVISOR_WALKING, &gait, request);
            ck_assert_uint_eq(springs.watch.leg[side].behind_ticks, cases[i].behind ? 1 : 0);
            ck_assert_uint_eq(springs.watch.leg[1 - side].behind_ticks, 0);
        }
    }
}
END_TEST

/* Out past its target a compass' motor is released all the same: its energy is its own. */
START_TEST(a_compass_s_motor_may_run_past_its_target)
{
    params.body = (real)BODY_COMPASS;
    springs_begin(&springs, &params, &input);
    load_left();
    input.sea[SIDE_LEFT].precompression_m = 1.1f * params.r0_max_m;
    springs_command(&springs, &params, &input, SUPERVISOR_WALKING, &gait, request);
    ck_assert(request[SIDE_LEFT].latch_armed);
}
END_TEST

/* Armed only while assisting, in the stance of that leg, with the other's strike near. */
START_TEST(a_latch_is_armed_in_its_own_stance_near_the_strike)
{
    load_left();
    ck_assert(request[SIDE_LEFT].latch_armed);
    ck_assert(!request[SIDE_RIGHT].latch_armed);
    gait.strike_near = false;
    tick();
    ck_assert(!request[SIDE_LEFT].latch_armed);
    gait.strike_near = true;
    gait.stance = SIDE_RIGHT;
    tick();
    ck_assert(!request[SIDE_LEFT].latch_armed);
    gait.stance = SIDE_LEFT;
    springs_command(&springs, &params, &input, SUPERVISOR_UNLOADING, &gait, request);
    ck_assert(!request[SIDE_LEFT].latch_armed);
    tick();
    ck_assert(request[SIDE_LEFT].latch_armed);
}
END_TEST

/* Pushed by more than the tolerance of 1 mm, behind an open latch, in swing. */
START_TEST(a_foot_is_dragged_by_more_than_the_tolerance)
{
    static const struct {
        double pushed_m;
        enum latch_state latch;
        bool swings, drags;
    } cases[] = {{0.00101, LATCH_OPEN, true, true},
                 {0.00099, LATCH_OPEN, true, false},
                 {0.01, LATCH_CLOSED, true, false},
                 {0.01, LATCH_UNKNOWN, true, false},
                 {0.01, LATCH_OPEN, false, false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            setup();
            springs.swings[side] = cases[i].swings;
            springs.toe_off_tick[side] = input.tick;
            input.sea[side].latch = cases[i].latch;
            for (int k = 0; k < 60; k++) {
                input.sea[side].precompression_m = 0.02f;
                input.leg[side].ankle_extension_m = (real)(0.02 - cases[i].pushed_m);
                tick();
            }
            ck_assert_uint_eq(springs.watch.leg[side].count[PUSH_DRAGS], cases[i].drags ? 1 : 0);
        }
    }
}
END_TEST

/* A strike ends a leg's swing: what pushes then is a stance. */
START_TEST(a_strike_ends_the_swing)
{
    load_left();
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    ck_assert(springs.swings[SIDE_LEFT] && !springs.swings[SIDE_RIGHT]);
    ck_assert_uint_eq(springs.toe_off_tick[SIDE_LEFT], input.tick);
    event(GAIT_HEEL_STRIKE, SIDE_LEFT);
    ck_assert(!springs.swings[SIDE_LEFT]);
}
END_TEST

/* Nothing is loaded without assistance, nor where there is no drive. */
START_TEST(a_leg_without_a_drive_or_assistance_is_not_loaded)
{
    input.sea[SIDE_LEFT].absent = true;
    load_left();
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADED);
    setup();
    decision.assists = false;
    load_left();
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADED);
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    ck_assert_int_eq(outcome, PUSH_NONE); /* and none was prescribed */
}
END_TEST

/* The first stance of a walk began without a strike: loaded in single support, once. */
START_TEST(the_first_stance_is_loaded_without_a_strike)
{
    input.tick++;
    gait.phase = PHASE_DOUBLE_SUPPORT;
    (void)springs_follow(&springs, &decision, &input, &gait, true);
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADED);
    gait.phase = PHASE_SINGLE_SUPPORT;
    (void)springs_follow(&springs, &decision, &input, &gait, false);
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADED);
    (void)springs_follow(&springs, &decision, &input, &gait, true);
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_LOADING);
    ck_assert_int_eq(springs.sea[SIDE_RIGHT].phase, SEA_UNLOADED);
    springs.sea[SIDE_LEFT].phase = SEA_ARMED;
    (void)springs_follow(&springs, &decision, &input, &gait, true);
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_ARMED);
}
END_TEST

/* A better answer moves the motor already; only the last one arms the latch. */
START_TEST(an_answer_that_is_not_final_arms_nothing)
{
    springs.reach_m[SIDE_LEFT] = 1.0f;
    decision.improved = true;
    decision.load_m = 0.03f;
    ticks(400);
    assert_close(request[SIDE_LEFT].precompression_m, 0.03, 1e-6, 0.0);
    ck_assert(!request[SIDE_LEFT].latch_armed);
    decision.new_step = true;
    decision.load_m = 0.02f;
    ticks(400);
    assert_close(request[SIDE_LEFT].precompression_m, 0.02, 1e-6, 0.0);
    ck_assert(request[SIDE_LEFT].latch_armed);
}
END_TEST

/* A latch that closes before the step has decided: loaded from there on, and not armed before it has. */
START_TEST(what_waited_without_a_decision_is_not_armed)
{
    springs.reach_m[SIDE_LEFT] = 1.0f;
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    tick();
    event(GAIT_HEEL_STRIKE, SIDE_LEFT);
    ticks(10);
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    springs.reach_m[SIDE_LEFT] = 1.0f;
    ticks(400);
    ck_assert(request[SIDE_LEFT].precompression_m > 0.0f);
    ck_assert(!request[SIDE_LEFT].latch_armed);
    decision.new_step = true;
    ticks(400);
    ck_assert(request[SIDE_LEFT].latch_armed);
}
END_TEST

/* A stop gives up what waits for a latch, and what was prescribed. */
START_TEST(a_stop_gives_up_what_waits)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        springs.waits[side] = true;
        push_watch_prescribe(&springs.watch, (enum side)side);
    }
    springs_stop(&springs, &input);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert(!springs.waits[side]);
        ck_assert(!springs.watch.leg[side].prescribed);
    }
    assert_close(springs.stop.speed_m_s, 1.2 * 0.6, 1e-6, 0.0);
    assert_close(springs.stop.acceleration_m_s2, 1.6 * 8.0, 1e-5, 0.0);
    assert_close(springs.stop.left_behind_m, 0.009, 1e-7, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("springs' numbers");
    TCase *tests = tcase_create("person");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, the_mean_time_to_toe_off);
    tcase_add_test(tests, no_time_is_learned_without_a_release);
    tcase_add_test(tests, the_mean_extension_at_toe_off);
    tcase_add_test(tests, the_reach_after_a_push);
    tcase_add_test(tests, the_motor_sets_off_in_time);
    tcase_add_test(tests, an_ankle_comes_back_by_2_7_mm);
    tcase_add_test(tests, a_first_push_is_loaded_to_12_percent);
    tcase_add_test(tests, a_motor_is_behind_by_5_4_mm);
    tcase_add_test(tests, a_compass_s_motor_may_run_past_its_target);
    tcase_add_test(tests, a_latch_is_armed_in_its_own_stance_near_the_strike);
    tcase_add_test(tests, a_foot_is_dragged_by_more_than_the_tolerance);
    tcase_add_test(tests, a_strike_ends_the_swing);
    tcase_add_test(tests, a_leg_without_a_drive_or_assistance_is_not_loaded);
    tcase_add_test(tests, the_first_stance_is_loaded_without_a_strike);
    tcase_add_test(tests, an_answer_that_is_not_final_arms_nothing);
    tcase_add_test(tests, what_waited_without_a_decision_is_not_armed);
    tcase_add_test(tests, a_stop_gives_up_what_waits);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
