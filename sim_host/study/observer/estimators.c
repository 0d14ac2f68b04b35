#include "sim_host/study/observer/estimators.h"

#include <math.h>

void naive_estimator_init(struct naive_estimator *estimator, double corner_hz, double rate_hz)
{
    const double k = tan(3.14159265358979323846 * corner_hz / rate_hz);
    const double scale = 1.0 / (1.0 + sqrt(2.0) * k + k * k);
    *estimator = (struct naive_estimator){
        .b = {k * k * scale, 2.0 * k * k * scale, k * k * scale},
        .a = {2.0 * (k * k - 1.0) * scale, (1.0 - sqrt(2.0) * k + k * k) * scale}};
}

void naive_estimator_update(struct naive_estimator *e, double angle_rad, double period_s,
                            bool *plain, bool *filtered)
{
    if (!e->started) {
        e->before_rad = e->in[0] = e->in[1] = e->out[0] = e->out[1] = angle_rad;
        e->started = 1;
    }
    const double before = e->before_rad;
    const double smooth_before = e->out[0];
    const double smooth = e->b[0] * angle_rad + e->b[1] * e->in[0] + e->b[2] * e->in[1] -
                          e->a[0] * e->out[0] - e->a[1] * e->out[1];
    e->in[1] = e->in[0];
    e->in[0] = angle_rad;
    e->out[1] = e->out[0];
    e->out[0] = smooth;
    e->before_rad = angle_rad;
    *plain = before > 0.0 && angle_rad <= 0.0;
    *filtered = smooth_before > 0.0 && smooth <= 0.0;
    if (*plain) {
        e->plain_rad_s = (before - angle_rad) / period_s;
    }
    if (*filtered) {
        e->filtered_rad_s = (smooth_before - smooth) / period_s;
    }
}
