/* Correction gains of the model observer over the time since lift-off.
 *
 * Per leg a rate-and-angle filter in the walker's own time unit sqrt(l/g): with e the
 * measured minus the predicted angle, angle += angle_gain e dt, rate += rate_gain e dt,
 * all in that unit. They are the Kalman-Bucy gains of the legs linearised about the
 * vertical (stance an inverted pendulum, swing a pendulum of half the length), from
 * the uncertainty that the lift-off map leaves to the steady state that a stated
 * error of the model's acceleration demands. As only the ratios of these
 * uncertainties to the sensor's noise matter, and the angles are known within
 * tenths of a second far better than from lift-off, one table serves all sensors.
 * Made by `afo study observer-gains`, which states the assumptions.
 */
#ifndef CONTROLLER_ESTIMATOR_OBSERVER_GAINS_H
#define CONTROLLER_ESTIMATOR_OBSERVER_GAINS_H

#include "model/real.h"

#define observer_gains REAL_SYMBOL(observer_gains)

enum { OBSERVER_GAIN_KNOTS = 16 };

struct observer_gain {
    real since;     /* time since lift-off over sqrt(l/g), ascending */
    real stance[2]; /* angle gain, rate gain */
    real swing[2];
};

extern const struct observer_gain observer_gains[OBSERVER_GAIN_KNOTS];

#endif
