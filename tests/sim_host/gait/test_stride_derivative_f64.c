/* The variational derivative against differences of the return map, extrapolated twice. */
#include <math.h>

#include "sim_host/gait/stride_derivative.h"
#include "tests/model/walkers.h"

struct point_of_map {
    double value[6]; /* stance rate, swing angle, swing rate, r0, k, m */
};

static void evaluate(const struct walker_params *params, const struct point_of_map *at,
                     double next[3])
{
    struct walker walker;
    struct walker_params p = *params;
    p.ankle_stiffness_N_m = at->value[4];
    p.leg_mass_kg = at->value[5];
    ck_assert_int_eq(walker_init(&walker, &p), WALKER_OK);
    struct stride_settings settings = stride_settings_accurate(&walker);
    settings.single_step_s /= 2.0; /* differences enlarge the error of the steps */
    settings.double_step_s /= 2.0;
    const struct apex from = {at->value[0], at->value[1], at->value[2]};
    struct stride_result r;
    ck_assert_int_eq(stride(&walker, &settings, &from, at->value[3], &r), STRIDE_OK);
    next[0] = r.next.stance_rate_rad_s;
    next[1] = r.next.swing_angle_rad;
    next[2] = r.next.swing_rate_rad_s;
}

/* Central differences at h, h/2, h/4; Richardson to order six. */
static void differences(const struct walker_params *params, const struct point_of_map *at,
                        int column, double h, double out[3])
{
    double table[3][3];
    for (int level = 0; level < 3; level++, h *= 0.5) {
        struct point_of_map up = *at, down = *at;
        double a[3], b[3];
        up.value[column] += h;
        down.value[column] -= h;
        evaluate(params, &up, a);
        evaluate(params, &down, b);
        for (int i = 0; i < 3; i++) {
            table[level][i] = (a[i] - b[i]) / (2.0 * h);
        }
    }
    for (int i = 0; i < 3; i++) {
        const double first = (4.0 * table[1][i] - table[0][i]) / 3.0;
        const double second = (4.0 * table[2][i] - table[1][i]) / 3.0;
        out[i] = (16.0 * second - first) / 15.0;
    }
}

static void compare(const struct walker_params *params, const struct point_of_map *at)
{
    struct walker walker;
    struct walker_params p = *params;
    p.ankle_stiffness_N_m = at->value[4];
    p.leg_mass_kg = at->value[5];
    ck_assert_int_eq(walker_init(&walker, &p), WALKER_OK);
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {at->value[0], at->value[1], at->value[2]};
    struct stride_result r;
    struct stride_derivative got;
    ck_assert_int_eq(stride_differentiate(&walker, &settings, &from, at->value[3], &r, &got),
                     STRIDE_OK);
    for (int c = 0; c < SENSITIVITY_COLUMNS; c++) {
        double want[3];
        const double size = fabs(at->value[c]);
        differences(params, at, c, 2e-3 * (size > 0.05 ? size : 0.05), want);
        for (int i = 0; i < 3; i++) {
            assert_close(got.next[i][c], want[i], 2e-10, 2e-9);
        }
    }
}

START_TEST(derivative_of_the_papers_walker)
{
    const struct walker_params paper = walker_paper_params();
    const struct point_of_map at[] = {
        {{-0.406960, -0.059569, 1.756768, 0.05, 100.0, 0.01}},
        {{-0.521217, -0.205854, 1.416979, 0.05, 100.0, 0.01}},
        {{-0.65, -0.08, 2.6, 0.12, 100.0, 0.01}},
        {{-0.96, -0.1195, 3.31, 0.23, 100.0, 0.01}},
    };
    for (unsigned i = 0; i < sizeof at / sizeof at[0]; i++) {
        compare(&paper, &at[i]);
    }
}
END_TEST

START_TEST(derivative_where_the_clamp_acts)
{
    const struct walker_params paper = walker_paper_params();
    const struct point_of_map at = {{-1.1581, -0.1392, 3.604, 0.289, 100.0, 0.01}};
    compare(&paper, &at);
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {-1.1581, -0.1392, 3.604};
    struct stride_result r;
    struct stride_derivative d;
    ck_assert_int_eq(stride_differentiate(&walker, &settings, &from, 0.289, &r, &d), STRIDE_OK);
    ck_assert_int_eq(r.clamped, 1);
}
END_TEST

START_TEST(derivative_of_heavy_legs)
{
    const struct walker_params adult = {65.0, 2.5, 0.93, 7000.0, 9.80665};
    const struct walker_params heavy = {1.0, 0.2, 1.0, 100.0, 9.80665};
    const struct point_of_map a = {{-0.45, -0.06, 1.9, 0.05, 7000.0, 2.5}};
    const struct point_of_map b = {{-0.35, -0.06, 1.6, 0.08, 100.0, 0.2}};
    compare(&adult, &a);
    compare(&heavy, &b);
}
END_TEST

START_TEST(two_numbers_survive_the_collision)
{
    /* DG = (next by d, r'+) times (d, r'+ by x): rank two, so its determinant is zero. */
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {-0.65, -0.08, 2.6};
    struct stride_result r;
    struct stride_derivative g;
    ck_assert_int_eq(stride_differentiate(&walker, &settings, &from, 0.12, &r, &g), STRIDE_OK);
    const double det = g.next[0][0] * (g.next[1][1] * g.next[2][2] - g.next[1][2] * g.next[2][1]) -
                       g.next[0][1] * (g.next[1][0] * g.next[2][2] - g.next[1][2] * g.next[2][0]) +
                       g.next[0][2] * (g.next[1][0] * g.next[2][1] - g.next[1][1] * g.next[2][0]);
    assert_close(det, 0.0, 1e-12, 0.0);
    /* The direction that leaves d and r'+ alone leaves the next apex alone. */
    const double *d = g.after_collision[0], *v = g.after_collision[1];
    const double null[3] = {d[1] * v[2] - d[2] * v[1], d[2] * v[0] - d[0] * v[2],
                            d[0] * v[1] - d[1] * v[0]};
    const double size = sqrt(null[0] * null[0] + null[1] * null[1] + null[2] * null[2]);
    for (int i = 0; i < 3; i++) {
        double moved = 0.0;
        for (int j = 0; j < 3; j++) {
            moved += g.next[i][j] * null[j] / size;
        }
        assert_close(moved, 0.0, 1e-11, 0.0);
    }
}
END_TEST

START_TEST(faults_pass_through)
{
    const struct walker walker = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {0.3, 0.0, 0.0};
    struct stride_result r;
    struct stride_derivative d;
    ck_assert_int_eq(stride_differentiate(&walker, &settings, &from, 0.05, &r, &d),
                     STRIDE_WALKING_BACKWARDS);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stride_derivative");
    TCase *tests = tcase_create("stride_derivative");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, derivative_of_the_papers_walker);
    tcase_add_test(tests, derivative_where_the_clamp_acts);
    tcase_add_test(tests, derivative_of_heavy_legs);
    tcase_add_test(tests, two_numbers_survive_the_collision);
    tcase_add_test(tests, faults_pass_through);
    return run_suite(suite);
}
