/* Speed and time of a zero crossing from noisy samples around it.
 *
 * A cubic is fitted by least squares to the 2w + 1 samples centred on the first
 * sample at or below zero; its root nearest the centre is the crossing, its
 * slope there the speed. On a symmetric grid the normal equations split into an
 * even and an odd pair and are solved in closed form (Savitzky & Golay 1964).
 * The stance leg near the vertical follows sinh(sqrt(g/l) t): with w = 80 ms the
 * neglected fifth order biases the speed by less than 1e-5 of it.
 */
#ifndef CONTROLLER_ESTIMATOR_APEX_FIT_H
#define CONTROLLER_ESTIMATOR_APEX_FIT_H

#include <stdint.h>

#include "model/real.h"

#define apex_fit_begin REAL_SYMBOL(apex_fit_begin)
#define apex_fit_add REAL_SYMBOL(apex_fit_add)
#define apex_fit_solve REAL_SYMBOL(apex_fit_solve)
#define apex_fit_other_leg REAL_SYMBOL(apex_fit_other_leg)

struct apex_fit {
    real
        before_tick_s; /* the crossing lies this long before the centre sample; noise can make it < 0 */
    real speed_rad_s; /* minus the slope at the crossing; <= 0 when no falling crossing was found */
};

struct angle_fit {
    real angle_rad;
    real rate_rad_s;
};

/* What one leg's samples add up to: even and odd parts with powers of u = n / window. A
 * fit takes a pair of samples a tick, so that no tick bears the cost of all. */
struct apex_sums {
    real even0, even2, odd1, odd3;
    uint32_t pairs;
};

/* Begins at the centre sample. O(1). Pure, as all of these. */
void apex_fit_begin(struct apex_sums *sums, real centre_rad);

/* Adds the samples that lie `pairs` + 1 ticks after and before the centre; to be called
 * `window` times. window: half the width of the fit in ticks, >= 2, always the same.
 * About 12 operations. */
void apex_fit_add(struct apex_sums *sums, uint32_t window, real after_rad, real before_rad);

/* The crossing, after all 2 * window + 1 samples. About 100 operations. */
struct apex_fit apex_fit_solve(const struct apex_sums *sums, uint32_t window);

/* The other leg at the same moment: value and slope of its own cubic, before_tick_s
 * before the centre sample (|before_tick_s| at most half the window). About 60
 * operations. */
struct angle_fit apex_fit_other_leg(const struct apex_sums *sums, uint32_t window,
                                    real before_tick_s);

#endif
