/* Newton's method for period-1 gaits of the return map. Double only (compiled with REAL_IS_DOUBLE). */
#ifndef SIM_HOST_STUDY_FIXED_POINT_H
#define SIM_HOST_STUDY_FIXED_POINT_H

#include "model/stride.h"

enum fixed_point_status {
    FIXED_POINT_OK = 0,
    FIXED_POINT_FAULT = -1, /* the walker falls on the way: result->fault says how */
    FIXED_POINT_NO_CONVERGENCE = -2
};

/* x (stance rate, swing angle, swing rate): first guess in, gait out; *result: the stride from it.
 * Residual below 1e-12 in the largest of the three (in units in which l and g are near 1).
 * At most 25 iterations of seven strides. */
enum fixed_point_status fixed_point_find(const struct walker *walker,
                                         const struct stride_settings *settings,
                                         double spring_rest_m, double x[3],
                                         struct stride_result *result);

#endif
