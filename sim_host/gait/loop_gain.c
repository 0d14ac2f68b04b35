#include "sim_host/gait/loop_gain.h"

void loop_gain_eigenvalues(const struct loop_point *point, double kp, struct eigenvalue values[3])
{
    double J[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            J[i][j] = point->by_apex[i][j] - (j == 0 ? kp * point->by_r0[i] : 0.0);
        }
    }
    linear_eigenvalues3((const double(*)[3])J, values);
}

double loop_gain_largest(const struct loop_point *points, int count, double kp)
{
    double largest = 0.0;
    for (int i = 0; i < count; i++) {
        struct eigenvalue values[3];
        loop_gain_eigenvalues(&points[i], kp, values);
        largest = linear_magnitude(values[0]) > largest ? linear_magnitude(values[0]) : largest;
    }
    return largest;
}

/* Scan, then golden section around the best. */
double loop_gain_best(const struct loop_point *points, int count, double unit)
{
    enum { PARTS = 200 };
    const double step = LOOP_GAIN_MOST / PARTS * unit, golden = 0.6180339887498949;
    int best = 0;
    double smallest = 1e300;
    for (int i = 0; i <= PARTS; i++) {
        const double largest = loop_gain_largest(points, count, i * step);
        if (largest < smallest) {
            smallest = largest;
            best = i;
        }
    }
    double low = (best - 1) * step, high = (best + 1) * step;
    while (high - low > 1e-10 * unit) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        if (loop_gain_largest(points, count, a) < loop_gain_largest(points, count, b)) {
            high = b;
        } else {
            low = a;
        }
    }
    return 0.5 * (low + high);
}
