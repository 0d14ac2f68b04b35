/* The least-squares state at an apex, against curves whose slope is known. */
#include <check.h>

#include "controller/estimator/apex_fit.h"
#include "tests/support/assert_close.h"

enum { SIZE = 256, CENTRE = 1000, WINDOW = 80 };

static real stance[SIZE], swing[SIZE];

/* Cubics: the fit must give them back to rounding. `late_s` is the time from the
 * crossing to the centre sample. */
static void fill(double late_s)
{
    for (int n = -WINDOW; n <= WINDOW; n++) {
        const double t = late_s + 1e-3 * n;
        stance[(CENTRE + n) % SIZE] = (real)(-0.8 * t + 0.1 * t * t - 0.5 * t * t * t);
        swing[(CENTRE + n) % SIZE] = (real)(-0.06 + 1.7 * t + 0.3 * t * t - 2.0 * t * t * t);
    }
}

static struct apex_sums add_up(const real *angle, uint32_t window)
{
    struct apex_sums sums;
    apex_fit_begin(&sums, angle[CENTRE % SIZE]);
    for (uint32_t n = 1; n <= window; n++) {
        apex_fit_add(&sums, window, angle[(CENTRE + n) % SIZE], angle[(CENTRE - n) % SIZE]);
    }
    return sums;
}

START_TEST(both_legs_of_a_cubic)
{
    const double late_s = 0.1e-3 * _i;
    fill(late_s);
    const struct apex_sums sums = add_up(stance, WINDOW), swing_sums = add_up(swing, WINDOW);
    const struct apex_fit fit = apex_fit_solve(&sums, WINDOW);
    assert_close((double)fit.speed_rad_s, 0.8, 2e-5, 0.0);
    assert_close((double)fit.before_tick_s, late_s, 1e-6, 0.0);
    const struct angle_fit other = apex_fit_other_leg(&swing_sums, WINDOW, fit.before_tick_s);
    assert_close((double)other.angle_rad, -0.06, 2e-6, 0.0);
    assert_close((double)other.rate_rad_s, 1.7, 2e-5, 0.0);
}
END_TEST

/* The sums of powers come from closed formulas: a window of any size must agree with
 * the curve. */
START_TEST(any_window)
{
    const uint32_t window = 2u + (uint32_t)_i;
    fill(0.0003);
    const struct apex_sums sums = add_up(stance, window);
    /* A window of few samples amplifies the rounding of each, about 6e-8 of an angle. */
    assert_close((double)apex_fit_solve(&sums, window).speed_rad_s, 0.8,
                 2e-5 + 3e-7 / (1e-3 * window), 0.0);
}
END_TEST

/* A curve whose slope changes threefold in the window: the crossing is found within its three steps all the same. */
START_TEST(a_bent_curve)
{
    const double late_s = 0.045, w = 1e-3 * WINDOW;
    for (int n = -WINDOW; n <= WINDOW; n++) {
        const double t = late_s + 1e-3 * n;
        stance[(CENTRE + n) % SIZE] = (real)(-0.8 * (t - 0.25 * t * t * t / (w * w)));
    }
    const struct apex_sums sums = add_up(stance, WINDOW);
    const struct apex_fit fit = apex_fit_solve(&sums, WINDOW);
    assert_close((double)fit.before_tick_s, late_s, 2e-6, 0.0);
    assert_close((double)fit.speed_rad_s, 0.8, 2e-4, 0.0);
}
END_TEST

/* Bent both ways: flat where it crosses, far from the middle. Newton's own steps come as near as rounding lets them; a
 * slope that leaves out a part of the third power is 80 us off. */
START_TEST(a_curve_that_is_bent_both_ways)
{
    const double w = 1e-3 * WINDOW, size_rad = 0.064, bend = 0.8, twist = 0.9;
    for (int sign = -1; sign <= 1; sign += 2) {
        const double at = 0.9 * sign; /* of the window, where it crosses */
        for (int n = -WINDOW; n <= WINDOW; n++) {
            const double u = (double)n / WINDOW;
            stance[(CENTRE + n) % SIZE] =
                (real)(size_rad * (at - u + bend * sign * (at * at - u * u) -
                                   twist * (at * at * at - u * u * u)));
        }
        const struct apex_sums sums = add_up(stance, WINDOW);
        const struct apex_fit fit = apex_fit_solve(&sums, WINDOW);
        assert_close((double)fit.before_tick_s, -at * w, 5e-6, 0.0);
        const double slope = size_rad * (-1.0 - 2.0 * bend * sign * at + 3.0 * twist * at * at);
        assert_close((double)fit.speed_rad_s, -slope / w, 1e-3, 0.0);
    }
}
END_TEST

START_TEST(a_leg_that_does_not_fall_gives_no_apex)
{
    for (int i = 0; i < SIZE; i++) {
        stance[i] = (real)0.01 * (real)((i + SIZE - CENTRE % SIZE) % SIZE);
    }
    const struct apex_sums sums = add_up(stance, WINDOW);
    ck_assert(!(apex_fit_solve(&sums, WINDOW).speed_rad_s > 0));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("apex_fit");
    TCase *tcase = tcase_create("fit");
    tcase_add_loop_test(tcase, both_legs_of_a_cubic, 0, 10);
    tcase_add_loop_test(tcase, any_window, 0, WINDOW - 1);
    tcase_add_test(tcase, a_bent_curve);
    tcase_add_test(tcase, a_curve_that_is_bent_both_ways);
    tcase_add_test(tcase, a_leg_that_does_not_fall_gives_no_apex);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
