/* The stride's clock, with strides of a tick's whole length: what is known when, and its means by hand. */
#include "controller/estimator/stride_clock.h"
#include "tests/support/assert_close.h"

enum { SECOND = 1000000 / TICK_PERIOD_US };

static struct stride_clock strides;

static void setup(void)
{
    strides = (struct stride_clock){0};
}

static void strike(enum side side, uint32_t tick, double before_s)
{
    const struct gait_event event = {
        .happened = true, .side = side, .tick = tick, .before_tick_s = (real)before_s};
    stride_clock_strike(&strides, &event);
}

static void expect(uint32_t tick, double left, double right)
{
    real share[SIDE_COUNT];
    stride_clock_shares(&strides, tick, share);
    assert_close((double)share[SIDE_LEFT], left, 1e-5, 0.0);
    assert_close((double)share[SIDE_RIGHT], right, 1e-5, 0.0);
}

START_TEST(nothing_is_known_before_a_leg_has_made_a_stride)
{
    expect(5000, -1.0, -1.0);
    strike(SIDE_LEFT, 5000, 0.0);
    expect(5100, -1.0, -1.0);
    strike(SIDE_RIGHT, 5500, 0.0);
    expect(5600, -1.0, -1.0);
    strike(SIDE_LEFT, 6000, 0.0); /* a stride of 1 s, for both legs */
    expect(6000, 0.0, 0.5);
    expect(6250, 0.25, 0.75);
}
END_TEST

START_TEST(a_strike_between_ticks_counts_from_where_it_was)
{
    strike(SIDE_LEFT, 5000, 0.0004);
    strike(SIDE_LEFT, 6000, 0.0008); /* 999.6 ms after the first */
    assert_close((double)strides.stride_s, 0.9996, 1e-6, 0.0);
    expect(6100, 0.1008 / 0.9996, -1.0);
}
END_TEST

START_TEST(the_mean_takes_half_of_each_new_one_or_begins_anew)
{
    strike(SIDE_LEFT, 5000, 0.0);
    strike(SIDE_LEFT, 6000, 0.0);
    strike(SIDE_LEFT, 7200, 0.0); /* 1.2 s */
    assert_close((double)strides.stride_s, 1.1, 1e-6, 0.0);
    strike(SIDE_LEFT, 8640, 0.0); /* 1.44 s: by more than 0.3 of it */
    assert_close((double)strides.stride_s, 1.44, 1e-6, 0.0);
    strike(SIDE_LEFT, 8640 + 5 * SECOND, 0.0); /* a rest is no stride */
    assert_close((double)strides.stride_s, 1.44, 1e-6, 0.0);
}
END_TEST

START_TEST(a_long_stride_stays_at_its_end_and_is_forgotten_after_4_s)
{
    strike(SIDE_LEFT, 5000, 0.0);
    strike(SIDE_LEFT, 6000, 0.0);
    expect(7500, 1.0, -1.0);
    expect(6000 + 4 * SECOND - 1, 1.0, -1.0);
    expect(6000 + 4 * SECOND + 2, -1.0, -1.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stride_clock");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, nothing_is_known_before_a_leg_has_made_a_stride);
    tcase_add_test(tests, a_strike_between_ticks_counts_from_where_it_was);
    tcase_add_test(tests, the_mean_takes_half_of_each_new_one_or_begins_anew);
    tcase_add_test(tests, a_long_stride_stays_at_its_end_and_is_forgotten_after_4_s);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
