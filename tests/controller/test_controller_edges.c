/* The controller alone, tick by tick with made-up input: how long it waits at start, what it finds
 * while standing, and what ends a walk (numbers from the headers' prose). */
#include <math.h>
#include <string.h>

#include "controller/controller.h"
#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

static struct control_params params;
static struct controller controller;
static struct controller_input input;
static struct controller_output output;

static void setup(void)
{
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    ck_assert_int_eq(controller_init(&controller, &params), CONTROL_PARAMS_OK);
    memset(&input, 0, sizeof input);
    input.desired_speed_rad_s = 0.45f;
    input.nodes_operational = true;
    for (int side = 0; side < SIDE_COUNT; side++) {
        input.sea[side] = (struct sea_measurement){
            .state = DRIVE_DISABLED, .latch = LATCH_CLOSED, .force_age_ticks = AGE_NEVER};
        input.leg[side].leg_angle_rad = side == SIDE_LEFT ? 0.1f : -0.1f;
    }
}

static void run(int ticks)
{
    for (int i = 0; i < ticks; i++) {
        input.tick++;
        controller_update(&controller, &input, &output);
    }
}

/* A drive that has just come back may still be unloading by itself: the self test waits five
 * times as long as an unload may take, and then says that the springs are not slack. */
START_TEST(the_self_test_has_patience_and_an_end)
{
    const int patience = (int)(5.0f * params.unload_timeout_s * 1000.0f + 0.5f);
    input.sea[SIDE_LEFT].precompression_m = 0.05f;
    run(2);
    ck_assert_int_eq(output.state, SUPERVISOR_SELF_TEST);
    run(patience - 5);
    ck_assert_int_eq(output.state, SUPERVISOR_SELF_TEST);
    run(10);
    ck_assert_int_eq(output.state, SUPERVISOR_FAULT);
    ck_assert_int_eq(output.fault, SUPERVISOR_FAULT_SELF_TEST);
}
END_TEST

START_TEST(slack_springs_pass_the_self_test)
{
    const int patience = (int)(5.0f * params.unload_timeout_s * 1000.0f);
    input.sea[SIDE_LEFT].precompression_m = 0.05f;
    run(patience - 200);
    input.sea[SIDE_LEFT].precompression_m = 0.0f; /* slack late, but in time */
    run(190);
    ck_assert_int_eq(output.state, SUPERVISOR_STANDBY);
}
END_TEST

/* What both sensors read upright becomes their zero: the mean over the time it takes. */
START_TEST(standing_still_its_zero_is_found)
{
    run(100);
    ck_assert_int_eq(output.state, SUPERVISOR_STANDBY);
    input.zero_requested = true;
    input.leg[SIDE_LEFT] = (struct leg_measurement){0.021f, 0.004f, 0, FOOT_UNKNOWN};
    input.leg[SIDE_RIGHT] = (struct leg_measurement){-0.013f, -0.002f, 0, FOOT_UNKNOWN};
    run(1);
    input.zero_requested = false;
    int ticks = 0;
    while (!output.new_zero && ticks < 20000) {
        const float sway = 0.001f * sinf(0.05f * (float)ticks);
        input.leg[SIDE_LEFT].leg_angle_rad = 0.021f + sway;
        input.leg[SIDE_RIGHT].leg_angle_rad = -0.013f + sway;
        run(1);
        ck_assert_int_eq(output.state, SUPERVISOR_STANDBY);
        ticks++;
    }
    ck_assert(output.new_zero);
    ck_assert_int_eq(output.zeroing, ZEROING_DONE);
    assert_close(controller.zeroing.mean.angle_rad[SIDE_LEFT], 0.021, 2e-4, 0);
    assert_close(controller.zeroing.mean.angle_rad[SIDE_RIGHT], -0.013, 2e-4, 0);
    assert_close(controller.zeroing.mean.ankle_m[SIDE_LEFT], 0.004, 1e-6, 0);
    assert_close(controller.zeroing.mean.ankle_m[SIDE_RIGHT], -0.002, 1e-6, 0);
    run(1);
    ck_assert(!output.new_zero); /* told once */
}
END_TEST

/* A sensor mounted so far off is not corrected but reported: 0.2 rad, 30 mm, either way. */
START_TEST(a_zero_too_far_away_is_refused)
{
    static const struct {
        float angle_rad, ankle_m;
        enum zeroing_state state;
    } cases[] = {{0.19f, 0.029f, ZEROING_DONE},   {-0.19f, -0.029f, ZEROING_DONE},
                 {0.21f, 0.0f, ZEROING_TOO_FAR},  {-0.21f, 0.0f, ZEROING_TOO_FAR},
                 {0.0f, 0.031f, ZEROING_TOO_FAR}, {0.0f, -0.031f, ZEROING_TOO_FAR}};
    struct leg_measurement leg[SIDE_COUNT] = {{0}};
    struct zeroing zeroing;
    for (int side = 0; side < SIDE_COUNT; side++) {
        leg[side] =
            (struct leg_measurement){cases[_i].angle_rad, cases[_i].ankle_m, 0, FOOT_UNKNOWN};
        leg[1 - side] = (struct leg_measurement){0.0f, 0.0f, 0, FOOT_UNKNOWN};
        zeroing_start(&zeroing);
        for (int i = 0; i < 20000 && zeroing.state == ZEROING_RUNNING; i++) {
            zeroing_update(&zeroing, leg);
        }
        ck_assert_int_eq(zeroing.state, cases[_i].state);
    }
}
END_TEST

/* No number, or none at all, is no sample; a few of them are borne. */
START_TEST(a_zero_without_samples_is_refused)
{
    static const struct leg_measurement bad[] = {{NAN, 0.0f, 0, FOOT_UNKNOWN},
                                                 {0.0f, INFINITY, 0, FOOT_UNKNOWN},
                                                 {0.0f, 0.0f, 1, FOOT_UNKNOWN}};
    struct leg_measurement leg[SIDE_COUNT] = {{0}};
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct zeroing zeroing;
        zeroing_start(&zeroing);
        leg[side] = bad[_i];
        for (int i = 0; i < 20; i++) {
            zeroing_update(&zeroing, leg);
        }
        ck_assert_int_eq(zeroing.state, ZEROING_RUNNING);
        zeroing_update(&zeroing, leg);
        ck_assert_int_eq(zeroing.state, ZEROING_NO_SAMPLE);
        leg[side] = (struct leg_measurement){0.0f, 0.0f, 0, FOOT_UNKNOWN};
    }
}
END_TEST

/* With power on there is no standing still: the search is given up. */
START_TEST(no_zero_is_looked_for_under_power)
{
    run(100);
    input.zero_requested = true;
    run(1);
    input.zero_requested = false;
    ck_assert_int_eq(output.zeroing, ZEROING_RUNNING);
    input.walk_requested = true;
    run(2);
    ck_assert_int_eq(output.state, SUPERVISOR_ENGAGING);
    ck_assert_int_eq(output.zeroing, ZEROING_MOVED);
    input.zero_requested = true;
    run(1);
    ck_assert_int_eq(output.zeroing, ZEROING_MOVED);
}
END_TEST

/* ---- A stop: sea_reference.h -------------------------------------------------------------- */

/* Ticks until a reference at full rest at `from_m` is back at zero, its motor following. */
static int ticks_to_unload(struct sea_reference *sea)
{
    int ticks = 0;
    while (sea->phase != SEA_UNLOADED && ticks < 5000) {
        (void)sea_reference_update(sea, &params, sea->position_m);
        ticks++;
    }
    return ticks;
}

/* Of a trapezoid: distance / speed + speed / acceleration. */
START_TEST(a_stop_is_faster_than_a_step)
{
    struct sea_reference step, stop;
    params.sea_speed_max_m_s = 0.5f;
    params.sea_acceleration_m_s2 = 10.0f;
    const struct sea_stop limits = sea_reference_stop_limits(&params);
    sea_reference_init(&step, 0.2f);
    step.phase = SEA_LOADING;
    stop = step;
    sea_reference_unload(&step);
    sea_reference_stop(&stop, &limits, 0.2f);
    const double v = 1.2 * 0.5, a = 1.6 * 10.0;
    assert_close(ticks_to_unload(&step), 1000.0 * (0.2 / 0.5 + 0.5 / 10.0), 4.0, 0.0);
    assert_close(ticks_to_unload(&stop), 1000.0 * (0.2 / v + v / a), 4.0, 0.0);
}
END_TEST

/* A motor more than a hundredth of the leg behind its reference is not made to chase it. */
START_TEST(a_stop_begins_at_a_motor_that_was_left_behind)
{
    const struct sea_stop limits = sea_reference_stop_limits(&params);
    const float behind = 0.01f * params.leg_length_m;
    struct sea_reference sea;
    sea_reference_init(&sea, 0.2f);
    sea_reference_stop(&sea, &limits, 0.2f - 0.9f * behind);
    ck_assert(sea.position_m == 0.2f);
    sea_reference_stop(&sea, &limits, 0.2f + 2.0f * behind); /* ahead is not behind */
    ck_assert(sea.position_m == 0.2f);
    sea.speed_m_s = 0.3f;
    sea_reference_stop(&sea, &limits, 0.2f - 1.1f * behind);
    ck_assert(sea.position_m == 0.2f - 1.1f * behind && sea.speed_m_s == 0.0f);
    sea_reference_stop(&sea, &limits, -0.05f); /* never below the unloaded spring */
    ck_assert(sea.position_m == 0.0f);
    sea_reference_init(&sea, 0.2f);
    sea_reference_stop(&sea, &limits, NAN);
    ck_assert(sea.position_m == 0.2f);
}
END_TEST

/* ---- With power on ------------------------------------------------------------------------ */

/* The drives do as they are told at once, the legs sway without a step. */
static void run_powered(int ticks)
{
    for (int i = 0; i < ticks; i++) {
        const float sway = 0.04f * sinf(0.006f * (float)input.tick);
        input.leg[SIDE_LEFT].leg_angle_rad = 0.2f + sway;
        input.leg[SIDE_RIGHT].leg_angle_rad = -0.2f + sway;
        run(1);
        for (int side = 0; side < SIDE_COUNT; side++) {
            const struct sea_request *request = &output.sea[side];
            input.sea[side].state = request->enable ? DRIVE_ENABLED : DRIVE_DISABLED;
            input.sea[side].precompression_m = request->enable ? request->precompression_m : 0.0f;
        }
    }
}

static void engage(void)
{
    run(100);
    ck_assert_int_eq(output.state, SUPERVISOR_STANDBY);
    input.walk_requested = true;
    run_powered(60);
    ck_assert_int_eq(output.state, SUPERVISOR_ENGAGING);
    ck_assert(output.sea[SIDE_LEFT].enable && output.sea[SIDE_RIGHT].enable);
}

/* On the bench the leg in front is loaded at once, but with the legs side by side there is none. */
START_TEST(nothing_is_loaded_before_it_is_known_which_leg_stands)
{
    input.leg[SIDE_LEFT].leg_angle_rad = input.leg[SIDE_RIGHT].leg_angle_rad = 0.0f;
    run(100);
    input.walk_requested = true;
    for (int i = 0; i < 200; i++) {
        run(1);
        input.sea[SIDE_LEFT].state = input.sea[SIDE_RIGHT].state = DRIVE_ENABLED;
        ck_assert(output.sea[SIDE_LEFT].precompression_m == 0.0f);
        ck_assert(output.sea[SIDE_RIGHT].precompression_m == 0.0f);
    }
    ck_assert_int_eq(output.state, SUPERVISOR_ENGAGING);
    input.leg[SIDE_RIGHT].leg_angle_rad = 0.02f;
    run(20);
    ck_assert(output.sea[SIDE_LEFT].precompression_m == 0.0f);
    ck_assert(output.sea[SIDE_RIGHT].precompression_m > 0.0f);
}
END_TEST

/* A drive that is not heard while it is to unload does it by itself; the other goes on being told. */
START_TEST(a_silent_drive_unloads_by_itself)
{
    engage();
    run_powered(100);
    const float loaded_m = output.sea[SIDE_LEFT].precompression_m;
    ck_assert(loaded_m > 0.02f);
    const uint16_t limit = (uint16_t)(params.sensor_age_max_s * 1000.0f + 0.5f);
    input.walk_requested = false;
    input.sea[_i].age_ticks = limit;
    run(1);
    ck_assert_int_eq(output.state, SUPERVISOR_UNLOADING);
    ck_assert(output.sea[_i].enable); /* a lost telegram or two */
    input.sea[_i].age_ticks = (uint16_t)(limit + 1);
    run(1);
    ck_assert_int_eq(output.state, SUPERVISOR_UNLOADING);
    ck_assert(!output.sea[_i].enable);
    ck_assert(output.sea[1 - _i].enable);
    input.sea[_i].age_ticks = 0; /* and is heard again */
    run(1);
    ck_assert(output.sea[_i].enable);
}
END_TEST

/* A compass' legs take turns, and two apexes of one leg are a fault; a person may shuffle. */
START_TEST(only_a_compass_leg_that_steps_twice_is_a_fault)
{
    params.body = (real)(_i == 0 ? BODY_COMPASS : BODY_PERSON);
    engage();
    controller.step_monitor.same_side = true;
    run_powered(1);
    ck_assert_int_eq(output.fault, _i == 0 ? SUPERVISOR_FAULT_LEGS : SUPERVISOR_FAULT_NONE);
    ck_assert_int_eq(output.state, _i == 0 ? SUPERVISOR_UNLOADING : SUPERVISOR_ENGAGING);
}
END_TEST

/* A person has stopped when twice their last step has gone by, or step_timeout_s if that is sooner. */
START_TEST(the_wait_for_a_person_s_step_ends_with_the_timeout)
{
    static const struct {
        double last_step_s;
        bool by_timeout;
    } cases[] = {{0.4, false}, {0.7, false}, {5.0, true}, {0.0, true}}; /* 0: no whole step yet */
    params.engage_steps = 4.0f;
    params.step_timeout_s = 1.5f;
    engage();
    controller.supervisor.state = SUPERVISOR_WALKING;
    controller.step_monitor = (struct step_monitor){
        .seen = true,
        .known_tick = input.tick,
        .steady = 5,
        .step_ticks = {(uint32_t)(1000.0 * cases[_i].last_step_s + 0.5), 600}};
    const uint32_t begin = input.tick;
    while (output.state != SUPERVISOR_UNLOADING && input.tick - begin < 5000) {
        run_powered(1);
    }
    const double wait_s = cases[_i].by_timeout ? 1.5 : 2.0 * cases[_i].last_step_s;
    assert_close(input.tick - begin, 1000.0 * wait_s, 1.5, 0.0);
    ck_assert_int_eq(output.fault, SUPERVISOR_FAULT_NONE); /* stopping is no fault */
}
END_TEST

/* Drives are not left enabled behind a request that no walk follows: a bench, where a spring is
 * loaded, waits 10 s, a person has a minute to set off. Then it takes a new request. */
START_TEST(a_request_that_no_walk_follows_is_given_up)
{
    const int limit_s = _i == 0 ? 10 : 60;
    params.engage_steps = _i == 0 ? 0.0f : 4.0f;
    engage();
    ck_assert_int_eq(output.state, SUPERVISOR_ENGAGING);
    run_powered(limit_s * 1000 - 80);
    ck_assert_int_eq(output.state, SUPERVISOR_ENGAGING);
    run_powered(100);
    ck_assert_int_eq(output.state, SUPERVISOR_UNLOADING);
    ck_assert_int_eq(output.fault, SUPERVISOR_FAULT_NONE);
    run_powered(2000);
    ck_assert_int_eq(output.state, SUPERVISOR_STANDBY);
    input.walk_requested = false;
    run_powered(10);
    input.walk_requested = true;
    run_powered(100);
    ck_assert_int_eq(output.state, SUPERVISOR_ENGAGING);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("controller edges");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, the_self_test_has_patience_and_an_end);
    tcase_add_test(tests, slack_springs_pass_the_self_test);
    tcase_add_test(tests, standing_still_its_zero_is_found);
    tcase_add_loop_test(tests, a_zero_too_far_away_is_refused, 0, 6);
    tcase_add_loop_test(tests, a_zero_without_samples_is_refused, 0, 3);
    tcase_add_test(tests, no_zero_is_looked_for_under_power);
    tcase_add_test(tests, a_stop_is_faster_than_a_step);
    tcase_add_test(tests, a_stop_begins_at_a_motor_that_was_left_behind);
    tcase_add_test(tests, nothing_is_loaded_before_it_is_known_which_leg_stands);
    tcase_add_loop_test(tests, a_silent_drive_unloads_by_itself, 0, 2);
    tcase_add_loop_test(tests, only_a_compass_leg_that_steps_twice_is_a_fault, 0, 2);
    tcase_add_loop_test(tests, the_wait_for_a_person_s_step_ends_with_the_timeout, 0, 4);
    tcase_add_loop_test(tests, a_request_that_no_walk_follows_is_given_up, 0, 2);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
