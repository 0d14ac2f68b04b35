/* The walking speed: the mean of the apexes' speeds, within limits that scale with sqrt(g/l). The
 * numbers are worked out by hand from the header's and the comments' words. */
#include "controller/estimator/walking_speed.h"
#include "tests/support/assert_close.h"

/* sqrt(9.81 / 0.9) = 3.30151 rad/s. */
#define UNIT 3.3015148
enum { SECOND = 1000000 / TICK_PERIOD_US };

static struct control_params params;
static struct walking_speed speed;

static void setup(void)
{
    params = (struct control_params){.gravity_m_s2 = REAL(9.81), .leg_length_m = REAL(0.9)};
    speed = (struct walking_speed){0};
}

static void expect(uint32_t tick, double rad_s)
{
    assert_close((double)walking_speed_at(&speed, &params, tick), rad_s, 1e-5, 0.0);
}

START_TEST(before_the_first_apex_and_long_after_the_last_it_is_a_slow_step)
{
    expect(5000, 0.3 * UNIT);
    walking_speed_apex(&speed, 5000, REAL(1.2));
    expect(5000, 1.2);
    expect(5000 + 3 * SECOND - 1, 1.2);
    expect(5000 + 3 * SECOND + 2, 0.3 * UNIT);
}
END_TEST

START_TEST(a_mean_takes_three_tenths_of_each_new_one)
{
    walking_speed_apex(&speed, 5000, REAL(1.0));
    walking_speed_apex(&speed, 5600, REAL(1.2));
    expect(5600, 1.06);
    walking_speed_apex(&speed, 6200, REAL(0.9));
    expect(6200, 1.012);
}
END_TEST

START_TEST(a_jump_or_a_rest_begins_anew)
{
    walking_speed_apex(&speed, 5000, REAL(1.0));
    walking_speed_apex(&speed, 5600, REAL(1.31)); /* by more than 0.3 of the mean */
    expect(5600, 1.31);
    walking_speed_apex(&speed, 6200, REAL(0.91));
    expect(6200, 0.91);
    walking_speed_apex(&speed, 6300, REAL(1.2));
    expect(6300, 1.2); /* a jump */
    speed.mean_rad_s = REAL(1.0);
    walking_speed_apex(&speed, 6300, REAL(1.0) - REAL(0.3)); /* by just 0.3 of it: none */
    expect(6300, 0.91);
    walking_speed_apex(&speed, 6199 + 3 * SECOND, REAL(1.11)); /* a rest of no more than 3 s */
    expect(6199 + 3 * SECOND, 0.97);
    walking_speed_apex(&speed, 6202 + 6 * SECOND, REAL(1.17));
    expect(6202 + 6 * SECOND, 1.17);
}
END_TEST

START_TEST(what_is_told_stays_between_a_tenth_and_eight_tenths)
{
    walking_speed_apex(&speed, 5000, REAL(0.2));
    expect(5000, 0.1 * UNIT);
    speed = (struct walking_speed){0};
    walking_speed_apex(&speed, 5000, REAL(0.05));
    expect(5000, 0.1 * UNIT);
    walking_speed_apex(&speed, 5600, REAL(4.0));
    expect(5600, 0.8 * UNIT);
    walking_speed_apex(&speed, 6200, REAL(2.5));
    expect(6200, 2.5);
    walking_speed_apex(&speed, 6800, REAL(-1.0)); /* backwards: no speed of a step */
    expect(6800, 0.3 * UNIT);
}
END_TEST

/* A speed of exactly nothing is that of no step: right after power-on, and where a mean came to it. */
START_TEST(no_speed_is_that_of_a_slow_step)
{
    expect(1, 0.3 * UNIT);
    walking_speed_apex(&speed, 5000, REAL(0.0));
    expect(5001, 0.3 * UNIT);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walking_speed");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, before_the_first_apex_and_long_after_the_last_it_is_a_slow_step);
    tcase_add_test(tests, a_mean_takes_three_tenths_of_each_new_one);
    tcase_add_test(tests, a_jump_or_a_rest_begins_anew);
    tcase_add_test(tests, what_is_told_stays_between_a_tenth_and_eight_tenths);
    tcase_add_test(tests, no_speed_is_that_of_a_slow_step);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
