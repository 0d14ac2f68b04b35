/* Double support against the paper's closed chain (eq. 14 and the arc cosines), differentiated numerically. */
#include <math.h>

#include "model/double_support.h"
#include "model/integrator.h"
#include "tests/model/walkers.h"

struct places {
    double x[3], y[3]; /* hip, trailing leg's mass, leading leg's mass */
};

static struct places places(const struct double_support *p, double r)
{
    const double l = p->walker->params.leg_length_m, d = p->toe_distance_m, l1 = l + r;
    const double ts = -M_PI_2 + acos((d * d - l * l + l1 * l1) / (2.0 * d * l1));
    const double tn = M_PI_2 - acos((d * d + l * l - l1 * l1) / (2.0 * d * l));
    const double hx = l1 * sin(ts), hy = l1 * cos(ts);
    const struct places a = {{hx, (r + 0.5 * l) * sin(ts), hx - 0.5 * l * sin(tn)},
                             {hy, (r + 0.5 * l) * cos(ts), hy - 0.5 * l * cos(tn)}};
    return a;
}

static double mu_by_differences(const struct double_support *p, double r)
{
    const double h = 1e-4, mass[3] = {p->walker->params.hip_mass_kg, p->walker->params.leg_mass_kg,
                                      p->walker->params.leg_mass_kg};
    const struct places a = places(p, r - 2 * h), b = places(p, r - h), c = places(p, r + h),
                        e = places(p, r + 2 * h);
    double mu = 0.0;
    for (int i = 0; i < 3; i++) {
        const double x = (a.x[i] - 8 * b.x[i] + 8 * c.x[i] - e.x[i]) / (12 * h);
        const double y = (a.y[i] - 8 * b.y[i] + 8 * c.y[i] - e.y[i]) / (12 * h);
        mu += mass[i] * (x * x + y * y);
    }
    return mu;
}

static struct double_support phase_of(const struct walker *w, double d, double r0)
{
    const struct double_support phase = {.walker = w, .toe_distance_m = d, .spring_rest_m = r0};
    return phase;
}

START_TEST(mass_and_potential_are_those_of_the_chain)
{
    const struct walker walkers[2] = {paper_walker(), heavy_legged_walker()};
    unsigned long long seed = 6;
    for (int i = 0; i < 200; i++) {
        const struct walker *w = &walkers[i % 2];
        const double l = w->params.leg_length_m, h = 1e-4;
        const struct double_support p = phase_of(w, draw(&seed, 0.4, 1.6) * l, 0.3 * l);
        const double r = draw(&seed, 0.01, 0.3) * l;
        ck_assert(double_support_is_possible(&p, r));
        const struct chain c = double_support_chain(&p, r);
        const struct places a = places(&p, r);
        const double g = w->params.gravity_m_s2;
        const double V =
            g * (w->params.hip_mass_kg * a.y[0] + w->params.leg_mass_kg * (a.y[1] + a.y[2]));
        assert_close(c.potential_J, V, 1e-12, 1e-13);
        assert_close(c.effective_mass_kg, mu_by_differences(&p, r), 0.0, 1e-8);
        const struct chain up = double_support_chain(&p, r + h);
        const struct chain down = double_support_chain(&p, r - h);
        const double mu_slope = (up.effective_mass_kg - down.effective_mass_kg) / (2 * h);
        const double V_slope = (up.potential_J - down.potential_J) / (2 * h);
        assert_close(c.mass_slope_kg_m, mu_slope, 1e-5, 2e-4);
        assert_close(c.potential_slope_N, V_slope, 1e-3, 2e-5);
    }
}
END_TEST

START_TEST(angles_are_the_papers_arc_cosines_and_their_slopes)
{
    const struct walker w = heavy_legged_walker();
    const double h = 1e-5, l = 0.83;
    for (double d = 0.3; d < 1.4; d += 0.1) {
        const struct double_support p = phase_of(&w, d, 0.2);
        for (double r = 0.01; r < 0.2; r += 0.03) {
            const struct chain_angles a = double_support_angles(&p, r);
            const double l1 = l + r;
            const double ts = -M_PI_2 + acos((d * d - l * l + l1 * l1) / (2.0 * d * l1));
            const double tn = M_PI_2 - acos((d * d + l * l - l1 * l1) / (2.0 * d * l));
            assert_close(a.trailing_rad, ts, 1e-14, 0.0);
            assert_close(a.leading_rad, tn, 1e-14, 0.0);
            const struct chain_angles up = double_support_angles(&p, r + h);
            const struct chain_angles down = double_support_angles(&p, r - h);
            const double ts_slope = (up.trailing_rad - down.trailing_rad) / (2 * h);
            const double tn_slope = (up.leading_rad - down.leading_rad) / (2 * h);
            assert_close(a.trailing_slope, ts_slope, 1e-6, 1e-6);
            assert_close(a.leading_slope, tn_slope, 1e-6, 1e-6);
        }
    }
}
END_TEST

START_TEST(energy_spring_included_is_conserved)
{
    const struct walker w = paper_walker();
    const struct double_support p = phase_of(&w, 0.54, 0.05);
    const struct ode ode = {double_support_rates, &p, DOUBLE_SUPPORT_STATES};
    double state[2] = {0.0, 0.3};
    const double start = double_support_energy_J(&p, state);
    for (int i = 0; i < 126; i++) {
        ode_step(&ode, ODE_RK4, 1e-3, state, state);
        assert_close(double_support_energy_J(&p, state), start, 0.0, 1e-10);
    }
    ck_assert(state[0] > 0.02 && state[0] < 0.05);
}
END_TEST

START_TEST(impossible_triangles_are_told)
{
    const struct walker w = paper_walker();
    struct double_support p = phase_of(&w, 0.5, 0.3);
    ck_assert(double_support_is_possible(&p, 0.0));
    ck_assert(double_support_is_possible(&p, 0.499));
    ck_assert(!double_support_is_possible(&p, 0.5));
    ck_assert(!double_support_is_possible(&p, -0.51));
    ck_assert(!double_support_is_possible(&p, (double)NAN));
    p.toe_distance_m = 2.0;
    ck_assert(!double_support_is_possible(&p, 0.0));
    p.toe_distance_m = 0.0;
    ck_assert(!double_support_is_possible(&p, 0.0));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("double_support");
    TCase *tests = tcase_create("double_support");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, mass_and_potential_are_those_of_the_chain);
    tcase_add_test(tests, angles_are_the_papers_arc_cosines_and_their_slopes);
    tcase_add_test(tests, energy_spring_included_is_conserved);
    tcase_add_test(tests, impossible_triangles_are_told);
    return run_suite(suite);
}
