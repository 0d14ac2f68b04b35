#include "model/collision.h"

#include <stddef.h>

#include "model/trig.h"

void collision_map(const struct walker *walker, real angle_difference_rad, real ankle_m,
                   real map[3][3])
{
    const real M = walker->params.hip_mass_kg, m = walker->params.leg_mass_kg,
               l = walker->params.leg_length_m;
    const real r = ankle_m, l1 = l + r;
    real s, c;
    real_sincos(angle_difference_rad, &s, &c);
    const real s2 = REAL(2.0) * s * c;             /* sin 2D */
    const real c2 = REAL(1.0) - REAL(2.0) * s * s; /* cos 2D */
    const real bracket = l * l * (REAL(3.0) * m + REAL(4.0) * M) + REAL(8.0) * l * (m + M) * r +
                         (REAL(6.0) * m + REAL(4.0) * M) * r * r;
    const real divisor = -l * l * (REAL(7.0) * m + REAL(8.0) * M) - REAL(16.0) * l * (m + M) * r -
                         REAL(2.0) * (REAL(5.0) * m + REAL(4.0) * M) * r * r +
                         m * l * (REAL(3.0) * l + REAL(4.0) * r) * c2;
    const real heavy = REAL(6.0) * m + REAL(4.0) * M;
    const real scale = REAL(1.0) / divisor;

    map[0][0] = scale * (REAL(-2.0) * c * c * bracket);
    map[0][1] = scale * (REAL(2.0) * m * l * c * l1);
    map[0][2] = scale * (-heavy * l1 * s2);
    map[1][0] = scale * (REAL(-2.0) * c * l1 * bracket / l);
    map[1][1] = scale * (REAL(2.0) * m * l1 * l1);
    map[1][2] = scale * (REAL(-2.0) * heavy * l1 * l1 * s / l);
    map[2][0] = scale * (-l1 * s2 * bracket);
    map[2][1] = scale * (REAL(2.0) * m * l * l1 * l1 * s);
    map[2][2] = scale * (REAL(-2.0) * heavy * l1 * l1 * s * s);
}

struct collision_rates collision_apply(const struct walker *walker, real angle_difference_rad,
                                       real ankle_m, struct collision_rates before)
{
    real h[3][3];
    collision_map(walker, angle_difference_rad, ankle_m, h);
    const real in[3] = {before.stance_rad_s, before.swing_rad_s, before.ankle_m_s};
    real out[3];
    for (int i = 0; i < 3; i++) {
        out[i] = h[i][0] * in[0] + h[i][1] * in[1] + h[i][2] * in[2];
    }
    const struct collision_rates after = {out[0], out[1], out[2]};
    return after;
}

real collision_ankle_rate_m_s(const struct walker *walker, real angle_difference_rad,
                              real stance_rate_rad_s, real swing_rate_rad_s)
{
    const real M = walker->params.hip_mass_kg, m = walker->params.leg_mass_kg,
               l = walker->params.leg_length_m;
    real s, c;
    real_sincos(angle_difference_rad, &s, &c);
    /* 7m + 8M - 3m cos 2D, and sin 2D = 2 s c */
    const real divisor = REAL(4.0) * m + REAL(8.0) * M + REAL(6.0) * m * s * s;
    const real drive =
        (REAL(3.0) * m + REAL(4.0) * M) * c * stance_rate_rad_s - m * swing_rate_rad_s;
    return REAL(2.0) * l * s * drive / divisor;
}

real collision_clamp_m_s(real ankle_rate_m_s, int *clamped)
{
    const int acts = ankle_rate_m_s < REAL(0.0);
    if (clamped != NULL) {
        *clamped = acts;
    }
    return acts ? REAL(0.0) : ankle_rate_m_s;
}
