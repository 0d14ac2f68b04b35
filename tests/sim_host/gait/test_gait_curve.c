/* The gait curve as float-compiled callers see it. */
#include <math.h>

#include "sim_host/gait/gait_curve.h"
#include "tests/support/assert_close.h"

START_TEST(the_papers_gait_lies_on_the_curve)
{
    const struct gait_walker walker = gait_walker_of_paper();
    struct gait_point point;
    ck_assert_int_eq(gait_curve(&walker, 0.05, 0.0, 1, &point, NULL), GAIT_CURVE_OK);
    assert_close(point.apex[0], -0.406960, 1e-6, 0.0);
    assert_close(point.apex[1], -0.059569, 1e-6, 0.0);
    assert_close(point.apex[2], 1.756768, 1e-6, 0.0);
    assert_close(point.speed_rad_s, 0.406960, 1e-6, 0.0);
    assert_close(point.step_length_m, 2.0 * sin(point.inter_leg_rad / 2.0), 1e-12, 0.0);
}
END_TEST

START_TEST(it_rises_from_the_floor_to_the_clamped_gaits)
{
    const struct gait_walker walker = gait_walker_of_paper();
    static struct gait_point points[64];
    int reached = 0;
    ck_assert_int_eq(gait_curve(&walker, 0.002, 0.298 / 63.0, 64, points, &reached), GAIT_CURVE_OK);
    ck_assert_int_eq(reached, 64);
    for (int i = 1; i < 64; i++) {
        ck_assert(points[i].speed_rad_s > points[i - 1].speed_rad_s);
        ck_assert_int_eq(points[i].clamped, points[i].r0_m > 0.266);
    }
}
END_TEST

START_TEST(a_walker_scaled_in_size_mass_and_gravity_walks_the_same_gait_scaled)
{
    const struct gait_walker paper = gait_walker_of_paper();
    const double l = 0.8, g = 1.62, M = 40.0;
    const struct gait_walker other = {M, 0.01 * M, l, 100.0 / 9.80665 * M * g / l, g};
    struct gait_point a, b;
    ck_assert_int_eq(gait_curve(&paper, 0.1, 0.0, 1, &a, NULL), GAIT_CURVE_OK);
    ck_assert_int_eq(gait_curve(&other, 0.1 * l, 0.0, 1, &b, NULL), GAIT_CURVE_OK);
    assert_close(b.speed_rad_s, a.speed_rad_s * sqrt(g / l / 9.80665), 0.0, 1e-12);
    assert_close(b.double_support_s, a.double_support_s / sqrt(g / l / 9.80665), 0.0, 1e-11);
    assert_close(b.step_length_m, a.step_length_m * l, 0.0, 1e-12);
}
END_TEST

START_TEST(other_walkers_are_reached)
{
    const struct gait_walker walkers[] = {{65.0, 2.5, 0.93, 7000.0, 9.80665},
                                          {1.0, 0.2, 1.0, 100.0, 9.80665},
                                          {1.0, 0.001, 1.0, 100.0, 9.80665},
                                          {1.0, 0.01, 1.0, 50.0, 9.80665}};
    for (int i = 0; i < 4; i++) {
        struct gait_point points[40];
        const double l = walkers[i].leg_length_m;
        ck_assert_int_eq(gait_curve(&walkers[i], 0.005 * l, 0.245 * l / 39.0, 40, points, NULL),
                         GAIT_CURVE_OK);
        for (int k = 1; k < 40; k++) {
            ck_assert(points[k].speed_rad_s > points[k - 1].speed_rad_s);
        }
    }
}
END_TEST

START_TEST(what_cannot_be_served_is_refused)
{
    struct gait_walker walker = gait_walker_of_paper();
    struct gait_point point;
    int reached = 7;
    ck_assert_int_eq(gait_curve(&walker, 0.001, 0.0, 1, &point, &reached), GAIT_CURVE_BAD_GRID);
    ck_assert_int_eq(reached, 0);
    ck_assert_int_eq(gait_curve(&walker, 0.05, 0.01, 0, &point, NULL), GAIT_CURVE_BAD_GRID);
    ck_assert_int_eq(gait_curve(&walker, 0.05, -0.01, 2, &point, NULL), GAIT_CURVE_BAD_GRID);
    ck_assert_int_eq(gait_curve(&walker, (double)NAN, 0.0, 1, &point, NULL), GAIT_CURVE_BAD_GRID);
    walker.leg_length_m = -1.0;
    ck_assert_int_eq(gait_curve(&walker, 0.05, 0.0, 1, &point, NULL), GAIT_CURVE_BAD_WALKER);
    walker = gait_walker_of_paper();
    walker.ankle_stiffness_N_m = 1e-3; /* carries nobody */
    ck_assert_int_eq(gait_curve(&walker, 0.05, 0.0, 1, &point, NULL), GAIT_CURVE_LOST);
    ck_assert(gait_curve_error_name(GAIT_CURVE_LOST)[0] != '\0');
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gait_curve");
    TCase *tests = tcase_create("gait_curve");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, the_papers_gait_lies_on_the_curve);
    tcase_add_test(tests, it_rises_from_the_floor_to_the_clamped_gaits);
    tcase_add_test(tests, a_walker_scaled_in_size_mass_and_gravity_walks_the_same_gait_scaled);
    tcase_add_test(tests, other_walkers_are_reached);
    tcase_add_test(tests, what_cannot_be_served_is_refused);
    return run_suite(suite);
}
