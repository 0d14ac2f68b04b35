/* Sine, cosine and inverse sine of a vector, with the polynomials of model/trig.h.
 *
 * The flight's angles lie within 3 pi / 2 (more than pi between the legs is a fault), so the reduction to
 * [-pi/4, pi/4] is a product and two differences. Error: at most 1.5 units in the last place, or 1e-16
 * near a zero of the function. About 3 % of a stride's time is spent here.
 */
#ifndef SIM_HOST_BATCH_LANES_TRIG_H
#define SIM_HOST_BATCH_LANES_TRIG_H

#include "model/trig_coefficients.h"
#include "sim_host/batch/lanes.h"

#define LANES_HALF_PI 1.57079632679489661923
#define LANES_PI 3.14159265358979323846
#define LANES_ROUND_MAGIC 6755399441055744.0 /* 1.5 * 2^52: adding it rounds to an integer */

static const double lanes_sin_terms[TRIG_SIN_COUNT] = TRIG_SIN_COEFFICIENTS;
static const double lanes_cos_terms[TRIG_COS_COUNT] = TRIG_COS_COEFFICIENTS;
static const double lanes_asin_terms[TRIG_ASIN_COUNT] = TRIG_ASIN_COEFFICIENTS;

LANE_INLINE vd vd_polynomial(const double *terms, int count, vd z)
{
    vd sum = vd_all(terms[count - 1]);
    for (int i = count - 2; i >= 0; i--) {
        sum = sum * z + terms[i];
    }
    return sum;
}

/* |x| <= 1e4; beyond, and for what is not finite, some value: the caller's check finds it by x. */
LANE_INLINE void vd_sincos(vd x, vd *sin_x, vd *cos_x)
{
    const vd shifted = x * (1.0 / LANES_HALF_PI) + LANES_ROUND_MAGIC;
    const vd n = shifted - LANES_ROUND_MAGIC;
    const vi quadrant = (vi)shifted; /* its low bits are n's */
    const vd big = x - n * TRIG_HALF_PI_1;
    const vd small = n * TRIG_HALF_PI_2;
    const vd head = big - small;
    const vd tail = (big - head) - small;
    const vd z = head * head;
    const vd half = 0.5 * z;
    const vd s =
        head + (head * z * vd_polynomial(lanes_sin_terms, TRIG_SIN_COUNT, z) + tail * (1.0 - half));
    const vd top = 1.0 - half;
    const vd c = top + (((1.0 - top) - half) +
                        (z * z * vd_polynomial(lanes_cos_terms, TRIG_COS_COUNT, z) - head * tail));
    const vi odd = -(quadrant & 1);
    const vi sign_s = (vi)((vu)quadrant << 62) & vi_all(INT64_MIN);
    const vi sign_c = (vi)((vu)(quadrant + 1) << 62) & vi_all(INT64_MIN);
    *sin_x = (vd)((vi)vd_pick(odd, c, s) ^ sign_s);
    *cos_x = (vd)((vi)vd_pick(odd, s, c) ^ sign_c);
}

/* The angle in [-pi/2, pi/2] whose sine is x and whose cosine is root >= 0; x^2 + root^2 = 1 to rounding.
 * With both given, nothing is lost near the ends. */
LANE_INLINE vd vd_asin(vd x, vd root)
{
    const vd size = vd_abs(x);
    const vi steep = size > root;
    /* The smaller of the two is at most sqrt(1/2), the polynomial serves to 1/2: halve the angle,
     * sin(a/2) = sin a / (2 cos(a/2)). */
    const vd low = vd_pick(steep, root, size), high = vd_pick(steep, size, root);
    const vd half_sin = low / vd_sqrt(2.0 * (1.0 + high));
    const vd z = half_sin * half_sin;
    const vd angle =
        2.0 * (half_sin + half_sin * z * vd_polynomial(lanes_asin_terms, TRIG_ASIN_COUNT, z));
    const vd turned = vd_pick(steep, LANES_HALF_PI - angle, angle);
    return (vd)((vi)turned | ((vi)x & vi_all(INT64_MIN)));
}

#endif
