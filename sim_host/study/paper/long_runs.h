/* Long walks beside the period-1 gait at many push-offs: where they end up, with which period, how chaotic.
 *
 * On the batch engine, all runs of a group side by side; a run's result depends on that run alone. */
#ifndef SIM_HOST_STUDY_PAPER_LONG_RUNS_H
#define SIM_HOST_STUDY_PAPER_LONG_RUNS_H

#include <stddef.h>

#include "sim_host/gait/orbit.h"

#define LONG_RUN_PERIODS 64 /* longest period told */
#define LONG_RUN_SAME \
    1e-6 /* states nearer than this (rad, rad/s) are one state of a periodic walk */

struct long_run_sample {
    double x[3], inter_leg_rad; /* an apex, and the legs' opening at the strike that follows */
};

struct long_run {
    double r0, gait[3];              /* in: the period-1 gait it starts beside */
    int has_gait;                    /* in; without one nothing is walked */
    struct long_run_sample *samples; /* room for `keep` */
    double last[3];                  /* where the walk is after them */
    enum stride_fault fault;
    int period;      /* 0: none up to LONG_RUN_PERIODS; -1: fell */
    double lyapunov; /* natural logarithm per stride; NO_NUMBER where there is none */
};

struct long_run_settings {
    struct walker_params params;
    double kp;
    int transient, keep, lyapunov; /* strides: before looking, kept, of the exponent (0: none) */
};

/* Fills `count` runs in the calling thread. Each starts beside its gait along its most unstable direction, by six
 * sizes in turn until one walks on. Returns 0, or -1 without memory. Cost: about a microsecond a stride, five with
 * the exponent. */
int long_runs(const struct long_run_settings *settings, struct long_run *runs, size_t count);

#endif
