/* Gaits whose spring is released before or after heel strike, and laws on them. Plain doubles. */
#ifndef SIM_HOST_STUDY_MAP_LAWS_TIMED_H
#define SIM_HOST_STUDY_MAP_LAWS_TIMED_H

#include <stdint.h>

#include "sim_host/gait/gait_curve.h"

struct laws_timed_gait {
    double speed_rad_s, release_s; /* release after (< 0: before) the strike */
    double r0_m, apex[3];
    double map[3][3],
        input[3][2];      /* derivative of the next apex by this one; by r0 and by release */
    double eigenvalue[3]; /* magnitudes, largest first: of the gait without a law */
    double step_length_m, step_time_s;
    double energy_J_per_m; /* of the spring: k r0^2 / 2 over the step length */
    double gain[2][3];     /* least quadratic cost with both inputs: r0, release */
    double gain_r0[3];     /* with r0 alone */
};

/* The gait of that speed and release time nearest to *gait (in: r0 and apex as first guess, out: all).
 * Returns 0, or -1 when there is none within reach. Cost: about 100 strides and two Riccati iterations. */
int laws_timed_gait(const struct gait_walker *walker, double speed_rad_s, double release_s,
                    struct laws_timed_gait *gait);

enum laws_timed_law { TIMED_PROPORTIONAL = 0, TIMED_LQR_R0 = 1, TIMED_LQR_BOTH = 2 };

/* Share of a box of apex states (low[3]..high[3]) from which the law returns to the gait within 60 steps. r0 is
 * within 0.005..0.3 m, release within +-limit_s of the gait's own; kp is eq. (16)'s. */
double laws_timed_basin(const struct gait_walker *walker, const struct laws_timed_gait *gait,
                        enum laws_timed_law law, double kp, double limit_s, const double low[3],
                        const double high[3], int samples, uint64_t seed);

#endif
