/* The collision against its definition, q+ = (I - M^-1 J^T (J M^-1 J^T)^-1 J) q-, built here from the
 * positions of the three masses; and its two short forms against each other. */
#include <math.h>

#include "model/collision.h"
#include "tests/model/walkers.h"

/* Derivatives of a point's x and y by (ts, tn, r). */
struct lever {
    double x[3], y[3];
};

static struct lever hip_lever(double ts, double l1)
{
    const struct lever a = {{l1 * cos(ts), 0.0, sin(ts)}, {-l1 * sin(ts), 0.0, cos(ts)}};
    return a;
}

/* The stance leg's mass is at distance r + l/2 from the toe. */
static struct lever stance_mass_lever(double ts, double l, double r)
{
    return hip_lever(ts, r + 0.5 * l);
}

/* A point `below` metres down the swing leg. */
static struct lever swing_lever(double ts, double tn, double l1, double below)
{
    struct lever a = hip_lever(ts, l1);
    a.x[1] = -below * cos(tn);
    a.y[1] = below * sin(tn);
    return a;
}

static void add_mass(double matrix[3][3], double mass, const struct lever *lever)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            matrix[i][j] += mass * (lever->x[i] * lever->x[j] + lever->y[i] * lever->y[j]);
        }
    }
}

/* Solves [Mc -J^T; J 0] [q+; F] = [Mc q-; 0], five equations, with row exchange. */
static void collide(const struct walker *w, double ts, double tn, double r, const double *before,
                    double *after)
{
    const double l = w->params.leg_length_m, m = w->params.leg_mass_kg;
    double mass[3][3] = {{0.0}};
    const struct lever hip = hip_lever(ts, l + r), stance = stance_mass_lever(ts, l, r);
    const struct lever swing = swing_lever(ts, tn, l + r, 0.5 * l);
    const struct lever toe = swing_lever(ts, tn, l + r, l);
    add_mass(mass, w->params.hip_mass_kg, &hip);
    add_mass(mass, m, &stance);
    add_mass(mass, m, &swing);
    double a[5][6] = {{0.0}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            a[i][j] = mass[i][j];
            a[i][5] += mass[i][j] * before[j];
        }
        a[i][3] = -toe.x[i];
        a[i][4] = -toe.y[i];
        a[3][i] = toe.x[i];
        a[4][i] = toe.y[i];
    }
    for (int c = 0; c < 5; c++) {
        int p = c;
        for (int i = c; i < 5; i++) {
            p = fabs(a[i][c]) > fabs(a[p][c]) ? i : p;
        }
        for (int k = 0; k < 6; k++) {
            const double t = a[c][k];
            a[c][k] = a[p][k];
            a[p][k] = t;
        }
        for (int i = 0; i < 5; i++) {
            const double q = a[i][c] / a[c][c];
            for (int k = c; k < 6 && i != c; k++) {
                a[i][k] -= q * a[c][k];
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        after[i] = a[i][5] / a[i][i];
    }
}

START_TEST(the_map_is_its_definition)
{
    const struct walker walkers[2] = {paper_walker(), heavy_legged_walker()};
    unsigned long long seed = 3;
    for (int i = 0; i < 400; i++) {
        const struct walker *w = &walkers[i % 2];
        const double ts = draw(&seed, -1.2, -0.1), tn = draw(&seed, 0.1, 1.2);
        const double r = draw(&seed, 0.0, 0.4) * w->params.leg_length_m;
        const double before[3] = {draw(&seed, -3, 1), draw(&seed, -4, 4), draw(&seed, -1, 1)};
        double want[3];
        collide(w, ts, tn, r, before, want);
        const struct collision_rates in = {before[0], before[1], before[2]};
        const struct collision_rates got = collision_apply(w, ts - tn, r, in);
        assert_close(got.stance_rad_s, want[0], 2e-12, 1e-12);
        assert_close(got.swing_rad_s, want[1], 2e-12, 1e-12);
        assert_close(got.ankle_m_s, want[2], 2e-12, 1e-12);
    }
}
END_TEST

START_TEST(the_new_toe_is_at_rest)
{
    const struct walker walkers[2] = {paper_walker(), heavy_legged_walker()};
    unsigned long long seed = 4;
    for (int i = 0; i < 400; i++) {
        const struct walker *w = &walkers[i % 2];
        const double a = draw(&seed, 0.1, 0.9), r = i % 3 ? 0.0 : draw(&seed, 0.0, 0.3);
        const struct collision_rates in = {draw(&seed, -3, 0), draw(&seed, -3, 3), 0.0};
        const struct collision_rates out = collision_apply(w, -2.0 * a, r, in);
        const struct lever toe =
            swing_lever(-a, a, w->params.leg_length_m + r, w->params.leg_length_m);
        const double rates[3] = {out.stance_rad_s, out.swing_rad_s, out.ankle_m_s};
        double x = 0.0, y = 0.0;
        for (int k = 0; k < 3; k++) {
            x += toe.x[k] * rates[k];
            y += toe.y[k] * rates[k];
        }
        assert_close(x, 0.0, 1e-13, 0.0);
        assert_close(y, 0.0, 1e-13, 0.0);
    }
}
END_TEST

START_TEST(the_special_case_is_the_general_map)
{
    const struct walker walkers[2] = {paper_walker(), heavy_legged_walker()};
    unsigned long long seed = 5;
    for (int i = 0; i < 400; i++) {
        const struct walker *w = &walkers[i % 2];
        const double d = draw(&seed, -2.8, 2.8);
        const struct collision_rates in = {draw(&seed, -3, 3), draw(&seed, -3, 3), 0.0};
        const double got = collision_ankle_rate_m_s(w, d, in.stance_rad_s, in.swing_rad_s);
        assert_close(got, collision_apply(w, d, 0.0, in).ankle_m_s, 1e-13, 1e-13);
    }
}
END_TEST

START_TEST(a_forward_step_extends_the_ankle)
{
    const struct walker w = paper_walker();
    for (double a = 0.05; a < 0.7; a += 0.05) {
        ck_assert(collision_ankle_rate_m_s(&w, -2.0 * a, -1.0, 0.0) > 0.0);
    }
    /* Beyond a right angle between the legs the formula turns negative: there the clamp acts. */
    ck_assert(collision_ankle_rate_m_s(&w, -1.8, -1.0, 0.0) < 0.0);
}
END_TEST

START_TEST(the_clamp_stops_backward_motion_only)
{
    int clamped = 7;
    ck_assert(collision_clamp_m_s(0.3, &clamped) == 0.3 && clamped == 0);
    ck_assert(collision_clamp_m_s(-0.3, &clamped) == 0.0 && clamped == 1);
    ck_assert(collision_clamp_m_s(0.0, &clamped) == 0.0 && clamped == 0);
    ck_assert(isnan(collision_clamp_m_s((double)NAN, NULL)));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("collision");
    TCase *tests = tcase_create("collision");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, the_map_is_its_definition);
    tcase_add_test(tests, the_new_toe_is_at_rest);
    tcase_add_test(tests, the_special_case_is_the_general_map);
    tcase_add_test(tests, a_forward_step_extends_the_ankle);
    tcase_add_test(tests, the_clamp_stops_backward_motion_only);
    return run_suite(suite);
}
