#include "sim_host/study/size/ankle_curve.h"

enum { POINTS = 13 };

/* Share of the stride; plantarflexion in degrees. */
static const struct {
    double share, deg;
} landmark[POINTS] = {{0.00, 0.0},  {0.08, 5.0},  {0.16, 1.0},  {0.30, -6.0}, {0.44, -10.0},
                      {0.50, -7.0}, {0.56, 6.0},  {0.62, 19.0}, {0.68, 13.0}, {0.76, 3.0},
                      {0.84, -1.0}, {0.92, -1.0}, {1.00, 0.0}};

static const double DEG = 0.017453292519943295;

/* Slope at a landmark through its neighbours; the curve is periodic. */
static double slope(int i)
{
    const int before = i == 0 ? POINTS - 2 : i - 1, after = i == POINTS - 1 ? 1 : i + 1;
    const double from = landmark[before].share - (i == 0 ? 1.0 : 0.0);
    const double to = landmark[after].share + (i == POINTS - 1 ? 1.0 : 0.0);
    return (landmark[after].deg - landmark[before].deg) / (to - from);
}

double ankle_curve_rad(double share)
{
    const double turn = share - (double)(long long)share;
    const double at = turn < 0.0 ? turn + 1.0 : turn;
    int i = 0;
    while (i + 2 < POINTS && landmark[i + 1].share <= at) {
        i++;
    }
    const double h = landmark[i + 1].share - landmark[i].share;
    const double u = (at - landmark[i].share) / h;
    const double a = landmark[i].deg, b = landmark[i + 1].deg;
    const double ra = h * slope(i), rb = h * slope(i + 1);
    const double c2 = 3.0 * (b - a) - 2.0 * ra - rb, c3 = 2.0 * (a - b) + ra + rb;
    return DEG * (a + u * (ra + u * (c2 + u * c3)));
}
