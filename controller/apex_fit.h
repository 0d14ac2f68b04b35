/* Speed and time of a zero crossing from noisy samples around it.
 *
 * A cubic is fitted by least squares to the 2w + 1 samples centred on the first
 * sample at or below zero; its root nearest the centre is the crossing, its
 * slope there the speed. On a symmetric grid the normal equations split into an
 * even and an odd pair and are solved in closed form (Savitzky & Golay 1964).
 * The stance leg near the vertical follows sinh(sqrt(g/l) t): with w = 80 ms the
 * neglected fifth order biases the speed by less than 1e-5 of it.
 */
#ifndef CONTROLLER_APEX_FIT_H
#define CONTROLLER_APEX_FIT_H

#include <stdint.h>

#include "model/real.h"

#define apex_fit_solve REAL_SYMBOL(apex_fit_solve)
#define apex_fit_other_leg REAL_SYMBOL(apex_fit_other_leg)

struct apex_fit {
    real before_tick_s; /* the crossing lies this long before the centre sample; noise can make it < 0 */
    real speed_rad_s;   /* minus the slope at the crossing; <= 0 when no falling crossing was found */
};

struct angle_fit {
    real angle_rad;
    real rate_rad_s;
};

/* angle_rad[tick % size] are the samples, one a control tick; size is a power of
 * two above 2 * window; window >= 2. All 2 * window + 1 samples must be there.
 * Pure. Cost: about 10 operations a sample and 3 Newton steps. */
struct apex_fit apex_fit_solve(const real *angle_rad, uint32_t size, uint32_t centre_tick,
                               uint32_t window);

/* The other leg at the same moment: value and slope of its own cubic, before_tick_s
 * before the centre sample (|before_tick_s| at most half the window). Samples and
 * cost as above. Pure. */
struct angle_fit apex_fit_other_leg(const real *angle_rad, uint32_t size, uint32_t centre_tick,
                                    uint32_t window, real before_tick_s);

#endif
