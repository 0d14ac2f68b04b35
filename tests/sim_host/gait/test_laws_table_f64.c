/* The laws' table against what it claims: gaits that repeat, gains that do what their names say, all
 * checked on the return map itself and on matrices differenced here. */
#include "sim_host/gait/laws_table.h"

#include <math.h>

#include "model/stride.h"
#include "tests/support/assert_close.h"

static struct laws_table table;
static struct walker walker;

static void make_table(void)
{
    const struct gait_walker paper = gait_walker_of_paper();
    const struct laws_weights weights = laws_weights_default();
    const struct walker_params params = walker_paper_params();
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    ck_assert_int_eq(laws_table_make(&paper, 1.0, 0.0, &weights, &table), LAWS_TABLE_OK);
}

static void next_of(const double x[3], double r0, double next[3])
{
    const struct stride_settings settings = stride_settings_accurate(&walker);
    const struct apex from = {x[0], x[1], x[2]};
    struct stride_result result;
    ck_assert_int_eq(stride(&walker, &settings, &from, r0, &result), STRIDE_OK);
    next[0] = result.next.stance_rate_rad_s;
    next[1] = result.next.swing_angle_rad;
    next[2] = result.next.swing_rate_rad_s;
}

START_TEST(gaits_repeat)
{
    for (int i = 0; i < table.count; i++) {
        const struct laws_point *p = &table.point[i];
        const double x[3] = {-p->speed_rad_s, p->swing_angle_rad, p->swing_rate_rad_s};
        double next[3];
        next_of(x, p->r0_m, next);
        for (int k = 0; k < 3; k++) {
            assert_close(next[k], x[k], 1e-10, 0.0);
        }
    }
}
END_TEST

START_TEST(the_papers_gait_lies_on_the_table)
{
    /* model/README.md: r0 = 0.05 walks at 0.406960 */
    int i = 0;
    while (table.point[i + 1].r0_m < 0.05) {
        i++;
    }
    const double share =
        (0.05 - table.point[i].r0_m) / (table.point[i + 1].r0_m - table.point[i].r0_m);
    assert_close(table.point[i].speed_rad_s + share * table.speed_step_rad_s, 0.406960, 3e-4, 0.0);
}
END_TEST

/* Distance from the gait after `steps` strides of the map under r0 = r0* - gain . departure. */
static double distance_after(const struct laws_point *p, const double gain[3], double start,
                             int steps)
{
    double x[3] = {-p->speed_rad_s + start, p->swing_angle_rad, p->swing_rate_rad_s};
    for (int k = 0; k < steps; k++) {
        const double e[3] = {x[0] + p->speed_rad_s, x[1] - p->swing_angle_rad,
                             x[2] - p->swing_rate_rad_s};
        double next[3];
        next_of(x, p->r0_m - (gain[0] * e[0] + gain[1] * e[1] + gain[2] * e[2]), next);
        x[0] = next[0];
        x[1] = next[1];
        x[2] = next[2];
    }
    return fabs(x[0] + p->speed_rad_s) + fabs(x[1] - p->swing_angle_rad) +
           fabs(x[2] - p->swing_rate_rad_s);
}

START_TEST(gains_bring_the_map_back)
{
    for (int i = 0; i < table.count; i++) {
        const struct laws_point *p = &table.point[i];
        ck_assert_msg(distance_after(p, p->lqr_gain, 1e-5, 60) < 1e-6, "dlqr at %g rad/s",
                      p->speed_rad_s);
        /* All eigenvalues zero: three strides end at the gait, to second order in the departure.
         * Near 0.24 rad/s the push-off loses hold of one direction and the gain grows without bound. */
        if (p->speed_rad_s > 0.35) {
            ck_assert_msg(distance_after(p, p->deadbeat_gain, 1e-5, 3) < 1e-8,
                          "deadbeat at %g rad/s", p->speed_rad_s);
        }
    }
}
END_TEST

/* The sum over the strides of a linear map, walked here step by step, is what `cost` foretells. */
START_TEST(cost_is_the_sum_of_what_lies_ahead)
{
    const struct laws_weights w = laws_weights_default();
    for (int i = 0; i < table.count; i += 3) {
        const struct laws_point *p = &table.point[i];
        double e[3] = {0.3, -0.2, 0.5};
        const double *c = p->cost;
        const double foretold = e[0] * e[0] * c[0] + e[1] * e[1] * c[1] + e[2] * e[2] * c[2] +
                                e[0] * e[1] * c[3] + e[0] * e[2] * c[4] + e[1] * e[2] * c[5];
        double sum = 0.0;
        for (int k = 0; k < 5000; k++) {
            const double push =
                -(p->lqr_gain[0] * e[0] + p->lqr_gain[1] * e[1] + p->lqr_gain[2] * e[2]);
            sum += w.speed * e[0] * e[0] + w.swing_angle * e[1] * e[1] +
                   w.swing_rate * e[2] * e[2] + table.r0_weight * push * push;
            double next[3];
            for (int a = 0; a < 3; a++) {
                next[a] = p->map[a][0] * e[0] + p->map[a][1] * e[1] + p->map[a][2] * e[2] +
                          p->input[a] * push;
            }
            e[0] = next[0];
            e[1] = next[1];
            e[2] = next[2];
        }
        assert_close(foretold, sum, 0.0, 1e-9);
    }
}
END_TEST

START_TEST(another_size_is_the_same_walker)
{
    /* l = 0.5 with k scaled to keep k l / (M g): speeds grow by sqrt 2, lengths halve, costs stay. */
    struct gait_walker small = gait_walker_of_paper();
    const struct laws_weights weights = laws_weights_default();
    static struct laws_table other;
    small.leg_length_m = 0.5;
    small.ankle_stiffness_N_m = 200.0;
    ck_assert_int_eq(laws_table_make(&small, 0.5, 0.0, &weights, &other), LAWS_TABLE_OK);
    for (int i = 0; i < table.count; i += 13) {
        assert_close(other.point[i].speed_rad_s, sqrt(2.0) * table.point[i].speed_rad_s, 0.0, 1e-9);
        assert_close(other.point[i].r0_m, 0.5 * table.point[i].r0_m, 0.0, 1e-9);
        assert_close(other.point[i].cost[1], table.point[i].cost[1], 0.0, 1e-6);
        assert_close(2.0 * other.point[i].cost[0], table.point[i].cost[0], 0.0, 1e-6);
    }
}
END_TEST

START_TEST(a_walker_without_gaits_is_refused)
{
    struct gait_walker bad = gait_walker_of_paper();
    const struct laws_weights weights = laws_weights_default();
    static struct laws_table none;
    bad.hip_mass_kg = -1.0;
    ck_assert_int_eq(laws_table_make(&bad, 1.0, 0.0, &weights, &none), LAWS_TABLE_NO_CURVE);
    ck_assert_ptr_nonnull(laws_table_error_name(LAWS_TABLE_NO_CURVE));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("laws_table");
    TCase *tests = tcase_create("all");
    tcase_add_unchecked_fixture(tests, make_table, NULL);
    tcase_add_test(tests, gaits_repeat);
    tcase_add_test(tests, the_papers_gait_lies_on_the_table);
    tcase_add_test(tests, gains_bring_the_map_back);
    tcase_add_test(tests, cost_is_the_sum_of_what_lies_ahead);
    tcase_add_test(tests, another_size_is_the_same_walker);
    tcase_add_test(tests, a_walker_without_gaits_is_refused);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
