/* The least-squares state at an apex, against curves whose slope is known. */
#include <check.h>

#include "controller/apex_fit.h"
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

START_TEST(both_legs_of_a_cubic)
{
    const double late_s = 0.1e-3 * _i;
    fill(late_s);
    const struct apex_fit fit = apex_fit_solve(stance, SIZE, CENTRE, WINDOW);
    assert_close((double)fit.speed_rad_s, 0.8, 2e-5, 0.0);
    assert_close((double)fit.before_tick_s, late_s, 1e-6, 0.0);
    const struct angle_fit other =
        apex_fit_other_leg(swing, SIZE, CENTRE, WINDOW, fit.before_tick_s);
    assert_close((double)other.angle_rad, -0.06, 2e-6, 0.0);
    assert_close((double)other.rate_rad_s, 1.7, 2e-5, 0.0);
}
END_TEST

START_TEST(a_leg_that_does_not_fall_gives_no_apex)
{
    for (int i = 0; i < SIZE; i++) {
        stance[i] = (real)0.01 * (real)((i + SIZE - CENTRE % SIZE) % SIZE);
    }
    ck_assert(!(apex_fit_solve(stance, SIZE, CENTRE, WINDOW).speed_rad_s > 0));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("apex_fit");
    TCase *tcase = tcase_create("fit");
    tcase_add_loop_test(tcase, both_legs_of_a_cubic, 0, 10);
    tcase_add_test(tcase, a_leg_that_does_not_fall_gives_no_apex);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
