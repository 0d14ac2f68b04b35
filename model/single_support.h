/* Single support: one foot on the ground with the heel locked (r = 0), the other leg swinging.
 *
 * State as an array, for the integrator: indices below. Stance toe at the origin, walker moves
 * towards -x: hip = (l sin ts, l cos ts), swing toe = hip - (l sin tn, l cos tn).
 */
#ifndef MODEL_SINGLE_SUPPORT_H
#define MODEL_SINGLE_SUPPORT_H

#include "model/walker.h"

enum single_support_index {
    STANCE_ANGLE = 0, /* ts, rad */
    SWING_ANGLE = 1,  /* tn, rad */
    STANCE_RATE = 2,  /* ts', rad/s; < 0 walking forward */
    SWING_RATE = 3,   /* tn', rad/s */
    SINGLE_SUPPORT_STATES = 4
};

struct point {
    real x_m, y_m;
};

#define single_support_rates REAL_SYMBOL(single_support_rates)
#define single_support_energy_J REAL_SYMBOL(single_support_energy_J)
#define single_support_hip REAL_SYMBOL(single_support_hip)
#define single_support_swing_toe REAL_SYMBOL(single_support_swing_toe)
#define single_support_swing_toe_speed REAL_SYMBOL(single_support_swing_toe_speed)

/* d(state)/dt, in the form the integrator wants (context is a struct walker). The double pendulum
 * of Goswami et al. (1997); swing-leg equation divided by its mass, so m = 0 is served.
 * Callable from anywhere; constant cost, two sine-cosine pairs. */
void single_support_rates(const void *walker, const real *state, real *rates);

/* Kinetic plus gravitational energy, J; zero height is the ground. Constant along a motion. */
real single_support_energy_J(const struct walker *walker, const real *state);

/* Positions of hip and swing toe and the swing toe's velocity (m, m/s), origin at the stance toe. */
struct point single_support_hip(const struct walker *walker, const real *state);
struct point single_support_swing_toe(const struct walker *walker, const real *state);
struct point single_support_swing_toe_speed(const struct walker *walker, const real *state);

#endif
