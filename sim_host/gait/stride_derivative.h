/* The return map's derivative, by variational equations carried through the events.
 *
 * The stride is run first (model/stride). Then state and sensitivities are integrated together over the phases,
 * whose durations are now known. At each event they are corrected for the event's own shift in time (the
 * saltation matrices of strike, lift-off and apex). There are no finite differences. Double only.
 */
#ifndef SIM_HOST_GAIT_STRIDE_DERIVATIVE_H
#define SIM_HOST_GAIT_STRIDE_DERIVATIVE_H

#include "model/stride.h"

/* What the next apex is differentiated by: the apex before (three), then three parameters. */
enum sensitivity_column {
    BY_STANCE_RATE = 0,
    BY_SWING_ANGLE = 1,
    BY_SWING_RATE = 2,
    BY_SPRING_REST = 3, /* r0 of this stride */
    BY_STIFFNESS = 4,   /* k */
    BY_LEG_MASS = 5,    /* m */
    SENSITIVITY_COLUMNS = 6
};

struct stride_derivative {
    double next[3][SENSITIVITY_COLUMNS]; /* d(stance rate, swing angle, swing rate) / d(column) */
    /* Of what is left of the state after the collision: toe distance d and ankle rate r'+. That these
     * are two numbers and not three is why one eigenvalue of the map is always zero. */
    double after_collision[2][SENSITIVITY_COLUMNS];
};

/* Runs the stride and, when it succeeds, differentiates it. Arguments as for stride(); *derivative is
 * written on STRIDE_OK only. Accuracy is that of the stride: 1e-10 with stride_settings_accurate.
 * Where the clamp acts the derivative is that of the clamped branch. About five strides' cost. */
enum stride_fault stride_differentiate(const struct walker *walker,
                                       const struct stride_settings *settings,
                                       const struct apex *from, double spring_rest_m,
                                       struct stride_result *result,
                                       struct stride_derivative *derivative);

#endif
