/* Where an event is placed: by the age of what showed it and the sensors' latency, whatever the age is. */
#include "controller/estimator/gait_events.h"
#include "tests/support/assert_close.h"

#include <math.h>

#include "controller/estimator/angle_history.h"

enum { NOW = 100000 };

/* How long before this tick a strike is placed, s. */
static double placed_before(real age_s, real latency_s)
{
    const struct control_params params = {.sensor_latency_s = latency_s};
    struct gait_state gait = {0};
    gait_events_report(&gait, &params, GAIT_HEEL_STRIKE, SIDE_RIGHT, NOW, age_s);
    const struct gait_event *event = &gait.event[GAIT_HEEL_STRIKE];
    ck_assert(event->happened && event->side == SIDE_RIGHT);
    ck_assert(event->before_tick_s >= REAL(0.0) && event->before_tick_s < CONTROL_PERIOD_S);
    return (double)(NOW - event->tick) * (double)CONTROL_PERIOD_S + (double)event->before_tick_s;
}

START_TEST(an_event_is_as_old_as_its_samples_and_the_sensors)
{
    assert_close(placed_before(REAL(0.0), REAL(0.0)), 0.0, 0.0, 0.0);
    assert_close(placed_before(REAL(0.0125), REAL(0.0)), 0.0125, 1e-7, 0.0);
    assert_close(placed_before(REAL(0.0125), REAL(0.002)), 0.0145, 1e-7, 0.0);
}
END_TEST

START_TEST(an_age_that_cannot_be_is_none_or_the_oldest)
{
    const double oldest_s = (double)GAIT_HISTORY * (double)CONTROL_PERIOD_S;
    assert_close(placed_before(REAL(-0.01), REAL(0.0)), 0.0, 0.0, 0.0);
    assert_close(placed_before((real)NAN, REAL(0.0)), 0.0, 0.0, 0.0);
    assert_close(placed_before((real)-INFINITY, REAL(0.0)), 0.0, 0.0, 0.0);
    assert_close(placed_before((real)INFINITY, REAL(0.0)), oldest_s, 0.0, 1e-6);
    assert_close(placed_before(REAL(1e6), REAL(0.0)), oldest_s, 0.0, 1e-6);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gait events");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, an_event_is_as_old_as_its_samples_and_the_sensors);
    tcase_add_test(tests, an_age_that_cannot_be_is_none_or_the_oldest);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
