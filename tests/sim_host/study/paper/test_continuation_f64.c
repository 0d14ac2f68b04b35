/* Orbits, continuation and cascades as functions: what the program's tests do not reach. */
#include <math.h>

#include "sim_host/gait/branch.h"
#include "sim_host/study/paper/cascade.h"
#include "tests/model/walkers.h"

static struct problem problem_at(double r0, double kp, double x[3])
{
    struct problem problem = {.params = walker_paper_params(), .r0_m = r0, .kp = kp, .period = 1};
    struct orbit scratch;
    ck_assert(branch_find(BRANCH_LONG, &problem.params, r0, x, NULL));
    for (int i = 0; i < 3; i++) {
        problem.reference_x[i] = x[i];
    }
    ck_assert_int_eq(problem_prepare(&problem, &scratch), ORBIT_OK);
    return problem;
}

/* d(next)/d(parameter) of an orbit of any period against central differences, law included. */
static void check_parameter(double kp, int period, enum parameter parameter)
{
    double x[3], ends[2][3];
    struct problem problem = problem_at(0.07, kp, x);
    struct orbit orbit = {.x = {x[0] + 0.01, x[1] - 0.003, x[2] + 0.02}};
    problem.period = period;
    ck_assert_int_eq(orbit_evaluate(&problem, 1, &orbit), ORBIT_OK);
    const double value = problem_get(&problem, parameter);
    const double h = 3e-5 * (value > 0.01 ? value : 0.01);
    for (int side = 0; side < 2; side++) {
        struct problem shifted = problem;
        struct orbit there = {.x = {orbit.x[0], orbit.x[1], orbit.x[2]}};
        problem_set(&shifted, parameter, value + (side ? h : -h));
        ck_assert_int_eq(problem_prepare(&shifted, &there), ORBIT_OK);
        ck_assert_int_eq(orbit_evaluate(&shifted, 0, &there), ORBIT_OK);
        for (int i = 0; i < 3; i++) {
            ends[side][i] = there.next[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        const double want = (ends[1][i] - ends[0][i]) / (2.0 * h);
        ck_assert_msg(is_close(orbit.by_parameter[i][parameter], want, 2e-6, 2e-5),
                      "d/d%s, kp %g, period %d, entry %d: %.9g, expected %.9g",
                      parameter_name(parameter), kp, period, i, orbit.by_parameter[i][parameter],
                      want);
    }
}

START_TEST(derivatives_by_every_parameter)
{
    for (int p = 0; p < PARAMETER_COUNT; p++) {
        for (int period = 1; period <= 3; period += 2) {
            check_parameter(0.0, period, (enum parameter)p);
            check_parameter(0.03, period, (enum parameter)p);
        }
    }
}
END_TEST

static int count_points(void *context, const struct branch_point *point)
{
    int *const count = context;
    ck_assert(point->orbit.residual < 1e-12);
    return ++*count < 5;
}

START_TEST(the_visitor_can_stop)
{
    double x[3];
    int count = 0;
    const struct problem problem = problem_at(0.05, 0.0, x);
    const struct continuation c = {.problem = problem,
                                   .over = PARAMETER_R0,
                                   .from = 0.05,
                                   .to = 0.2,
                                   .first_step = 0.01,
                                   .longest_step = 0.01,
                                   .most_points = 100};
    const struct continuation_report r = continuation_follow(&c, x, NULL, count_points, &count);
    ck_assert_int_eq(r.end, END_STOPPED);
    ck_assert_int_eq(count, 5);
}
END_TEST

START_TEST(a_start_that_is_no_gait_is_told)
{
    double x[3];
    int count = 0;
    const struct problem problem = problem_at(0.05, 0.0, x);
    const struct continuation c = {.problem = problem,
                                   .over = PARAMETER_R0,
                                   .from = 0.05,
                                   .to = 0.2,
                                   .first_step = 0.01,
                                   .longest_step = 0.01,
                                   .most_points = 100};
    const double nowhere[3] = {-3.0, 1.0, 0.0};
    const struct continuation_report r =
        continuation_follow(&c, nowhere, NULL, count_points, &count);
    ck_assert_int_eq(r.end, END_LOST);
    ck_assert_int_eq(r.last_status, ORBIT_FAULT);
    ck_assert_int_eq(count, 0);
}
END_TEST

START_TEST(a_doubling_is_where_the_eigenvalue_is_minus_one)
{
    struct doubling found[2];
    struct continuation_report report;
    double x[3];
    struct problem problem = problem_at(0.06, 0.0, x);
    ck_assert_int_eq(
        cascade_find(&problem, PARAMETER_R0, 0.06, 0.1, x, 2, found, &report, NULL, NULL), 2);
    for (int i = 0; i < 2; i++) {
        struct orbit orbit = {.x = {found[i].x[0], found[i].x[1], found[i].x[2]}};
        struct eigenvalue values[3];
        problem.r0_m = found[i].parameter;
        problem.period = found[i].new_period / 2;
        ck_assert_int_eq(orbit_evaluate(&problem, 1, &orbit), ORBIT_OK);
        linear_eigenvalues3((const double(*)[3])orbit.by_x, values);
        assert_close(values[0].re, -1.0, 1e-9, 0.0);
        ck_assert(orbit.residual < 1e-11);
    }
    double doubled[3];
    problem.period = 1;
    ck_assert(cascade_double_to(&problem, PARAMETER_R0, &found[0], 0.08, doubled));
    assert_close(fmin(doubled[0], -0.5), doubled[0], 1e-12, 0.0);
}
END_TEST

START_TEST(the_law_keeps_the_gait)
{
    double x[3];
    for (double r0 = 0.03; r0 < 0.3; r0 += 0.05) {
        const struct problem problem = problem_at(r0, 0.042, x);
        struct orbit orbit = {.x = {x[0], x[1], x[2]}};
        ck_assert_int_eq(orbit_evaluate(&problem, 0, &orbit), ORBIT_OK);
        ck_assert(orbit.residual < 1e-11);
    }
}
END_TEST

START_TEST(bad_walkers_are_told)
{
    struct problem problem = {.params = walker_paper_params(), .r0_m = 0.05, .period = 1};
    struct orbit scratch;
    problem.params.leg_length_m = -1.0;
    ck_assert_int_eq(problem_prepare(&problem, &scratch), ORBIT_BAD_WALKER);
    ck_assert_int_eq(scratch.walker_error, WALKER_BAD_LEG_LENGTH);
    problem.params = walker_paper_params();
    problem.kp = 0.04; /* with no reference gait near */
    ck_assert_int_eq(problem_prepare(&problem, &scratch), ORBIT_NO_REFERENCE);
    for (int s = ORBIT_NO_REFERENCE; s <= ORBIT_OK; s++) {
        ck_assert_str_ne(orbit_status_name((enum orbit_status)s), "unknown status");
    }
    ck_assert_ptr_null(parameter_name(PARAMETER_COUNT));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("continuation");
    TCase *tests = tcase_create("continuation");
    suite_add_tcase(suite, tests);
    tcase_set_timeout(tests, 60.0);
    tcase_add_test(tests, derivatives_by_every_parameter);
    tcase_add_test(tests, the_visitor_can_stop);
    tcase_add_test(tests, a_start_that_is_no_gait_is_told);
    tcase_add_test(tests, a_doubling_is_where_the_eigenvalue_is_minus_one);
    tcase_add_test(tests, the_law_keeps_the_gait);
    tcase_add_test(tests, bad_walkers_are_told);
    return run_suite(suite);
}
