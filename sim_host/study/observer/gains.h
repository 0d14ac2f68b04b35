/* Computes the model observer's gains from stated uncertainties. */
#ifndef SIM_HOST_STUDY_OBSERVER_GAINS_H
#define SIM_HOST_STUDY_OBSERVER_GAINS_H

#include <stdio.h>

/* The uncertainties that the gains follow from, for the paper's walker (g/l = 9.80665 / s^2). The results hold for
 * others in their own time unit. */
struct gain_assumptions {
    double noise_rad;       /* of one angle sample, RMS, white */
    double sample_s;        /* one sample each */
    double start_angle_rad; /* RMS error of the state that lift-off leaves */
    double start_rate_rad_s;
    double stance_density; /* of the model's acceleration error, rad^2/s^3 */
    double swing_density;
};

/* 14-bit encoders with one count of noise; see gains.c for where the others come from. */
struct gain_assumptions gain_assumptions_default(void);

/* Computes the gains of one leg at times since lift-off (in sqrt(l/g), ascending). Solves the Riccati equation of
 * x' = (rate, spring * angle) by a fixed fine step. */
void gain_schedule(const struct gain_assumptions *assumptions, double spring, double density,
                   const double *since, int count, double (*gain)[2]);

#endif
