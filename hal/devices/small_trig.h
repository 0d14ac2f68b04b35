/* Sine for an ankle's lever: |x| <= pi, the same bits on every machine.
 *
 * hal/ includes only its own headers, so it has this small series instead of
 * model/trig.h: Taylor to x^11 after folding to |x| <= pi/2, error below 1e-7.
 */
#ifndef HAL_DEVICES_SMALL_TRIG_H
#define HAL_DEVICES_SMALL_TRIG_H

static inline float small_sin(float x_rad)
{
    const float pi = 3.14159265358979323846f;
    if (x_rad > 0.5f * pi) {
        x_rad = pi - x_rad;
    } else if (x_rad < -0.5f * pi) {
        x_rad = -pi - x_rad;
    }
    const float x2 = x_rad * x_rad;
    const float series =
        1.0f +
        x2 * (-1.0f / 6.0f +
              x2 * (1.0f / 120.0f +
                    x2 * (-1.0f / 5040.0f + x2 * (1.0f / 362880.0f + x2 * (-1.0f / 39916800.0f)))));
    return x_rad * series;
}

#endif
