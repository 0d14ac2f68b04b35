/* Time against error of the stride by the GNU Scientific Library: Prince-Dormand 8(9), step control, and,
 * as GSL has no events, Newton on steps taken again from before the event.
 * Usage: afo-bench-gsl REFERENCE.csv [SECONDS]. Built without GSL it says so and stops. */
#define REAL_IS_DOUBLE 1 /* the equations in double */
#include <stdlib.h>
#include <string.h>

#include "sim_host/batch/benchmark_phases.h"

#ifdef HAVE_PEER

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#define TIME_LIMIT_S 20.0
#define FIRST_STEP_S 0.01
#define LANDINGS 8

struct gsl {
    gsl_odeiv2_system system[2]; /* single support, double support */
    gsl_odeiv2_step *step[2];
    gsl_odeiv2_evolve *evolve[2];
    struct walker walker;
    struct double_support support;
};

static int single_rates(double t, const double y[], double dy[], void *walker)
{
    (void)t;
    single_support_rates(walker, y, dy);
    return GSL_SUCCESS;
}

static int double_rates(double t, const double y[], double dy[], void *support)
{
    (void)t;
    double_support_rates(support, y, dy);
    return GSL_SUCCESS;
}

/* From before the event (at `state`) to it, within a step. */
static int land(struct gsl *gsl, int which, enum benchmark_phase phase, double step, double *state)
{
    gsl_odeiv2_system *system = &gsl->system[which];
    double before[4], after[4] = {0.0}, slope[4] = {0.0}, error[4];
    memcpy(before, state, sizeof(double) * system->dimension);
    const double rest = phase == PHASE_PUSH_OFF ? gsl->support.spring_rest_m : 0.0;
    double t = 0.5 * step;
    for (int i = 0; i < LANDINGS; i++) {
        memcpy(after, before, sizeof(double) * system->dimension);
        gsl_odeiv2_step_reset(gsl->step[which]);
        if (gsl_odeiv2_step_apply(gsl->step[which], 0.0, t, after, error, NULL, NULL, system) !=
            GSL_SUCCESS) {
            return 0;
        }
        system->function(0.0, after, slope, system->params);
        const double rate = benchmark_event(phase, &gsl->support, slope) - rest;
        const double change = benchmark_event(phase, &gsl->support, after) / rate;
        t -= change;
        if (real_abs(change) < 1e-14) {
            break;
        }
    }
    memcpy(state, after, sizeof(double) * system->dimension);
    return 1;
}

static int run_phase(void *solver, enum benchmark_phase phase, double tolerance, double *state)
{
    struct gsl *gsl = solver;
    const int which = phase == PHASE_PUSH_OFF;
    const size_t bytes = sizeof(double) * gsl->system[which].dimension;
    gsl_odeiv2_control *control = gsl_odeiv2_control_y_new(tolerance, tolerance);
    double t = 0.0, h = FIRST_STEP_S;
    int done = 0;
    gsl_odeiv2_step_reset(gsl->step[which]);
    gsl_odeiv2_evolve_reset(gsl->evolve[which]);
    while (!done && t < TIME_LIMIT_S) {
        double before[4];
        const double from = t;
        memcpy(before, state, bytes);
        if (gsl_odeiv2_evolve_apply(gsl->evolve[which], control, gsl->step[which],
                                    &gsl->system[which], &t, TIME_LIMIT_S, &h,
                                    state) != GSL_SUCCESS) {
            break;
        }
        if (benchmark_event(phase, &gsl->support, before) > 0.0 &&
            benchmark_event(phase, &gsl->support, state) <= 0.0) {
            memcpy(state, before, bytes);
            done = land(gsl, which, phase, t - from, state);
        }
    }
    gsl_odeiv2_control_free(control);
    return done;
}

int main(int argc, char **argv)
{
    static struct benchmark_rows rows;
    static struct gsl gsl;
    if (!benchmark_open(&rows, argc, argv)) {
        return EXIT_FAILURE;
    }
    gsl.system[0] = (gsl_odeiv2_system){single_rates, NULL, 4, &gsl.walker};
    gsl.system[1] = (gsl_odeiv2_system){double_rates, NULL, 2, &gsl.support};
    for (int i = 0; i < 2; i++) {
        gsl.step[i] = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, gsl.system[i].dimension);
        gsl.evolve[i] = gsl_odeiv2_evolve_alloc(gsl.system[i].dimension);
    }
    struct benchmark_solver solver = {run_phase, &gsl, &gsl.walker, &gsl.support};
    double tolerance = 1e-4;
    for (int rung = 0; rung < 22; rung++) {
        benchmark_measure("GSL rk8pd", &rows, benchmark_solve, &solver, tolerance, 1);
        tolerance /= 3.1622776601683795;
    }
    for (int i = 0; i < 2; i++) {
        gsl_odeiv2_evolve_free(gsl.evolve[i]);
        gsl_odeiv2_step_free(gsl.step[i]);
    }
    return EXIT_SUCCESS;
}

#else

int main(void)
{
    fputs("built without the GNU Scientific Library: install libgsl-dev and build again\n", stderr);
    return EXIT_FAILURE;
}

#endif
