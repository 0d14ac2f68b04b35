/* Heel strike and lift-off of point feet, sample by sample: made-up legs whose crossing and whose
 * ankle's extension are straight lines, so that the time of every event is known. A leg of 1 m. */
#include "controller/estimator/compass_events.h"

#include "tests/support/assert_close.h"

static const struct control_params params = {
    .leg_length_m = 1.0f, .angle_hysteresis_rad = 0.01f, .sea_tolerance_m = 0.001f};
static struct compass_events events;
static struct controller_input input;

static void setup(void)
{
    events = (struct compass_events){0};
    input = (struct controller_input){.tick = 1000};
    compass_events_begin_phase(&events, input.tick);
}

/* One tick of the left leg's stance; sum = both angles. */
static struct compass_event single(double stance_rad, double sum_rad, double ankle_m)
{
    input.tick++;
    input.leg[SIDE_LEFT].leg_angle_rad = (real)stance_rad;
    input.leg[SIDE_RIGHT].leg_angle_rad = (real)(sum_rad - stance_rad);
    input.leg[SIDE_LEFT].ankle_extension_m = (real)ankle_m;
    return compass_events_watch_strike(&events, &params, &input, SIDE_LEFT);
}

static void spring_is_loaded(bool loaded)
{
    input.sea[SIDE_LEFT].precompression_m = loaded ? 0.05f : 0.0f;
}

START_TEST(without_a_spring_the_crossing_is_the_strike)
{
    spring_is_loaded(false);
    ck_assert(!single(-0.1, 0.012, 0.0).happened);
    ck_assert(!single(-0.1, 0.003, 0.0).happened);
    const struct compass_event strike = single(-0.1, -0.001, 0.0); /* 3 : 1 across the tick */
    ck_assert(strike.happened);
    assert_close(strike.age_s, 0.00025, 1e-8, 1e-4);
}
END_TEST

/* Landing before the stance leg is upright is a stumble, not this step's strike: it counts from
 * where the leg is behind, and there is no crossing to go back to when the sum rises meanwhile. */
START_TEST(a_crossing_counts_with_the_stance_leg_behind)
{
    spring_is_loaded(false);
    ck_assert(!single(0.02, 0.012, 0.0).happened);
    ck_assert(!single(0.01, -0.006, 0.0).happened);
    const struct compass_event strike = single(-0.01, -0.004, 0.0);
    ck_assert(strike.happened);
    assert_close(strike.age_s, 0.0, 0.0, 0.0);
}
END_TEST

/* The scuff at mid-stance is the rising crossing: nothing lands. */
START_TEST(a_sum_that_was_never_above_zero_does_not_cross)
{
    spring_is_loaded(false);
    for (int i = 0; i < 100; i++) {
        ck_assert(!single(-0.1, i % 2 == 0 ? 0.009 : -0.009, 0.0).happened);
    }
}
END_TEST

/* The extension's line, 2 mm by 0.5 mm a tick, began 4 ms ago; a crossing just before it is the
 * strike itself, one of long before is another's, and on a slope there is none at all. */
START_TEST(a_released_spring_tells_of_the_strike)
{
    static const struct {
        bool crosses;
        int ticks_until_seen; /* from the first sample below zero, 0.25 ms after the crossing */
        double age_s;
    } cases[] = {{false, 0, 0.004}, {true, 3, 0.00325}, {true, 60, 0.004}};
    spring_is_loaded(true);
    ck_assert(!single(-0.1, 0.012, 0.0).happened);
    if (cases[_i].crosses) {
        ck_assert(!single(-0.1, 0.006, 0.0).happened);
        ck_assert(!single(-0.1, -0.002, 0.0).happened);
    }
    for (int i = 0; i < cases[_i].ticks_until_seen - 2; i++) {
        ck_assert(!single(-0.1, -0.01, 0.0).happened);
    }
    ck_assert(!single(-0.1, cases[_i].crosses ? -0.01 : 0.02, 0.0009).happened); /* below 1 mm */
    events.extension_before_m = 0.0015f;
    const struct compass_event strike = single(-0.1, cases[_i].crosses ? -0.01 : 0.02, 0.002);
    ck_assert(strike.happened);
    assert_close(strike.age_s, cases[_i].age_s, 1e-6, 1e-4);
}
END_TEST

/* A loaded spring that has not let go was not armed: after 150 ms the crossing alone decides. */
START_TEST(a_spring_that_does_not_let_go_is_not_waited_for)
{
    spring_is_loaded(true);
    ck_assert(!single(-0.1, 0.012, 0.0).happened);
    int ticks = 0;
    struct compass_event strike = single(-0.1, -0.012, 0.0);
    while (!strike.happened && ticks < 1000) {
        strike = single(-0.1, -0.012, 0.0);
        ticks++;
    }
    assert_close(ticks, 150, 1.0, 0.0);
    assert_close(strike.age_s, 1e-3 * ticks + 0.0005, 1e-6, 0.0);
}
END_TEST

/* ---- lift-off: the spring's rest is at 50 mm ------------------------------------------------ */

static struct compass_event both(double ankle_m)
{
    input.tick++;
    input.leg[SIDE_LEFT].ankle_extension_m = (real)ankle_m;
    return compass_events_watch_lift_off(&events, &params, &input, SIDE_LEFT, 1000);
}

START_TEST(without_a_push_the_support_passes_after_30_ms)
{
    spring_is_loaded(true);
    int ticks = 1;
    while (!both(0.0).happened && ticks < 100) {
        ticks++;
    }
    ck_assert_int_eq(ticks, 30);
}
END_TEST

/* 0.2 mm of the 50 count as all: on a line of 1 mm a tick. */
START_TEST(lift_off_is_where_the_ankle_is_at_its_rest)
{
    spring_is_loaded(true);
    for (int i = 1; i <= 49; i++) {
        ck_assert(!both(0.0495 - 0.001 * (50 - i)).happened);
    }
    const struct compass_event lift_off = both(0.0500); /* came from 48.5 mm: 0.2 of 1.5 */
    ck_assert(lift_off.happened);
    assert_close(lift_off.age_s, 1e-3 * 0.2 / 1.5, 1e-6, 1e-3);
}
END_TEST

/* Already there, and not moving on: it leaves now, not some time before. */
START_TEST(an_ankle_that_is_at_its_rest_already_lifts_off_now)
{
    spring_is_loaded(true);
    events.extension_before_m = 0.052f;
    const struct compass_event lift_off = both(0.051);
    ck_assert(lift_off.happened);
    assert_close(lift_off.age_s, 0.0, 0.0, 0.0);
}
END_TEST

/* A push that ends short of the rest: settled for 20 ms at 30 mm, or folding back by 1 mm. */
START_TEST(a_push_that_ends_short_lifts_off_where_it_ended)
{
    spring_is_loaded(true);
    for (int i = 1; i <= 30; i++) {
        ck_assert(!both(0.001 * i).happened);
    }
    int ticks = 1;
    struct compass_event lift_off = both(0.03);
    while (!lift_off.happened && ticks < 100) {
        lift_off = both(0.03);
        ticks++;
    }
    ck_assert_int_eq(ticks, 20);
    assert_close(lift_off.age_s, 0.020, 1e-7, 0.0);
}
END_TEST

START_TEST(an_ankle_that_folds_back_has_lifted_off)
{
    spring_is_loaded(true);
    for (int i = 1; i <= 30; i++) {
        ck_assert(!both(0.001 * i).happened);
    }
    ck_assert(!both(0.0291).happened); /* noise */
    const struct compass_event lift_off = both(0.0289);
    ck_assert(lift_off.happened);
    assert_close(lift_off.age_s, 0.002, 1e-7, 0.0); /* since the farthest sample */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("compass events");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, without_a_spring_the_crossing_is_the_strike);
    tcase_add_test(tests, a_crossing_counts_with_the_stance_leg_behind);
    tcase_add_test(tests, a_sum_that_was_never_above_zero_does_not_cross);
    tcase_add_loop_test(tests, a_released_spring_tells_of_the_strike, 0, 3);
    tcase_add_test(tests, a_spring_that_does_not_let_go_is_not_waited_for);
    tcase_add_test(tests, without_a_push_the_support_passes_after_30_ms);
    tcase_add_test(tests, lift_off_is_where_the_ankle_is_at_its_rest);
    tcase_add_test(tests, an_ankle_that_is_at_its_rest_already_lifts_off_now);
    tcase_add_test(tests, a_push_that_ends_short_lifts_off_where_it_ended);
    tcase_add_test(tests, an_ankle_that_folds_back_has_lifted_off);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
