#include "sim_host/study/paper/motion.h"

#include <string.h>

#include "model/double_support.h"
#include "model/integrator.h"
#include "model/single_support.h"

static void walk_single(const struct motion_stride *stride, int samples, double duration,
                        const char *phase, double *time_s, const double *start, motion_take *take,
                        void *context)
{
    const struct ode ode = {single_support_rates, &stride->problem->walker, SINGLE_SUPPORT_STATES};
    double s[4] = {start[0], start[1], start[2], start[3]};
    for (int i = 0; i <= samples; i++) {
        take(context, *time_s + duration * i / samples, stride->number, phase, s, 0.0);
        ode_step(&ode, ODE_RK8, duration / samples, s, s);
    }
    *time_s += duration;
}

static void walk_double(const struct motion_stride *stride, int samples, double *time_s,
                        motion_take *take, void *context)
{
    const struct stride_result *r = stride->result;
    const struct double_support phase = {.walker = &stride->problem->walker,
                                         .toe_distance_m = r->step_length_m,
                                         .spring_rest_m = stride->r0_m};
    const struct ode ode = {double_support_rates, &phase, DOUBLE_SUPPORT_STATES};
    double y[2] = {0.0, r->ankle_rate_m_s};
    for (int i = 0; i <= samples; i++) {
        const struct chain_angles a = double_support_angles(&phase, y[0]);
        const double s[4] = {a.trailing_rad, a.leading_rad, a.trailing_slope * y[1],
                             a.leading_slope * y[1]};
        take(context, *time_s + r->double_support_s * i / samples, stride->number, "double", s,
             y[0]);
        ode_step(&ode, ODE_RK8, r->double_support_s / samples, y, y);
    }
    *time_s += r->double_support_s;
}

void motion_walk(const struct motion_stride *stride, int samples, double *time_s, motion_take *take,
                 void *context)
{
    const struct stride_result *r = stride->result;
    const double apex[4] = {0.0, stride->apex[1], stride->apex[0], stride->apex[2]};
    walk_single(stride, samples, r->apex_to_strike_s, "before_strike", time_s, apex, take, context);
    walk_double(stride, samples, time_s, take, context);
    walk_single(stride, samples, r->lift_off_to_apex_s, "after_lift_off", time_s, r->lift_off, take,
                context);
}

void motion_plot(void *context, double time_s, int stride, const char *phase, const double s[4],
                 double ankle_m)
{
    /* Stride k runs from apex to apex: the leg that is A stands before lift-off in even ones. */
    const int is_swapped = (stride + (strcmp(phase, "after_lift_off") == 0)) % 2;
    (void)ankle_m;
    for (int leg = 0; leg < 2; leg++) {
        const int swings = leg != is_swapped;
        fprintf(context, "%c,%.9g,%.9g,%.9g\n", leg == 0 ? 'A' : 'B', time_s, s[swings],
                s[2 + swings]);
    }
}
