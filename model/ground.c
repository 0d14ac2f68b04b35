#include "model/ground.h"

#include "model/trig.h"

real ground_incline_rad(const struct ground *ground, real inter_leg_rad)
{
    if (ground->height_rise == REAL(0.0)) {
        return ground->slope_rad;
    }
    /* Toes d = 2 l sin(D/2) apart; d sin e = d cos e tan(slope) + rise. */
    const real distance = REAL(2.0) * real_sin(REAL(0.5) * inter_leg_rad);
    const real share = ground->height_rise * real_cos(ground->slope_rad) / distance;
    return ground->slope_rad + (REAL_HALF_PI - real_acos(share));
}
