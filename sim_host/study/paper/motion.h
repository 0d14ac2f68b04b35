/* The motion of the legs within a stride, from its events. */
#ifndef SIM_HOST_STUDY_PAPER_MOTION_H
#define SIM_HOST_STUDY_PAPER_MOTION_H

#include <stdio.h>

#include "sim_host/gait/orbit.h"

/* A stride that was walked: its apex, its push-off, and what the return map told of it. */
struct motion_stride {
    const struct problem *problem;
    const double *apex; /* stance rate, swing angle, swing rate */
    double r0_m;
    const struct stride_result *result;
    int number;
};

/* Takes a moment: s is stance angle, swing angle, stance rate, swing rate (rad, rad/s). */
typedef void motion_take(void *context, double time_s, int stride, const char *phase,
                         const double s[4], double ankle_m);

/* samples + 1 moments in each of the three phases "before_strike", "double" and "after_lift_off". *time_s is where
 * it begins, and receives where it ends. Cost: 3 samples of the integrator. */
void motion_walk(const struct motion_stride *stride, int samples, double *time_s, motion_take *take,
                 void *context);

/* The line of names of the table that motion_plot() writes. */
#define MOTION_PLOT_COLUMNS "leg,time_s,angle_rad,rate_rad_s\n"

/* For motion_take, context a FILE: a row for each leg. The leg that stands first is A. */
motion_take motion_plot;

#endif
