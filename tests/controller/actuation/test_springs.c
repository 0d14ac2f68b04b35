/* A person's springs over the step: loaded behind a closed latch only, taken back in time. */
#include "tests/support/springs_rig.h"

START_TEST(a_stance_is_loaded_armed_and_given)
{
    push_left(120);
    ck_assert_int_eq(outcome, PUSH_GIVEN);
    assert_close(request[SIDE_LEFT].precompression_m, 0.0, 1e-6, 0.0);
}
END_TEST

START_TEST(behind_an_open_latch_nothing_is_loaded)
{
    know_long_pushes();
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    tick();
    load_left();
    assert_close(request[SIDE_LEFT].precompression_m, 0.0, 0.0, 0.0);
    ck_assert(!request[SIDE_LEFT].latch_armed);
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    ticks(100);
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    ck_assert_int_eq(outcome, PUSH_LATCH_OPEN);
    /* It closes during the stance: loaded from there on, to what the step has decided. */
    load_left();
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    ticks(300);
    ck_assert(request[SIDE_LEFT].latch_armed);
    assert_close(request[SIDE_LEFT].precompression_m, 0.04, 1e-6, 0.0);
}
END_TEST

/* Whatever waited for the latch is given up at toe-off: it must not load in swing. */
START_TEST(a_latch_that_closes_in_swing_loads_nothing)
{
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    tick();
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    ticks(100);
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    for (int i = 0; i < 300; i++) {
        tick();
        assert_close(request[SIDE_LEFT].precompression_m, 0.0, 0.0, 0.0);
    }
}
END_TEST

/* A walk knows nothing of the one before: neither its pushes nor where its legs were. */
START_TEST(a_new_walk_begins_afresh)
{
    push_left(120);
    for (int side = 0; side < SIDE_COUNT; side++) {
        springs.waits[side] = springs.open[side] = springs.swings[side] = true;
        springs.push_s[side] = 0.2f;
    }
    springs.drags = true;
    input.sea[SIDE_RIGHT].precompression_m = 0.01f;
    springs_begin(&springs, &params, &input);
    for (int side = 0; side < SIDE_COUNT; side++) {
        ck_assert(!springs.waits[side] && !springs.open[side] && !springs.swings[side]);
        assert_close(springs.push_s[side], 0.0, 0.0, 0.0);
        ck_assert(springs.may_load[side]);
    }
    ck_assert(!springs.drags);
    assert_close(springs.sea[SIDE_RIGHT].position_m, 0.01, 1e-9, 0.0);
}
END_TEST

/* Commissioning puts a motor somewhere; what ends it takes it back from there, and not at once. */
START_TEST(a_placed_motor_is_taken_back_from_where_it_is)
{
    springs_place(&springs, SIDE_LEFT, 0.03f);
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_LOADING);
    assert_close(springs.sea[SIDE_LEFT].target_m, 0.03, 1e-9, 0.0);
    input.sea[SIDE_LEFT].precompression_m = 0.03f;
    springs_stop(&springs, &input);
    float before_m = 0.03f;
    for (int i = 0; i < 400; i++) {
        input.tick++;
        springs_command(&springs, &params, &input, SUPERVISOR_UNLOADING, &gait, request);
        const float now_m = request[SIDE_LEFT].precompression_m;
        ck_assert(now_m <= before_m + 1e-6f);
        ck_assert(now_m >= before_m - 0.001f); /* 0.6 m/s, and some more to stop */
        before_m = now_m;
        input.sea[SIDE_LEFT].precompression_m = now_m;
    }
    assert_close(before_m, 0.0, 1e-6, 0.0);
}
END_TEST

/* A drive that is not heard while it is to unload does so by itself: it is told nothing then. */
START_TEST(a_drive_that_is_not_heard_is_not_enabled_while_it_unloads)
{
    static const struct {
        uint16_t age_ticks;
        bool enabled;
    } ages[] = {{0, true}, {10, true}, {11, false}, {12, false}, {UINT16_MAX, false}};
    for (size_t i = 0; i < sizeof ages / sizeof ages[0]; i++) {
        input.sea[SIDE_LEFT].age_ticks = ages[i].age_ticks;
        springs_command(&springs, &params, &input, SUPERVISOR_UNLOADING, &gait, request);
        ck_assert_int_eq(request[SIDE_LEFT].enable, ages[i].enabled);
        ck_assert(request[SIDE_RIGHT].enable);
        springs_command(&springs, &params, &input, SUPERVISOR_WALKING, &gait, request);
        ck_assert(request[SIDE_LEFT].enable);
    }
}
END_TEST

START_TEST(a_compass_loads_whatever_its_latch_says)
{
    params.body = (float)BODY_COMPASS;
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    springs_begin(&springs, &params, &input);
    tick();
    event(GAIT_HEEL_STRIKE, SIDE_LEFT);
    ticks(100);
    ck_assert(request[SIDE_LEFT].precompression_m > 0.01f);
}
END_TEST

START_TEST(a_slow_motor_is_seen_not_to_have_loaded)
{
    event(GAIT_HEEL_STRIKE, SIDE_LEFT);
    decision.new_step = true;
    ticks(20);
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    ticks(20);
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    ck_assert_int_eq(outcome, PUSH_NOT_LOADED);
    ck_assert_uint_eq(springs.watch.leg[SIDE_LEFT].count[PUSH_NOT_LOADED], 1);
}
END_TEST

/* Compression that is left when the foot leaves, so long behind the latch's opening: the ankle extends by
 * 0.1 mm a tick. The spring's energy grows with its square. */
static double left_at_toe_off_m(int toe_off_ticks)
{
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    for (int i = 1; i <= toe_off_ticks; i++) {
        input.leg[SIDE_LEFT].ankle_extension_m = 0.0001f * (float)i;
        tick();
    }
    const double left_m =
        (double)(input.sea[SIDE_LEFT].precompression_m - input.leg[SIDE_LEFT].ankle_extension_m);
    swing_left();
    return left_m;
}

START_TEST(the_motor_is_on_its_way_back_before_the_foot_leaves)
{
    /* Toe-offs 120 ms behind the release are known, late by up to 30 ms: of 7.6 J at 40 mm 0.2 J are left
     * at 6.5 mm. */
    push_left(120);
    push_left(120);
    ck_assert_double_le(left_at_toe_off_m(90), 0.0065);
}
END_TEST

START_TEST(a_fitted_person_gets_more_of_the_push)
{
    params.toe_off_bias_left_s = 0.02f;
    push_left(120);
    push_left(120);
    ck_assert_double_ge(left_at_toe_off_m(60), 0.02);
    setup();
    params.toe_off_bias_left_s = 0.02f;
    push_left(120);
    push_left(120);
    ck_assert_double_le(left_at_toe_off_m(110), 0.0065);
}
END_TEST

START_TEST(a_spring_is_loaded_no_further_than_its_motor_comes_back_in_time)
{
    /* The foot leaves 60 ms behind the release: that is no time for 40 mm. */
    push_left(60);
    push_left(60);
    ck_assert_double_le(left_at_toe_off_m(30), 0.0065);
    push_left(60);
    load_left();
    ck_assert(request[SIDE_LEFT].latch_armed);
    ck_assert_double_le((double)request[SIDE_LEFT].precompression_m, 0.02);
    ck_assert_double_ge((double)request[SIDE_LEFT].precompression_m, 0.005);
}
END_TEST

START_TEST(a_shorter_push_counts_at_once)
{
    push_left(160);
    push_left(160);
    push_left(100);
    ck_assert_double_le(left_at_toe_off_m(90), 0.0065);
}
END_TEST

START_TEST(a_leg_s_first_push_is_harmless)
{
    load_left();
    ck_assert(request[SIDE_LEFT].latch_armed);
    /* Of 7.6 J at 40 mm less than 0.2 J. */
    ck_assert_double_le((double)request[SIDE_LEFT].precompression_m, 0.0064);
    params.body = (float)BODY_COMPASS;
    springs_begin(&springs, &params, &input);
    load_left();
    assert_close(request[SIDE_LEFT].precompression_m, 0.04, 1e-6, 0.0);
}
END_TEST

/* A latch that has opened and closed without a toe-off tells nothing of how long pushes last. */
START_TEST(an_opening_without_a_toe_off_widens_no_reach)
{
    event(GAIT_HEEL_STRIKE, SIDE_LEFT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    input.leg[SIDE_LEFT].ankle_extension_m = 0.03f;
    ticks(500);
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    input.leg[SIDE_LEFT].ankle_extension_m = 0.0f;
    ticks(50);
    load_left();
    ck_assert(request[SIDE_LEFT].latch_armed);
    ck_assert_double_le((double)request[SIDE_LEFT].precompression_m, 0.0064);
}
END_TEST

/* The ankle of a compass holds its motor's place: short pushes shorten nothing. */
START_TEST(a_compass_s_pushes_limit_none)
{
    params.body = (float)BODY_COMPASS;
    springs_begin(&springs, &params, &input);
    for (int i = 0; i < 2; i++) {
        load_left();
        event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
        input.sea[SIDE_LEFT].latch = LATCH_OPEN;
        ticks(60);
        swing_left();
    }
    load_left();
    assert_close(request[SIDE_LEFT].precompression_m, 0.04, 1e-6, 0.0);
}
END_TEST

START_TEST(a_motor_that_has_run_past_its_target_is_not_let_go)
{
    know_long_pushes();
    load_left();
    tick();
    ck_assert(request[SIDE_LEFT].latch_armed);
    input.sea[SIDE_LEFT].precompression_m = 1.001f * params.r0_max_m;
    springs_command(&springs, &params, &input, SUPERVISOR_WALKING, &gait, request);
    ck_assert(!request[SIDE_LEFT].latch_armed);
    input.sea[SIDE_LEFT].precompression_m = params.r0_max_m;
    springs_command(&springs, &params, &input, SUPERVISOR_WALKING, &gait, request);
    ck_assert(request[SIDE_LEFT].latch_armed);
}
END_TEST

START_TEST(the_own_switch_ends_the_push)
{
    know_long_pushes();
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    input.leg[SIDE_LEFT].ankle_extension_m = 0.03f;
    input.leg[SIDE_LEFT].foot = FOOT_DOWN;
    ticks(3);
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_ARMED);
    input.leg[SIDE_LEFT].foot = FOOT_UP;
    tick();
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADING);
}
END_TEST

START_TEST(an_ankle_that_comes_back_or_has_it_all_ends_the_push)
{
    know_long_pushes();
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    input.leg[SIDE_LEFT].ankle_extension_m = 0.02f;
    ticks(10);
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_ARMED);
    input.leg[SIDE_LEFT].ankle_extension_m = 0.016f;
    tick();
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADING);
    setup();
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    input.leg[SIDE_LEFT].ankle_extension_m = 0.041f; /* past the motor */
    tick();
    ck_assert_int_eq(springs.sea[SIDE_LEFT].phase, SEA_UNLOADING);
}
END_TEST

START_TEST(a_push_that_drags_is_seen)
{
    /* The motor stays out behind an open latch while the foot comes back: seen 50 ms behind toe-off. */
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    input.leg[SIDE_LEFT].ankle_extension_m = 0.02f;
    ticks(60);
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    outcome = PUSH_NONE;
    for (int i = 1; i <= 80; i++) {
        tick();
        input.sea[SIDE_LEFT].precompression_m = 0.035f; /* does not follow */
        ck_assert_int_eq(outcome, i <= 51 ? PUSH_NONE : PUSH_DRAGS);
    }
    ck_assert_uint_eq(springs.watch.leg[SIDE_LEFT].count[PUSH_DRAGS], 1);
    ck_assert_uint_eq(springs.watch.dragged_in_row, 1);
    /* A good push in between ends the row; three in a row fail. */
    input.sea[SIDE_LEFT].latch = LATCH_CLOSED;
    input.leg[SIDE_LEFT].ankle_extension_m = 0.0f;
    ticks(5);
    push_left(120);
    push_left(120);
    ck_assert_uint_eq(springs.watch.dragged_in_row, 0);
    springs.watch.dragged_in_row = PUSH_WATCH_MISSES;
    ck_assert(push_watch_fails(&springs.watch));
}
END_TEST

/* A compass' spring is still in its foot behind toe-off: nothing drags. */
START_TEST(a_compass_drags_nothing)
{
    params.body = (float)BODY_COMPASS;
    springs_begin(&springs, &params, &input);
    load_left();
    event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
    input.sea[SIDE_LEFT].latch = LATCH_OPEN;
    ticks(60);
    event(GAIT_LIFT_OFF, SIDE_LEFT);
    outcome = PUSH_NONE;
    for (int i = 0; i < 200; i++) {
        tick();
        input.sea[SIDE_LEFT].precompression_m = 0.035f;
    }
    ck_assert_int_eq(outcome, PUSH_NONE);
    ck_assert_uint_eq(springs.watch.leg[SIDE_LEFT].count[PUSH_DRAGS], 0);
}
END_TEST

/* Of the two signs of a toe-off, the own switch and the one that is found, the earlier ends the push. */
START_TEST(the_earlier_sign_tells_how_long_a_push_lasts)
{
    static const int switch_ticks[] = {100, 0}; /* behind the latch; 0: there is none */
    for (size_t i = 0; i < 2; i++) {
        setup();
        load_left();
        event(GAIT_HEEL_STRIKE, SIDE_RIGHT);
        input.sea[SIDE_LEFT].latch = LATCH_OPEN;
        tick();
        for (int now = 1; now < 160; now++) {
            input.leg[SIDE_LEFT].foot = now == switch_ticks[i] ? FOOT_UP : FOOT_UNKNOWN;
            tick();
        }
        event(GAIT_LIFT_OFF, SIDE_LEFT);
        assert_close(springs.push_s[SIDE_LEFT], switch_ticks[i] > 0 ? 0.1 : 0.16, 1e-6, 0.0);
    }
}
END_TEST

/* As far as the ankle is extended when the foot usually leaves: 0.1 mm a tick, and a fifth for each push. */
START_TEST(the_extension_at_toe_off_is_learned_then)
{
    push_left(120);
    const double before_m = (double)springs.left_m[SIDE_LEFT];
    push_left(120);
    const double learned_m = (double)springs.left_m[SIDE_LEFT];
    assert_close(learned_m, before_m + 0.2 * (0.0119 - before_m), 1e-4, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("springs");
    TCase *tests = tcase_create("person");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, a_stance_is_loaded_armed_and_given);
    tcase_add_test(tests, behind_an_open_latch_nothing_is_loaded);
    tcase_add_test(tests, a_drive_that_is_not_heard_is_not_enabled_while_it_unloads);
    tcase_add_test(tests, a_compass_loads_whatever_its_latch_says);
    tcase_add_test(tests, a_latch_that_closes_in_swing_loads_nothing);
    tcase_add_test(tests, a_new_walk_begins_afresh);
    tcase_add_test(tests, a_placed_motor_is_taken_back_from_where_it_is);
    tcase_add_test(tests, a_slow_motor_is_seen_not_to_have_loaded);
    tcase_add_test(tests, the_motor_is_on_its_way_back_before_the_foot_leaves);
    tcase_add_test(tests, a_fitted_person_gets_more_of_the_push);
    tcase_add_test(tests, a_spring_is_loaded_no_further_than_its_motor_comes_back_in_time);
    tcase_add_test(tests, a_shorter_push_counts_at_once);
    tcase_add_test(tests, the_own_switch_ends_the_push);
    tcase_add_test(tests, a_leg_s_first_push_is_harmless);
    tcase_add_test(tests, an_opening_without_a_toe_off_widens_no_reach);
    tcase_add_test(tests, a_compass_s_pushes_limit_none);
    tcase_add_test(tests, a_motor_that_has_run_past_its_target_is_not_let_go);
    tcase_add_test(tests, a_push_that_drags_is_seen);
    tcase_add_test(tests, an_ankle_that_comes_back_or_has_it_all_ends_the_push);
    tcase_add_test(tests, a_compass_drags_nothing);
    tcase_add_test(tests, the_earlier_sign_tells_how_long_a_push_lasts);
    tcase_add_test(tests, the_extension_at_toe_off_is_learned_then);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
