/* Heel strike: the swing toe hits the ground and stays, the stance toe stays, the ankle is free to extend.
 *
 * Plastic, without slip: q+ = (I - Mc^-1 J^T (J Mc^-1 J^T)^-1 J) q-, q = (ts, tn, r)
 * (paper eq. 10; entries of H_c as in the paper's Appendix with the lost term of H_31 put back,
 * J with (l+r) in its first column, where eq. 7 prints r).
 */
#ifndef MODEL_COLLISION_H
#define MODEL_COLLISION_H

#include "model/walker.h"

/* Rates of (ts, tn, r) in rad/s, rad/s, m/s. */
struct collision_rates {
    real stance_rad_s, swing_rad_s, ankle_m_s;
};

#define collision_map REAL_SYMBOL(collision_map)
#define collision_apply REAL_SYMBOL(collision_apply)
#define collision_ankle_rate_m_s REAL_SYMBOL(collision_ankle_rate_m_s)
#define collision_clamp_m_s REAL_SYMBOL(collision_clamp_m_s)

/* The general map H_c for leg angles difference D = ts - tn (rad) and ankle extension r >= 0 (m),
 * row by row. Precondition: sin D != 0 or r != 0 (else both feet are at one place, and the map
 * is not needed; its entries are finite all the same for the walker's masses). Constant cost. */
void collision_map(const struct walker *walker, real angle_difference_rad, real ankle_m,
                   real map[3][3]);

/* Rates after impact = H_c times rates before it. Same preconditions. */
struct collision_rates collision_apply(const struct walker *walker, real angle_difference_rad,
                                       real ankle_m, struct collision_rates before);

/* The special case r = r' = 0 before impact: the ankle's rate after it, m/s (paper eq. 11 with its
 * lost sign, l and m). Positive for a forward step with less than a right angle between the legs. */
real collision_ankle_rate_m_s(const struct walker *walker, real angle_difference_rad,
                              real stance_rate_rad_s, real swing_rate_rad_s);

/* The one-directional joint: the heel cannot go underground, so a negative rate after impact becomes 0
 * and the walker is at rest until the spring starts it. *clamped (may be NULL) tells whether it acted.
 * This is what makes the gaits of the paper's Table 2 exist. NaN passes through. */
real collision_clamp_m_s(real ankle_rate_m_s, int *clamped);

#endif
