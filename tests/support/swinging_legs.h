/* Legs of a made-up walker whose events are known: in stance a leg turns backwards at a constant rate; in swing its rate
 * rises smoothly to a peak and falls back to the stance rate, which it reaches when the foot is planted. */
#ifndef TESTS_SUPPORT_SWINGING_LEGS_H
#define TESTS_SUPPORT_SWINGING_LEGS_H

#include <math.h>

#include "model/side.h"

struct person {
    double stride_s;
    double speed_rad_s; /* backwards rate in stance */
    double offset_rad[SIDE_COUNT];
    double noise_rad;
};

#define SWING_SHARE_OF_STRIDE 0.4

/* Angle of a leg at the share u (0..1) of its stride, 0 = heel strike. The swing's
 * rate is -v + p (1 - cos 2 pi s) / 2 * 2 with s = 0..1, so that the stride closes:
 * the mean of the bump, p, makes up for v over the whole stride. */
static inline double leg_angle(const struct person *person, double u)
{
    const double v = person->speed_rad_s, stride = person->stride_s;
    const double stance = 1.0 - SWING_SHARE_OF_STRIDE;
    const double p = v / SWING_SHARE_OF_STRIDE;
    double angle = v * stride * stance * 0.5 - v * stride * u;
    if (u > stance) {
        const double s = (u - stance) / SWING_SHARE_OF_STRIDE;
        angle += p * stride * SWING_SHARE_OF_STRIDE * (s - sin(2.0 * M_PI * s) / (2.0 * M_PI));
    }
    return angle;
}

#endif
