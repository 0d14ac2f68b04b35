/* The branch of steady gaits against its header's words: cubics and straight lines that are known, a cost summed by
 * hand, and what a table must be to be used. */
#include "controller/laws/gait_branch.h"

#include <math.h>
#include <stdlib.h>

#include "tests/support/assert_close.h"

enum { POINTS = 7 };

static struct gait_branch branch;

/* Of a form that is never negative; at entry i, or between two. */
static double p_of(int k, double i)
{
    return k < 3 ? 4.0 + k + 0.1 * i : 0.2 * k + 0.05 * i;
}

static double cubic(double s)
{
    return 0.02 + 0.01 * s + 0.003 * s * s + 0.0004 * s * s * s;
}

/* Speeds 0.2, 0.3, ... 0.8 rad/s: gaits on a cubic of the entry's number, costs and gains on straight lines. */
static void setup(void)
{
    branch = (struct gait_branch){.count = POINTS,
                                  .speed_min_rad_s = REAL(0.2),
                                  .speed_step_rad_s = REAL(0.1),
                                  .r0_weight = REAL(3.0),
                                  .travel_weight = REAL(0.5)};
    for (int i = 0; i < POINTS; i++) {
        struct gait_branch_point *point = &branch.point[i];
        point->r0_m = (real)cubic(i);
        point->swing_angle_rad = (real)(-2.0 * cubic(i));
        point->swing_rate_rad_s = (real)(5.0 * cubic(i));
        for (int k = 0; k < GAIT_BRANCH_COSTS; k++) {
            point->cost[k] = (real)(p_of(k, i));
        }
        for (int k = 0; k < 3; k++) {
            point->lqr_gain[k] = (real)(0.3 * k - 0.2 * i);
            point->deadbeat_gain[k] = (real)(0.5 * k + 0.4 * i);
        }
    }
}

START_TEST(gaits_by_a_cubic_costs_and_gains_by_lines)
{
    for (double speed = 0.1; speed < 0.95; speed += 0.017) {
        struct gait_branch_point gait;
        const double clamped = fmin(fmax(speed, 0.2), 0.8), at = (clamped - 0.2) / 0.1;
        assert_close(gait_branch_at(&branch, (real)speed, &gait), clamped, 1e-6, 0.0);
        assert_close(gait.r0_m, cubic(at), 2e-6, 0.0);
        assert_close(gait.swing_angle_rad, -2.0 * cubic(at), 4e-6, 0.0);
        assert_close(gait.swing_rate_rad_s, 5.0 * cubic(at), 1e-5, 0.0);
        for (int k = 0; k < GAIT_BRANCH_COSTS; k++) {
            assert_close(gait.cost[k], p_of(k, at), 1e-5, 0.0);
        }
        for (int k = 0; k < 3; k++) {
            assert_close(gait.lqr_gain[k], 0.3 * k - 0.2 * at, 1e-5, 0.0);
            assert_close(gait.deadbeat_gain[k], 0.5 * k + 0.4 * at, 1e-5, 0.0);
        }
    }
}
END_TEST

/* e' P e + weight (r0 - r0*)^2, the sums of P's other halves at 12, 13 and 23. */
static double cost_of(double speed_rad_s, double r0_star_m, double angle, double rate,
                      const double p[6], const struct apex *apex, double r0_m)
{
    const double e[3] = {(double)apex->stance_rate_rad_s + speed_rad_s,
                         (double)apex->swing_angle_rad - angle,
                         (double)apex->swing_rate_rad_s - rate};
    return p[0] * e[0] * e[0] + p[1] * e[1] * e[1] + p[2] * e[2] * e[2] + p[3] * e[0] * e[1] +
           p[4] * e[0] * e[2] + p[5] * e[1] * e[2] + 3.0 * (r0_m - r0_star_m) * (r0_m - r0_star_m);
}

static double cost_to(int i, const struct apex *apex, double r0_m)
{
    double p[6];
    for (int k = 0; k < 6; k++) {
        p[k] = p_of(k, i);
    }
    return cost_of(0.2 + 0.1 * i, cubic(i), -2.0 * cubic(i), 5.0 * cubic(i), p, apex, r0_m);
}

static struct apex apex_near(int i, double off)
{
    return (struct apex){(real)(-0.2 - 0.1 * i + 0.02 * off), (real)(-2.0 * cubic(i) + 0.03 * off),
                         (real)(5.0 * cubic(i) - 0.01 * off)};
}

START_TEST(a_cost_is_the_quadratic_form_of_the_departure)
{
    for (int i = 0; i < POINTS; i++) {
        for (int off = -3; off <= 3; off++) {
            const struct apex apex = apex_near(i, off);
            const double r0_m = cubic(i) + 0.01 * off;
            real departure[3];
            gait_branch_departure(&branch.point[i], (real)(0.2 + 0.1 * i), &apex, departure);
            assert_close(departure[0], 0.02 * off, 1e-6, 0.0);
            assert_close(departure[1], 0.03 * off, 1e-6, 0.0);
            assert_close(departure[2], -0.01 * off, 1e-6, 0.0);
            assert_close(gait_branch_cost(&branch, &branch.point[i], (real)(0.2 + 0.1 * i), &apex,
                                          (real)r0_m),
                         cost_to(i, &apex, r0_m), 1e-7, 1e-4);
        }
    }
}
END_TEST

/* The cheapest of going straight to the target and of each gait first, the first and the last of them, too. */
START_TEST(a_distance_is_the_cheapest_way_by_any_gait)
{
    for (int target = 0; target < POINTS; target++) {
        for (int near = 0; near < POINTS; near++) {
            for (int off = -2; off <= 2; off++) {
                const struct apex apex = apex_near(near, off);
                const double r0_m = cubic(near), speed = 0.2 + 0.1 * target;
                double least = cost_to(target, &apex, r0_m);
                for (int i = 0; i < POINTS; i++) {
                    least = fmin(least, 0.5 * 0.1 * abs(target - i) + cost_to(i, &apex, r0_m));
                }
                assert_close(gait_branch_distance(&branch, &branch.point[target], (real)speed,
                                                  &apex, (real)r0_m),
                             least, 1e-6, 1e-4);
            }
        }
    }
    const struct apex first = apex_near(0, 0); /* by the first gait alone */
    assert_close(gait_branch_distance(&branch, &branch.point[6], REAL(0.8), &first, (real)cubic(0)),
                 0.3, 1e-5, 0.0);
    const struct apex last = apex_near(6, 0);
    assert_close(gait_branch_distance(&branch, &branch.point[0], REAL(0.2), &last, (real)cubic(6)),
                 0.3, 1e-5, 0.0);
}
END_TEST

/* Positive, finite, rising, and of 4 to 40 entries. */
START_TEST(a_table_that_is_none_is_refused)
{
    ck_assert_int_eq(gait_branch_check(&branch), 1);
#define REFUSED(change) \
    setup();            \
    change;             \
    ck_assert_int_eq(gait_branch_check(&branch), 0)
#define TAKEN(change) \
    setup();          \
    change;           \
    ck_assert_int_eq(gait_branch_check(&branch), 1)
    REFUSED(branch.count = 3);
    TAKEN(branch.count = 4);
    REFUSED(branch.count = GAIT_BRANCH_MAX + 1);
    REFUSED(branch.speed_min_rad_s = REAL(0.0));
    REFUSED(branch.speed_step_rad_s = REAL(0.0));
    REFUSED(branch.r0_weight = REAL(-0.1));
    TAKEN(branch.r0_weight = REAL(0.0));
    REFUSED(branch.travel_weight = REAL(0.0));
    for (int i = 0; i < 4; i++) {
        real *const numbers[] = {&branch.speed_min_rad_s, &branch.speed_step_rad_s,
                                 &branch.r0_weight, &branch.travel_weight};
        REFUSED(*numbers[i] = (real)INFINITY);
        REFUSED(*numbers[i] = (real)NAN);
    }
    for (int i = 0; i < POINTS; i++) {
        struct gait_branch_point *point = &branch.point[i];
        REFUSED(point->r0_m = (real)NAN);
        REFUSED(point->swing_angle_rad = (real)NAN);
        REFUSED(point->swing_rate_rad_s = (real)INFINITY);
        REFUSED(point->cost[0] = REAL(0.0));
        for (int k = 0; k < GAIT_BRANCH_COSTS; k++) {
            REFUSED(point->cost[k] = (real)NAN);
        }
        for (int k = 0; k < 3; k++) {
            REFUSED(point->lqr_gain[k] = (real)NAN);
            REFUSED(point->deadbeat_gain[k] = (real)NAN);
        }
    }
    REFUSED(branch.point[0].r0_m = REAL(0.0));
    for (int i = 1; i < POINTS; i++) {
        REFUSED(branch.point[i].r0_m = branch.point[i - 1].r0_m); /* not rising */
    }
#undef REFUSED
#undef TAKEN
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gait branch");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, gaits_by_a_cubic_costs_and_gains_by_lines);
    tcase_add_test(tests, a_cost_is_the_quadratic_form_of_the_departure);
    tcase_add_test(tests, a_distance_is_the_cheapest_way_by_any_gait);
    tcase_add_test(tests, a_table_that_is_none_is_refused);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
