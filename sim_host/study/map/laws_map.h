/* One stride of the return map for callers compiled in float: plain doubles in and out. */
#ifndef SIM_HOST_STUDY_MAP_LAWS_MAP_H
#define SIM_HOST_STUDY_MAP_LAWS_MAP_H

#include "sim_host/gait/gait_curve.h"

struct laws_stride {
    int fault;      /* enum stride_fault; 0 = there is a next apex */
    double next[3]; /* stance rate, swing angle, swing rate */
    double apex_to_strike_s, double_support_s, lift_off_to_apex_s;
    double step_length_m;
    double after_collision
        [2]; /* inter-leg angle (rad), ankle rate r'+ (m/s): all that is left of the state */
};

/* Steps of the integration: fine = 1e-10, coarse = 1e-6 of the next apex at a third of the cost. */
enum laws_accuracy { LAWS_FINE = 0, LAWS_COARSE = 1 };

/* slope in rad, rise of the next foothold in leg lengths. Returns the fault. */
int laws_stride(const struct gait_walker *walker, enum laws_accuracy accuracy, const double apex[3],
                double r0_m, double slope_rad, double rise, struct laws_stride *result);

/* The fault in words; a static string. */
const char *laws_fault_name(int fault);

#endif
