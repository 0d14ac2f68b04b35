#include "sim_host/study/noisy_map.h"

#include <math.h>
#include <stddef.h>

#include "model/stride.h"
#include "sim_host/plant/rng.h"
#include "sim_host/study/gait_curve.h"

enum { SECANT_STEPS = 12, SETTLE_STRIDES = 20 };
#define LEAST_R0_M 0.002

static int gait_at_r0(double r0_m, struct gait_point *point)
{
    const struct gait_walker walker = gait_walker_of_paper();
    return gait_curve(&walker, r0_m, 0.0, 1, point, NULL) == GAIT_CURVE_OK;
}

/* The gait of a speed: v^2 rises nearly in proportion to r0, so the secant method in it is quick. */
static int gait_at_speed(double speed, struct gait_point *point)
{
    struct gait_point a, b;
    if (!gait_at_r0(0.05, &a) || !gait_at_r0(0.06, &b)) {
        return 0;
    }
    for (int i = 0; i < SECANT_STEPS; i++) {
        const double qa = a.speed_rad_s * a.speed_rad_s, qb = b.speed_rad_s * b.speed_rad_s;
        if (fabs(b.speed_rad_s - speed) < 1e-10 || qa == qb) {
            break;
        }
        double r0 = b.r0_m + (speed * speed - qb) * (b.r0_m - a.r0_m) / (qb - qa);
        r0 = fmin(0.298, fmax(0.005, r0));
        a = b;
        if (!gait_at_r0(r0, &b)) {
            return 0;
        }
    }
    *point = b;
    return fabs(b.speed_rad_s - speed) < 1e-6;
}

int noisy_map_walk(double speed_rad_s, double kp_m_s_rad, double error_share, int strides,
                   uint64_t seed, struct noisy_walk *walk)
{
    const struct walker_params params = walker_paper_params();
    struct walker walker;
    struct gait_point gait;
    struct stride_result result;
    struct rng rng;
    double sum = 0.0, squares = 0.0;
    int counted = 0;
    if (walker_init(&walker, &params) != WALKER_OK || !gait_at_speed(speed_rad_s, &gait)) {
        return -1;
    }
    const struct stride_settings settings = stride_settings_fixed(&walker, 0.005);
    struct apex apex = {gait.apex[0], gait.apex[1], gait.apex[2]};
    rng_init(&rng, seed, 0);
    *walk = (struct noisy_walk){0};
    while (walk->walked < strides) {
        const double speed = -apex.stance_rate_rad_s;
        const double measured = speed * (1.0 + error_share * rng_normal(&rng));
        const double wanted = gait.r0_m - kp_m_s_rad * (speed_rad_s - measured);
        if (walk->walked >= SETTLE_STRIDES) {
            sum += speed;
            squares += speed * speed;
            counted++;
        }
        if (stride(&walker, &settings, &apex, fmax(wanted, LEAST_R0_M), &result) != STRIDE_OK) {
            walk->fell = 1;
            break;
        }
        apex = result.next;
        walk->walked++;
    }
    if (counted > 1) {
        const double mean = sum / counted;
        walk->spread = sqrt(fmax(0.0, squares / counted - mean * mean)) / mean;
    }
    return 0;
}
