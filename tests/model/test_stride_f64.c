/* The return map in double: reference values of the re-derived model, accuracy, energy, and each fault. */
#include <math.h>

#include "model/double_support.h"
#include "model/stride.h"
#include "tests/model/walkers.h"

static const struct apex paper_apex = {-0.4069, -0.0596, 1.7568};

/* Iterates the map from a state near a stable gait until it settles. */
static struct apex settle(const struct walker *walker, double r0, struct apex x)
{
    const struct stride_settings settings = stride_settings_accurate(walker);
    for (int i = 0; i < 80; i++) {
        struct stride_result result;
        ck_assert_int_eq(stride(walker, &settings, &x, r0, &result), STRIDE_OK);
        x = result.next;
    }
    return x;
}

START_TEST(the_papers_gait_is_found)
{
    const struct walker walker = paper_walker();
    const struct apex x = settle(&walker, 0.05, paper_apex);
    assert_close(x.stance_rate_rad_s, -0.406960, 1e-6, 0.0);
    assert_close(x.swing_angle_rad, -0.059569, 1e-6, 0.0);
    assert_close(x.swing_rate_rad_s, 1.756768, 1e-6, 0.0);
}
END_TEST

static void mapped(const struct walker *walker, const double x[3], double next[3])
{
    const struct stride_settings settings = stride_settings_accurate(walker);
    const struct apex from = {x[0], x[1], x[2]};
    struct stride_result result;
    ck_assert_int_eq(stride(walker, &settings, &from, 0.05, &result), STRIDE_OK);
    next[0] = result.next.stance_rate_rad_s;
    next[1] = result.next.swing_angle_rad;
    next[2] = result.next.swing_rate_rad_s;
}

/* Central differences, extrapolated once (error of order h^4). */
static void jacobian(const struct walker *walker, const double x[3], double J[3][3])
{
    for (int j = 0; j < 3; j++) {
        double d[2][3];
        for (int k = 0; k < 2; k++) {
            const double h = k ? 2e-4 : 1e-4;
            double up[3], down[3], shifted[3] = {x[0], x[1], x[2]};
            shifted[j] = x[j] + h;
            mapped(walker, shifted, up);
            shifted[j] = x[j] - h;
            mapped(walker, shifted, down);
            for (int i = 0; i < 3; i++) {
                d[k][i] = (up[i] - down[i]) / (2.0 * h);
            }
        }
        for (int i = 0; i < 3; i++) {
            J[i][j] = (4.0 * d[0][i] - d[1][i]) / 3.0;
        }
    }
}

static double determinant(double J[3][3], double shift)
{
    const double a = J[0][0] - shift, b = J[1][1] - shift, c = J[2][2] - shift;
    return a * (b * c - J[1][2] * J[2][1]) - J[0][1] * (J[1][0] * c - J[1][2] * J[2][0]) +
           J[0][2] * (J[1][0] * J[2][1] - b * J[2][0]);
}

START_TEST(its_eigenvalues_are_the_papers)
{
    const struct walker walker = paper_walker();
    const struct apex a = settle(&walker, 0.05, paper_apex);
    const double x[3] = {a.stance_rate_rad_s, a.swing_angle_rad, a.swing_rate_rad_s};
    double J[3][3];
    jacobian(&walker, x, J);
    /* lambda^3 - trace lambda^2 + minors lambda - det with the roots -0.57144, -0.11020, 0 */
    const double trace = J[0][0] + J[1][1] + J[2][2];
    const double minors = J[0][0] * J[1][1] - J[0][1] * J[1][0] + J[0][0] * J[2][2] -
                          J[0][2] * J[2][0] + J[1][1] * J[2][2] - J[1][2] * J[2][1];
    const double root = sqrt(trace * trace / 4.0 - minors);
    assert_close(determinant(J, 0.0), 0.0, 1e-9, 0.0);
    assert_close(trace / 2.0 - root, -0.57144, 1e-5, 0.0);
    assert_close(trace / 2.0 + root, -0.11020, 1e-5, 0.0);
}
END_TEST

START_TEST(the_unstable_gait_is_a_fixed_point_too)
{
    const struct walker walker = paper_walker();
    const double x[3] = {-0.521217, -0.205854, 1.416979};
    double next[3];
    mapped(&walker, x, next);
    for (int i = 0; i < 3; i++) {
        assert_close(next[i], x[i], 1e-5, 0.0); /* six digits, times its expansion */
    }
}
END_TEST

START_TEST(accuracy_of_the_scaled_steps)
{
    const struct {
        struct walker walker;
        struct apex from;
        double r0;
    } cases[] = {{paper_walker(), paper_apex, 0.05},
                 {paper_walker(), {-0.955, -0.1195, 3.31}, 0.23},
                 {paper_walker(), {-1.15, -0.138, 3.6}, 0.285},
                 {make_walker(1.0, 0.2, 1.0, 100.0, 9.80665), paper_apex, 0.08},
                 {make_walker(65.0, 2.5, 0.93, 7000.0, 9.80665), paper_apex, 0.05}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct stride_settings settings = stride_settings_accurate(&cases[i].walker);
        struct stride_result got, want;
        ck_assert_int_eq(stride(&cases[i].walker, &settings, &cases[i].from, cases[i].r0, &got),
                         STRIDE_OK);
        settings = stride_settings_fixed(&cases[i].walker, 2e-4);
        ck_assert_int_eq(stride(&cases[i].walker, &settings, &cases[i].from, cases[i].r0, &want),
                         STRIDE_OK);
        assert_close(got.next.stance_rate_rad_s, want.next.stance_rate_rad_s, 1e-10, 0.0);
        assert_close(got.next.swing_angle_rad, want.next.swing_angle_rad, 1e-10, 0.0);
        assert_close(got.next.swing_rate_rad_s, want.next.swing_rate_rad_s, 1e-10, 0.0);
        assert_close(got.apex_to_strike_s, want.apex_to_strike_s, 1e-11, 0.0);
        assert_close(got.double_support_s, want.double_support_s, 1e-11, 0.0);
        assert_close(got.lift_off_to_apex_s, want.lift_off_to_apex_s, 1e-10, 0.0);
    }
}
END_TEST

START_TEST(energy_is_kept_between_the_collisions)
{
    const struct walker w = paper_walker();
    const double r0s[] = {0.03, 0.05, 0.2, 0.285};
    const struct apex starts[] = {{-0.31288, -0.046655, 1.38253},
                                  {-0.4069, -0.0596, 1.7568},
                                  {-0.8774, -0.11409, 3.1573},
                                  {-1.145, -0.138, 3.59}};
    const struct stride_settings settings = stride_settings_fixed(&w, 1e-3);
    for (int i = 0; i < 4; i++) {
        struct stride_result r;
        ck_assert_int_eq(stride(&w, &settings, &starts[i], r0s[i], &r), STRIDE_OK);
        ck_assert_int_eq(r.clamped, i == 3);
        const double apex[4] = {0.0, starts[i].swing_angle_rad, starts[i].stance_rate_rad_s,
                                starts[i].swing_rate_rad_s};
        const double next[4] = {0.0, r.next.swing_angle_rad, r.next.stance_rate_rad_s,
                                r.next.swing_rate_rad_s};
        const double before = single_support_energy_J(&w, apex);
        assert_close(single_support_energy_J(&w, r.strike), before, 0.0, 1e-10);
        /* What the spring holds after impact is all in the walker at lift-off, none lost in between. */
        const struct double_support phase = {
            .walker = &w, .toe_distance_m = r.step_length_m, .spring_rest_m = r0s[i]};
        const double landed[2] = {0.0, r.ankle_rate_m_s};
        const double after = double_support_energy_J(&phase, landed);
        assert_close(single_support_energy_J(&w, r.lift_off), after, 0.0, 1e-10);
        assert_close(single_support_energy_J(&w, next), after, 0.0, 1e-10);
        ck_assert(after - 0.5 * 100.0 * r0s[i] * r0s[i] < before); /* the collision loses */
    }
}
END_TEST

START_TEST(heel_strike_is_where_the_toe_meets_the_ground)
{
    const struct walker w = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&w);
    struct stride_result r;
    ck_assert_int_eq(stride(&w, &settings, &paper_apex, 0.05, &r), STRIDE_OK);
    assert_close(r.strike[0] + r.strike[1], 0.0, 1e-15, 0.0);
    const struct point toe = single_support_swing_toe(&w, r.strike);
    assert_close(toe.y_m, 0.0, 1e-15, 0.0);
    assert_close(toe.x_m, -r.step_length_m, 1e-14, 0.0);
    assert_close(r.inter_leg_rad, 2.0 * asin(r.step_length_m / 2.0), 1e-14, 0.0);
    /* From the stance leg's new foot the swing toe is at (d, 0), lifted off without a jump. */
    const struct double_support phase = {
        .walker = &w, .toe_distance_m = r.step_length_m, .spring_rest_m = 0.05};
    const struct point new_hip = single_support_hip(&w, r.lift_off);
    const struct chain_angles a = double_support_angles(&phase, 0.05);
    assert_close(new_hip.x_m, r.step_length_m + 1.05 * sin(a.trailing_rad), 1e-14, 0.0);
    assert_close(new_hip.y_m, 1.05 * cos(a.trailing_rad), 1e-14, 0.0);
}
END_TEST

static enum stride_fault fault_of(double ts_rate, double tn, double tn_rate, double r0)
{
    const struct walker w = paper_walker();
    const struct stride_settings settings = stride_settings_accurate(&w);
    const struct apex from = {ts_rate, tn, tn_rate};
    struct stride_result r;
    const enum stride_fault fault = stride(&w, &settings, &from, r0, &r);
    ck_assert_int_eq(r.fault, fault);
    return fault;
}

START_TEST(each_fault_has_its_cause)
{
    const double nan = (double)NAN;
    ck_assert_int_eq(fault_of(-0.407, -0.0596, 1.7568, 0.05), STRIDE_OK);
    ck_assert_int_eq(fault_of(nan, -0.0596, 1.7568, 0.05), STRIDE_BAD_INPUT);
    ck_assert_int_eq(fault_of(-0.407, (double)INFINITY, 1.7568, 0.05), STRIDE_BAD_INPUT);
    ck_assert_int_eq(fault_of(-0.407, -0.0596, 1.7568, nan), STRIDE_BAD_INPUT);
    ck_assert_int_eq(fault_of(-0.407, -0.0596, 1.7568, -0.01), STRIDE_BAD_INPUT);
    ck_assert_int_eq(fault_of(0.3, -0.0596, 1.7568, 0.05), STRIDE_WALKING_BACKWARDS);
    ck_assert_int_eq(fault_of(0.0, -0.0596, 1.7568, 0.05), STRIDE_WALKING_BACKWARDS);
    ck_assert_int_eq(fault_of(-1.39, 0.08, -1.6, 0.535), STRIDE_NO_ROOM_TO_EXTEND);
    ck_assert_int_eq(fault_of(-2.79, 0.80, 0.42, 0.052), STRIDE_NO_LIFT_OFF);
    ck_assert_int_eq(fault_of(-2.15, -0.78, -0.36, 0.377), STRIDE_FALLEN);
    ck_assert_int_eq(fault_of(-0.44, -1.42, 4.53, 0.479), STRIDE_INTER_LEG_ANGLE);
    ck_assert_int_eq(fault_of(-1.49, 0.89, -3.32, 0.463), STRIDE_LIFT_OFF_PAST_APEX);
    /* Enough push to lift off, not enough to come over the leading leg. */
    ck_assert_int_eq(fault_of(-0.70, -0.18, 2.19, 0.079), STRIDE_WALKING_BACKWARDS);
}
END_TEST

START_TEST(time_limits_and_lost_numbers_are_faults)
{
    const struct walker w = paper_walker();
    struct stride_settings settings = stride_settings_accurate(&w);
    struct stride_result r;
    settings.phase_limit_s = 0.3;
    ck_assert_int_eq(stride(&w, &settings, &paper_apex, 0.05, &r), STRIDE_NO_HEEL_STRIKE);
    settings.phase_limit_s = 10.0;
    ck_assert_int_eq(stride(&w, &settings, &paper_apex, 0.05, &r), STRIDE_OK);
    struct stride_result again = r;
    settings.phase_limit_s = 0.3;
    ck_assert_int_eq(stride_from_lift_off(&w, &settings, &again), STRIDE_NO_APEX);
    settings.phase_limit_s = 0.05;
    again = r;
    ck_assert_int_eq(stride_push_off(&w, &settings, 0.05, &again), STRIDE_NO_LIFT_OFF);
    settings = stride_settings_accurate(&w);
    settings.single_step_s = 0.0;
    ck_assert_int_eq(stride(&w, &settings, &paper_apex, 0.05, &r), STRIDE_BAD_INPUT);
    /* Rates beyond what the step resolves run out of the numbers, and are told. */
    const struct apex wild = {-1e200, 0.0, 1e200};
    settings = stride_settings_accurate(&w);
    ck_assert_int_eq(stride(&w, &settings, &wild, 0.05, &r), STRIDE_NOT_FINITE);
}
END_TEST

START_TEST(any_input_gives_a_fault_or_finite_numbers)
{
    unsigned long long seed = 8;
    int walked = 0;
    for (int i = 0; i < 20000; i++) {
        const struct walker w =
            make_walker(1.0, draw(&seed, 0.0, 0.3), 1.0, draw(&seed, 1.0, 2000.0), 9.80665);
        const struct stride_settings settings = stride_settings_accurate(&w);
        const struct apex from = {draw(&seed, -4.0, 0.5), draw(&seed, -3.0, 1.0),
                                  draw(&seed, -8.0, 8.0)};
        struct stride_result r;
        if (stride(&w, &settings, &from, draw(&seed, 0.0, 0.6), &r) == STRIDE_OK) {
            walked++;
            ck_assert(isfinite(r.next.stance_rate_rad_s) && r.next.stance_rate_rad_s < 0.0);
            ck_assert(isfinite(r.next.swing_angle_rad) && isfinite(r.next.swing_rate_rad_s));
            ck_assert(r.ankle_rate_m_s >= 0.0 && r.step_length_m > 0.0);
            ck_assert(r.lift_off_to_apex_s > 0.0 && r.apex_to_strike_s > 0.0);
        } else {
            ck_assert(r.fault > STRIDE_OK && r.fault < STRIDE_FAULT_COUNT);
        }
    }
    ck_assert_int_gt(walked, 500);
}
END_TEST

START_TEST(faults_have_names)
{
    for (int i = 0; i < STRIDE_FAULT_COUNT; i++) {
        ck_assert_str_ne(stride_fault_name((enum stride_fault)i), "unknown fault");
    }
    ck_assert_str_eq(stride_fault_name((enum stride_fault)77), "unknown fault");
    ck_assert_str_eq(stride_fault_name((enum stride_fault)(-1)), "unknown fault");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stride");
    TCase *tests = tcase_create("stride");
    suite_add_tcase(suite, tests);
    tcase_set_timeout(tests, 60.0);
    tcase_add_test(tests, the_papers_gait_is_found);
    tcase_add_test(tests, its_eigenvalues_are_the_papers);
    tcase_add_test(tests, the_unstable_gait_is_a_fixed_point_too);
    tcase_add_test(tests, accuracy_of_the_scaled_steps);
    tcase_add_test(tests, energy_is_kept_between_the_collisions);
    tcase_add_test(tests, heel_strike_is_where_the_toe_meets_the_ground);
    tcase_add_test(tests, each_fault_has_its_cause);
    tcase_add_test(tests, time_limits_and_lost_numbers_are_faults);
    tcase_add_test(tests, any_input_gives_a_fault_or_finite_numbers);
    tcase_add_test(tests, faults_have_names);
    return run_suite(suite);
}
