/* Method: Cody-Waite reduction to [-pi/4, pi/4] in a head and a tail, then minimax polynomials
 * (model/trig_coefficients.h, made by scripts/trig_coefficients.py). */
#include "model/trig.h"

#include "model/trig_coefficients.h"

#ifdef REAL_IS_DOUBLE
#define REDUCTION_LIMIT 1e9
#define ROUNDING_MAGIC 6755399441055744.0 /* 1.5 * 2^52: adding it rounds to an integer */
#define SPLIT_FACTOR 134217729.0          /* 2^27 + 1 */
#else
#define REDUCTION_LIMIT 1e6f
#define ROUNDING_MAGIC 12582912.0f /* 1.5 * 2^23 */
#define SPLIT_FACTOR 4097.0f       /* 2^12 + 1 */
#endif
#define TWO_OVER_PI REAL(0.63661977236758134308)

static const real sin_coefficients[TRIG_SIN_COUNT] = TRIG_SIN_COEFFICIENTS;
static const real cos_coefficients[TRIG_COS_COUNT] = TRIG_COS_COEFFICIENTS;
static const real asin_coefficients[TRIG_ASIN_COUNT] = TRIG_ASIN_COEFFICIENTS;

static inline real polynomial(const real *coefficients, int count, real z)
{
    real sum = coefficients[count - 1];
    for (int i = count - 2; i >= 0; i--) {
        sum = sum * z + coefficients[i];
    }
    return sum;
}

/* x = quadrant * pi/2 + head + tail; returns the quadrant modulo 4. */
static inline int reduce(real x, real *head, real *tail)
{
    real limited = real_clamp(x, -REDUCTION_LIMIT, REDUCTION_LIMIT);
    real n = (limited * TWO_OVER_PI + ROUNDING_MAGIC) - ROUNDING_MAGIC;
    real big = limited - n * TRIG_HALF_PI_1; /* exact: few bits, and the difference cancels */
#ifndef REAL_IS_DOUBLE
    big = big - n * TRIG_HALF_PI_2;
    real small = n * TRIG_HALF_PI_3;
    real rest = n * TRIG_HALF_PI_4;
#else
    real small = n * TRIG_HALF_PI_2;
    real rest = n * TRIG_HALF_PI_3;
#endif
    real first = big - small;
    real lost = (big - first) - small;
    real low = lost - rest;
    *head = first + low;
    *tail = (first - *head) + low;
    return (int)n & 3;
}

static inline real sin_near_zero(real x, real tail)
{
    real z = x * x;
    real cubic = x * z * polynomial(sin_coefficients, TRIG_SIN_COUNT, z);
    return x + (cubic + tail * (REAL(1.0) - REAL(0.5) * z));
}

static inline real cos_near_zero(real x, real tail)
{
    real z = x * x;
    real half = REAL(0.5) * z;
    real top = REAL(1.0) - half;
    real lost = (REAL(1.0) - top) - half;
    return top + (lost + (z * z * polynomial(cos_coefficients, TRIG_COS_COUNT, z) - x * tail));
}

void real_sincos(real x_rad, real *sin_x, real *cos_x)
{
    if (!real_is_finite(x_rad)) {
        *sin_x = *cos_x = x_rad - x_rad;
        return;
    }
    real head, tail;
    int quadrant = reduce(x_rad, &head, &tail);
    real s = sin_near_zero(head, tail);
    real c = cos_near_zero(head, tail);
    real swapped_s = (quadrant & 1) ? c : s;
    real swapped_c = (quadrant & 1) ? s : c;
    *sin_x = (quadrant & 2) ? -swapped_s : swapped_s;
    *cos_x = ((quadrant + 1) & 2) ? -swapped_c : swapped_c;
}

real real_sin(real x_rad)
{
    real s, c;
    real_sincos(x_rad, &s, &c);
    return s;
}

real real_cos(real x_rad)
{
    real s, c;
    real_sincos(x_rad, &s, &c);
    return c;
}

/* asin(x) - x for z = x*x <= 1/4. */
static inline real asin_excess(real x, real z)
{
    return x * z * polynomial(asin_coefficients, TRIG_ASIN_COUNT, z);
}

real real_acos(real x)
{
    real c = real_clamp(x, REAL(-1.0), REAL(1.0));
    real size = real_abs(c);
    if (size <= REAL(0.5)) {
        return REAL_HALF_PI - (c - (TRIG_HALF_PI_LOW - asin_excess(c, c * c)));
    }
    /* acos(s) = 2 asin(sqrt((1-s)/2)); the root in two parts, for it is doubled. */
    real z = REAL(0.5) * (REAL(1.0) - size);
    real root = real_sqrt(z);
    real scaled = root * SPLIT_FACTOR;
    real root_head = scaled - (scaled - root);
    real root_tail =
        root > REAL(0.0) ? (z - root_head * root_head) / (root + root_head) : REAL(0.0);
    real excess = asin_excess(root, z);
    if (c > REAL(0.0)) {
        return REAL(2.0) * (root_head + (root_tail + excess));
    }
    return REAL(2.0) * (REAL_HALF_PI - (root_head - (TRIG_HALF_PI_LOW - (root_tail + excess))));
}
