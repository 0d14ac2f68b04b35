/* Single support against the two coupled equations as they are written down, and energy. */
#include <math.h>

#include "model/integrator.h"
#include "model/single_support.h"
#include "tests/model/walkers.h"

/* Residuals of A ts'' - b cos D tn'' = ... and -b cos D ts'' + C tn'' = ..., with libm. */
static void residuals(const struct walker *w, const double *s, const double *acceleration,
                      double *first, double *second)
{
    const double M = w->params.hip_mass_kg, m = w->params.leg_mass_kg, l = w->params.leg_length_m;
    const double g = w->params.gravity_m_s2, d = s[0] - s[1];
    const double A = (M + 1.25 * m) * l * l, b = 0.5 * m * l * l, C = 0.25 * m * l * l;
    *first = A * acceleration[0] - b * cos(d) * acceleration[1] - b * sin(d) * s[3] * s[3] -
             g * l * (M + 1.5 * m) * sin(s[0]);
    *second = -b * cos(d) * acceleration[0] + C * acceleration[1] + b * sin(d) * s[2] * s[2] +
              0.5 * g * m * l * sin(s[1]);
}

START_TEST(accelerations_solve_the_coupled_equations)
{
    const struct walker walkers[2] = {paper_walker(), heavy_legged_walker()};
    unsigned long long seed = 1;
    for (int i = 0; i < 1000; i++) {
        const struct walker *w = &walkers[i % 2];
        const double state[4] = {draw(&seed, -1.5, 1.5), draw(&seed, -3.0, 3.0),
                                 draw(&seed, -4.0, 4.0), draw(&seed, -8.0, 8.0)};
        double rates[4], first, second;
        single_support_rates(w, state, rates);
        ck_assert(rates[0] == state[2] && rates[1] == state[3]);
        residuals(w, state, rates + 2, &first, &second);
        const double scale = w->params.hip_mass_kg * w->params.gravity_m_s2;
        assert_close(first / scale, 0.0, 1e-14 * 64.0, 0.0);
        assert_close(second / scale, 0.0, 1e-14 * 64.0, 0.0);
    }
}
END_TEST

START_TEST(energy_is_conserved_at_one_millisecond)
{
    const struct walker walkers[2] = {paper_walker(), heavy_legged_walker()};
    for (int k = 0; k < 2; k++) {
        const struct ode ode = {single_support_rates, &walkers[k], SINGLE_SUPPORT_STATES};
        double state[4] = {0.27, -0.27, -1.1, 0.3};
        const double start = single_support_energy_J(&walkers[k], state);
        for (int i = 0; i < 800; i++) {
            ode_step(&ode, ODE_RK4, 1e-3, state, state);
            assert_close(single_support_energy_J(&walkers[k], state), start, 0.0, 1e-10);
        }
        ck_assert(state[0] < -0.1); /* it did walk over the stance foot */
    }
}
END_TEST

/* Energy from the positions of the three masses, by differences in time. */
static double energy_of_points(const struct walker *w, const double *s)
{
    const double M = w->params.hip_mass_kg, m = w->params.leg_mass_kg, l = w->params.leg_length_m;
    const double vx = l * cos(s[0]) * s[2], vy = -l * sin(s[0]) * s[2];
    const double sx = 0.5 * vx, sy = 0.5 * vy;
    const double nx = vx - 0.5 * l * cos(s[1]) * s[3], ny = vy + 0.5 * l * sin(s[1]) * s[3];
    const double kinetic =
        0.5 * M * (vx * vx + vy * vy) + 0.5 * m * (sx * sx + sy * sy + nx * nx + ny * ny);
    const double height =
        M * l * cos(s[0]) + m * 0.5 * l * cos(s[0]) + m * (l * cos(s[0]) - 0.5 * l * cos(s[1]));
    return kinetic + w->params.gravity_m_s2 * height;
}

START_TEST(energy_is_that_of_the_point_masses)
{
    const struct walker w = heavy_legged_walker();
    unsigned long long seed = 2;
    for (int i = 0; i < 200; i++) {
        const double state[4] = {draw(&seed, -1.5, 1.5), draw(&seed, -3.0, 3.0),
                                 draw(&seed, -4.0, 4.0), draw(&seed, -8.0, 8.0)};
        assert_close(single_support_energy_J(&w, state), energy_of_points(&w, state), 1e-11, 1e-13);
    }
}
END_TEST

START_TEST(toe_speed_is_the_change_of_the_toes_place)
{
    const struct walker w = heavy_legged_walker();
    const double h = 1e-5, state[4] = {0.2, -0.3, -1.3, 2.0};
    const double before[4] = {0.2 + 1.3 * h, -0.3 - 2.0 * h, 0, 0};
    const double after[4] = {0.2 - 1.3 * h, -0.3 + 2.0 * h, 0, 0};
    const struct point a = single_support_swing_toe(&w, before);
    const struct point b = single_support_swing_toe(&w, after);
    const struct point v = single_support_swing_toe_speed(&w, state);
    assert_close(v.x_m, (b.x_m - a.x_m) / (2.0 * h), 1e-8, 0.0);
    assert_close(v.y_m, (b.y_m - a.y_m) / (2.0 * h), 1e-8, 0.0);
    const struct point hip = single_support_hip(&w, state);
    assert_close(hip.x_m, 0.83 * sin(0.2), 1e-15, 0.0);
    assert_close(hip.y_m, 0.83 * cos(0.2), 1e-15, 0.0);
}
END_TEST

START_TEST(the_massless_leg_is_a_limit_not_a_division_by_zero)
{
    const struct walker light = make_walker(1.0, 1e-12, 1.0, 100.0, 9.80665);
    const struct walker none = make_walker(1.0, 0.0, 1.0, 100.0, 9.80665);
    const double state[4] = {0.1, -0.2, -1.0, 1.5};
    double a[4], b[4];
    single_support_rates(&light, state, a);
    single_support_rates(&none, state, b);
    for (int i = 0; i < 4; i++) {
        assert_close(b[i], a[i], 1e-10, 0.0);
    }
    assert_close(b[2], 9.80665 * sin(0.1), 1e-14, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("single_support");
    TCase *tests = tcase_create("single_support");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, accelerations_solve_the_coupled_equations);
    tcase_add_test(tests, energy_is_conserved_at_one_millisecond);
    tcase_add_test(tests, energy_is_that_of_the_point_masses);
    tcase_add_test(tests, toe_speed_is_the_change_of_the_toes_place);
    tcase_add_test(tests, the_massless_leg_is_a_limit_not_a_division_by_zero);
    return run_suite(suite);
}
