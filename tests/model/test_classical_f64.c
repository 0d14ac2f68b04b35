/* The integrator and the event code on two walkers of the literature, published long before this code:
 * Garcia et al. (1998), the simplest walker, and Goswami et al. (1996), the compass gait. Both go down
 * a slope, have no ankle spring, and lose energy by conservation of angular momentum at heel strike. */
#include <math.h>

#include "model/integrator.h"
#include "model/single_support.h"
#include "tests/model/walkers.h"

/* A walker with a slope: its motion, its strike, its collision. */
struct slope_walker {
    struct ode ode;
    struct ode_event
        strike;    /* rises through zero, seen when the stance leg is past the slope's normal */
    double normal; /* stance angle at which it stands at right angles to the slope */
    double step_s;
    void (*collide)(const struct slope_walker *walker, const double *before, double *after);
    const void *data;
};

/* One step from just after heel strike to just after the next; its time. */
static double step_once(const struct slope_walker *walker, const double *from, double *to)
{
    double state[4] = {from[0], from[1], from[2], from[3]}, next[4], end[4];
    double time = 0.0;
    for (int i = 0; i < 1000; i++) {
        ode_step(&walker->ode, ODE_RK8, walker->step_s, state, end);
        const double before = ode_event_value(&walker->strike, state);
        const double after = ode_event_value(&walker->strike, end);
        if (before < 0.0 && after >= 0.0 && end[0] < walker->normal - 0.05) {
            const struct ode_landing landing =
                ode_land(&walker->ode, ODE_RK8, &walker->strike, state, walker->step_s, end, next);
            walker->collide(walker, next, to);
            return time + landing.step_s;
        }
        time += walker->step_s;
        for (int k = 0; k < 4; k++) {
            state[k] = end[k];
        }
    }
    ck_abort_msg("no heel strike");
    return 0.0;
}

/* A reduced section: n coordinates that fix the state after impact. */
struct section {
    int n;
    void (*expand)(const struct slope_walker *walker, const double *reduced, double *state);
    int index[3]; /* which states the coordinates are */
};

static void reduced_step(const struct slope_walker *w, const struct section *s, const double *x,
                         double *y)
{
    double state[4], next[4];
    s->expand(w, x, state);
    (void)step_once(w, state, next);
    for (int i = 0; i < s->n; i++) {
        y[i] = next[s->index[i]];
    }
}

static void derivative(const struct slope_walker *w, const struct section *s, const double *x,
                       double J[3][3])
{
    for (int j = 0; j < s->n; j++) {
        double d[2][3];
        for (int k = 0; k < 2; k++) {
            const double h = k ? 2e-5 : 1e-5;
            double shifted[3], up[3], down[3];
            for (int i = 0; i < s->n; i++) {
                shifted[i] = x[i];
            }
            shifted[j] = x[j] + h;
            reduced_step(w, s, shifted, up);
            shifted[j] = x[j] - h;
            reduced_step(w, s, shifted, down);
            for (int i = 0; i < s->n; i++) {
                d[k][i] = (up[i] - down[i]) / (2.0 * h);
            }
        }
        for (int i = 0; i < s->n; i++) {
            J[i][j] = (4.0 * d[0][i] - d[1][i]) / 3.0;
        }
    }
}

/* Newton's method; Cramer's rule is enough for two or three unknowns. */
static void find_gait(const struct slope_walker *w, const struct section *s, double *x,
                      double J[3][3])
{
    for (int iteration = 0; iteration < 30; iteration++) {
        double y[3], a[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, b[3] = {0.0}, size = 0.0;
        reduced_step(w, s, x, y);
        derivative(w, s, x, J);
        for (int i = 0; i < s->n; i++) {
            b[i] = y[i] - x[i];
            size = fmax(size, fabs(b[i]));
            for (int j = 0; j < s->n; j++) {
                a[i][j] = (i == j) - J[i][j];
            }
        }
        if (size < 1e-13) {
            return;
        }
        double dx[3], det = 0.0;
        for (int c = -1; c < s->n; c++) {
            double m[3][3];
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) {
                    m[i][j] = j == c ? b[i] : a[i][j];
                }
            }
            const double value = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                                 m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                                 m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
            if (c < 0) {
                det = value;
            } else {
                dx[c] = value / det;
            }
        }
        for (int i = 0; i < s->n; i++) {
            x[i] += dx[i];
        }
    }
    ck_abort_msg("no gait found");
}

/* ---- Garcia: all mass at the hip, feet infinitely light. State theta, phi, theta', phi'. ---- */

static void garcia_rates(const void *context, const double *s, double *rates)
{
    const double slope = *(const double *)context;
    rates[0] = s[2];
    rates[1] = s[3];
    rates[2] = sin(s[0] - slope);
    rates[3] = rates[2] + s[2] * s[2] * sin(s[1]) - cos(s[0] - slope) * sin(s[1]);
}

static void garcia_collide(const struct slope_walker *walker, const double *s, double *after)
{
    (void)walker;
    const double c = cos(2.0 * s[0]);
    after[0] = -s[0];
    after[1] = -2.0 * s[0];
    after[2] = c * s[2];
    after[3] = c * (1.0 - c) * s[2];
}

static void garcia_expand(const struct slope_walker *walker, const double *x, double *state)
{
    (void)walker;
    state[0] = x[0];
    state[1] = 2.0 * x[0];
    state[2] = x[1];
    state[3] = (1.0 - cos(2.0 * x[0])) * x[1];
}

static const struct section garcia_section = {2, garcia_expand, {0, 2, 0}};

static struct slope_walker garcia(const double *slope)
{
    const struct slope_walker walker = {
        {garcia_rates, slope, 4}, {{-2.0, 1.0, 0.0, 0.0}, 0.0}, 0.0, 0.05, garcia_collide, slope};
    return walker;
}

START_TEST(garcias_simplest_walker)
{
    const double slope = 0.009;
    const struct slope_walker walker = garcia(&slope);
    double x[2] = {0.2, -0.2}, J[3][3], state[4], next[4];
    find_gait(&walker, &garcia_section, x, J);
    assert_close(x[0], 0.200310900544, 1e-11, 0.0);
    assert_close(x[1], -0.199832473005, 1e-11, 0.0);
    garcia_expand(&walker, x, state);
    assert_close(step_once(&walker, state, next), 3.882463753, 1e-9, 0.0);
    const double trace = J[0][0] + J[1][1], det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    assert_close(trace / 2.0, -0.19010, 1e-5, 0.0);
    assert_close(sqrt(det - trace * trace / 4.0), 0.55760, 1e-5, 0.0);
}
END_TEST

START_TEST(garcias_first_period_doubling)
{
    /* det(J + 1) = 0 by the secant method. */
    double slope[2] = {0.0150, 0.0151}, value[2];
    double x[2] = {0.2003, -0.1998}, J[3][3];
    for (double gentle = 0.009; gentle < 0.0149;
         gentle += 0.0005) { /* walk there from the known gait */
        const struct slope_walker walker = garcia(&gentle);
        find_gait(&walker, &garcia_section, x, J);
    }
    for (int i = 0; i < 7; i++) {
        const double at = slope[1];
        for (int k = (i == 0 ? 0 : 1); k < 2; k++) {
            const struct slope_walker walker = garcia(&slope[k]);
            find_gait(&walker, &garcia_section, x, J);
            value[k] = (J[0][0] + 1.0) * (J[1][1] + 1.0) - J[0][1] * J[1][0];
        }
        if (fabs(slope[1] - slope[0]) < 1e-11) {
            break;
        }
        slope[1] = at - value[1] * (at - slope[0]) / (value[1] - value[0]);
        slope[0] = at;
        value[0] = value[1];
    }
    assert_close(slope[1], 0.01508844, 1e-8, 0.0);
}
END_TEST

/* ---- Goswami: this project's single support, on a slope of 3 degrees, M = 2 m. ---- */

struct mass_point {
    double mass, x, y, vx, vy;
};

static double momentum(const struct mass_point *p, double x, double y)
{
    return p->mass * ((p->x - x) * p->vy - (p->y - y) * p->vx);
}

/* Hip, stance leg, swing leg; rates a of the stance and b of the swing leg; stance toe at the origin. */
static void points_of(const struct walker *w, double ts, double tn, double a, double b,
                      struct mass_point p[3])
{
    const double l = w->params.leg_length_m, m = w->params.leg_mass_kg, h = 0.5 * l;
    const struct mass_point hip = {w->params.hip_mass_kg, l * sin(ts), l * cos(ts), l * cos(ts) * a,
                                   -l * sin(ts) * a};
    const struct mass_point stance = {m, 0.5 * hip.x, 0.5 * hip.y, 0.5 * hip.vx, 0.5 * hip.vy};
    const struct mass_point swing = {m, hip.x - h * sin(tn), hip.y - h * cos(tn),
                                     hip.vx - h * cos(tn) * b, hip.vy + h * sin(tn) * b};
    p[0] = hip;
    p[1] = stance;
    p[2] = swing;
}

static void goswami_collide(const struct slope_walker *walker, const double *s, double *after)
{
    const struct walker *w = (const struct walker *)walker->data;
    const double l = w->params.leg_length_m;
    struct mass_point before[3], unit[3];
    points_of(w, s[0], s[1], s[2], s[3], before);
    const double toe_x = l * (sin(s[0]) - sin(s[1])), toe_y = l * (cos(s[0]) - cos(s[1]));
    /* Kept: the whole walker's momentum about the new toe, the old stance leg's about the hip. */
    const double whole = momentum(&before[0], toe_x, toe_y) + momentum(&before[1], toe_x, toe_y) +
                         momentum(&before[2], toe_x, toe_y);
    const double trailing = momentum(&before[1], before[0].x, before[0].y);
    double a[2][2];
    for (int k = 0; k < 2; k++) {
        points_of(w, s[1], s[0], k == 0 ? 1.0 : 0.0, k == 0 ? 0.0 : 1.0, unit);
        a[0][k] = momentum(&unit[0], 0, 0) + momentum(&unit[1], 0, 0) + momentum(&unit[2], 0, 0);
        a[1][k] = momentum(&unit[2], unit[0].x, unit[0].y);
    }
    const double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    after[0] = s[1];
    after[1] = s[0];
    after[2] = (whole * a[1][1] - trailing * a[0][1]) / det;
    after[3] = (a[0][0] * trailing - a[1][0] * whole) / det;
}

static void goswami_expand(const struct slope_walker *walker, const double *x, double *state)
{
    state[0] = x[0];
    state[1] = 2.0 * walker->normal - x[0];
    state[2] = x[1];
    state[3] = x[2];
}

START_TEST(goswamis_compass_gait)
{
    /* m = 5 kg, hip 10 kg, legs of 1 m with the mass half way, 3 degrees, as in the paper of 1996. */
    const struct walker w = make_walker(10.0, 5.0, 1.0, 100.0, 9.8);
    const double slope = 3.0 * M_PI / 180.0;
    const struct slope_walker walker = {{single_support_rates, &w, 4},
                                        {{-1.0, -1.0, 0.0, 0.0}, -2.0 * slope},
                                        -slope,
                                        0.03,
                                        goswami_collide,
                                        &w};
    const struct section section = {3, goswami_expand, {0, 2, 3}};
    double state[4] = {0.22, -0.22 - 2.0 * slope, -1.1, -0.4}, next[4];
    for (int i = 0; i < 60; i++) { /* it is stable: it finds its gait by walking */
        (void)step_once(&walker, state, next);
        for (int k = 0; k < 4; k++) {
            state[k] = next[k];
        }
    }
    double x[3] = {state[0], state[2], state[3]}, J[3][3];
    find_gait(&walker, &section, x, J);
    /* The characteristic polynomial at the known magnitudes: a pair of 0.57995 and a real 0.13157. */
    const double det = J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) -
                       J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
                       J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
    const double trace = J[0][0] + J[1][1] + J[2][2];
    const double minors = J[0][0] * J[1][1] - J[0][1] * J[1][0] + J[0][0] * J[2][2] -
                          J[0][2] * J[2][0] + J[1][1] * J[2][2] - J[1][2] * J[2][1];
    double real_root = det > 0.0 ? 0.13 : -0.13;
    for (int i = 0; i < 50; i++) {
        const double v = ((real_root - trace) * real_root + minors) * real_root - det;
        real_root -= v / ((3.0 * real_root - 2.0 * trace) * real_root + minors);
    }
    assert_close(fabs(real_root), 0.13157, 1e-5, 0.0);
    assert_close(sqrt(det / real_root), 0.57995, 1e-5, 0.0);
    const double half = (trace - real_root) / 2.0;
    ck_assert(half * half < det / real_root); /* a complex pair: both of this magnitude */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("classical");
    TCase *tests = tcase_create("classical");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, garcias_simplest_walker);
    tcase_add_test(tests, garcias_first_period_doubling);
    tcase_add_test(tests, goswamis_compass_gait);
    return run_suite(suite);
}
