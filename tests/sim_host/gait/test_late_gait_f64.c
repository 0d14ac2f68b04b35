/* Gaits of a latch that opens late, against strides of model/timed_stride.h and differences made here. */
#include "sim_host/gait/late_gait.h"

#include <math.h>

#include "model/timed_stride.h"
#include "sim_host/gait/late_stride.h"
#include "sim_host/gait/laws_table.h"
#include "tests/support/assert_close.h"

static struct walker walker;
static struct stride_settings settings;
static const struct gait_walker ADULT = {65.0, 2.5, 0.93, 7000.0, 9.80665};

static void setup(void)
{
    const struct walker_params params = walker_paper_params();
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    settings = stride_settings_accurate(&walker);
}

static void next_of(const double x[3], double r0_m, double delay_s, double next[3])
{
    const struct apex from = {x[0], x[1], x[2]};
    struct stride_result result;
    ck_assert_int_eq(timed_stride(&walker, &settings, &from, r0_m, delay_s, &result), STRIDE_OK);
    next[0] = result.next.stance_rate_rad_s;
    next[1] = result.next.swing_angle_rad;
    next[2] = result.next.swing_rate_rad_s;
}

START_TEST(late_gaits_repeat_and_are_slower)
{
    const struct gait_walker paper = gait_walker_of_paper();
    const double delays_s[] = {0.001, 0.005, 0.02, LATE_GAIT_MOST_S};
    static struct gait_point in_time[64], late[64];
    ck_assert_int_eq(gait_curve(&paper, 0.005, 0.295 / 63.0, 64, in_time, NULL), GAIT_CURVE_OK);
    for (int d = 0; d < 4; d++) {
        ck_assert_int_eq(late_gait_curve(&paper, delays_s[d], 0.005, 0.295 / 63.0, 64, late, NULL),
                         GAIT_CURVE_OK);
        for (int i = 0; i < 64; i++) {
            double next[3];
            ck_assert(i == 0 || late[i].speed_rad_s > late[i - 1].speed_rad_s);
            if (late[i].r0_m > 0.255) {
                continue; /* the ankle comes back before the spring is released */
            }
            next_of(late[i].apex, late[i].r0_m, delays_s[d], next);
            for (int k = 0; k < 3; k++) {
                assert_close(next[k], late[i].apex[k], 1e-9, 0.0);
            }
            ck_assert(late[i].speed_rad_s < in_time[i].speed_rad_s);
        }
    }
}
END_TEST

START_TEST(a_delay_costs_the_work_of_the_ankle_s_way_meanwhile)
{
    /* To first order the spring's work of the way e = ankle rate * delay, k r0 e, is missing; the ankle
     * extends as far as ever. So does it with a spring that is softer by dk, r0^2 dk / 2 = k r0 e:
     * dv/d(delay) = dv/dk * (- 2 k / r0) * ankle rate. */
    const struct gait_walker paper = gait_walker_of_paper();
    const double r0s[] = {0.05, 0.1, 0.2};
    for (int i = 0; i < 3; i++) {
        struct gait_walker softer = paper;
        struct gait_point in_time, late, soft;
        struct stride_result result;
        softer.ankle_stiffness_N_m -= 0.01;
        ck_assert_int_eq(gait_curve(&paper, r0s[i], 0.0, 1, &in_time, NULL), GAIT_CURVE_OK);
        ck_assert_int_eq(gait_curve(&softer, r0s[i], 0.0, 1, &soft, NULL), GAIT_CURVE_OK);
        ck_assert_int_eq(late_gait_curve(&paper, 1e-5, r0s[i], 0.0, 1, &late, NULL), GAIT_CURVE_OK);
        const struct apex from = {in_time.apex[0], in_time.apex[1], in_time.apex[2]};
        ck_assert_int_eq(stride(&walker, &settings, &from, r0s[i], &result), STRIDE_OK);
        const double by_k = (in_time.speed_rad_s - soft.speed_rad_s) / 0.01;
        const double by_delay = (late.speed_rad_s - in_time.speed_rad_s) / 1e-5;
        assert_close(by_delay,
                     -by_k * 2.0 * paper.ankle_stiffness_N_m / r0s[i] * result.ankle_rate_m_s, 0.0,
                     0.005);
    }
}
END_TEST

START_TEST(the_derivative_is_that_of_the_late_stride)
{
    const struct gait_walker paper = gait_walker_of_paper();
    struct gait_point late;
    struct stride_result result;
    struct stride_derivative d;
    ck_assert_int_eq(late_gait_curve(&paper, 0.01, 0.15, 0.0, 1, &late, NULL), GAIT_CURVE_OK);
    const struct apex from = {late.apex[0], late.apex[1], late.apex[2]};
    ck_assert_int_eq(late_gait_differentiate(&walker, 0.01, &from, 0.15, &result, &d), STRIDE_OK);
    for (int column = 0; column < 4; column++) {
        double by[4] = {late.apex[0], late.apex[1], late.apex[2], 0.15}, low[3], high[3];
        by[column] -= 3e-5;
        next_of(by, by[3], 0.01, low);
        by[column] += 6e-5;
        next_of(by, by[3], 0.01, high);
        for (int i = 0; i < 3; i++) {
            assert_close(d.next[i][column], (high[i] - low[i]) / 6e-5, 2e-3, 1e-4);
        }
    }
}
END_TEST

START_TEST(the_laws_table_holds_late_gaits)
{
    const struct laws_weights weights = laws_weights_default();
    const struct gait_walker walkers[] = {gait_walker_of_paper(), ADULT};
    const double scales[] = {1.0, 0.93 * sqrt(100.0 / 9.80665 / (7000.0 * 0.93 / 65.0 / 9.80665))};
    static struct laws_table table;
    for (int w = 0; w < 2; w++) {
        double largest;
        ck_assert_int_eq(laws_table_make(&walkers[w], scales[w], 0.01, &weights, &table),
                         LAWS_TABLE_OK);
        (void)laws_table_gain(&table, 0.03 * scales[w], 0.042 * scales[w], scales[w], &largest);
        ck_assert_msg(largest < LAWS_TABLE_BORNE, "%g", largest);
    }
    ck_assert_int_eq(laws_table_make(&walkers[0], 1.0, 0.01, &weights, &table), LAWS_TABLE_OK);
    for (int i = 0; i < table.count; i++) {
        const struct laws_point *p = &table.point[i];
        const double x[3] = {-p->speed_rad_s, p->swing_angle_rad, p->swing_rate_rad_s};
        double next[3];
        next_of(x, p->r0_m, 0.01, next);
        for (int k = 0; k < 3; k++) {
            assert_close(next[k], x[k], 1e-9, 0.0);
        }
    }
}
END_TEST

START_TEST(what_is_not_served_is_refused)
{
    const struct gait_walker paper = gait_walker_of_paper();
    const struct laws_weights weights = laws_weights_default();
    struct gait_point point, same;
    static struct laws_table table;
    ck_assert_int_eq(late_gait_curve(&paper, 0.026, 0.05, 0.0, 1, &point, NULL),
                     GAIT_CURVE_BAD_WALKER);
    ck_assert_int_eq(late_gait_curve(&paper, 0.01, 0.001, 0.0, 1, &point, NULL),
                     GAIT_CURVE_BAD_GRID);
    ck_assert_int_eq(laws_table_make(&paper, 1.0, 0.026, &weights, &table), LAWS_TABLE_NO_CURVE);
    ck_assert_int_eq(late_gait_curve(&paper, 0.0, 0.05, 0.0, 1, &point, NULL), GAIT_CURVE_OK);
    ck_assert_int_eq(gait_curve(&paper, 0.05, 0.0, 1, &same, NULL), GAIT_CURVE_OK);
    assert_close(point.speed_rad_s, same.speed_rad_s, 0.0, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("late_gait");
    TCase *tests = tcase_create("late_gait");
    tcase_set_timeout(tests, 60.0);
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, late_gaits_repeat_and_are_slower);
    tcase_add_test(tests, a_delay_costs_the_work_of_the_ankle_s_way_meanwhile);
    tcase_add_test(tests, the_derivative_is_that_of_the_late_stride);
    tcase_add_test(tests, the_laws_table_holds_late_gaits);
    tcase_add_test(tests, what_is_not_served_is_refused);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
