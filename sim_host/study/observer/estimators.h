/* Two estimators without a model, for comparison: plain differentiation, and a Butterworth filter.
 *
 * Both give the leg's rate at the moment its angle falls through zero.
 */
#ifndef SIM_HOST_STUDY_OBSERVER_ESTIMATORS_H
#define SIM_HOST_STUDY_OBSERVER_ESTIMATORS_H

#include <stdbool.h>

struct naive_estimator {
    double before_rad;     /* last sample */
    double in[2], out[2];  /* of the filter, newest first */
    double b[3], a[2];     /* its coefficients */
    double plain_rad_s;    /* forward speed at the last crossing of the raw angle */
    double filtered_rad_s; /* and of the filtered angle */
    int started;
};

/* Second-order Butterworth low-pass, bilinear, corner_hz at rate_hz. */
void naive_estimator_init(struct naive_estimator *estimator, double corner_hz, double rate_hz);

/* One sample. *plain and *filtered tell which of the two has a new speed. */
void naive_estimator_update(struct naive_estimator *estimator, double angle_rad, double period_s,
                            bool *plain, bool *filtered);

#endif
