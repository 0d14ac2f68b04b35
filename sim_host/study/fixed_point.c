#include "sim_host/study/fixed_point.h"

#define MAX_ITERATIONS 25
#define TOLERANCE 1e-12
#define DIFFERENCE 1e-6

static int map(const struct walker *walker, const struct stride_settings *settings, double r0,
               const double x[3], double next[3], struct stride_result *result)
{
    const struct apex from = {x[0], x[1], x[2]};
    if (stride(walker, settings, &from, r0, result) != STRIDE_OK) {
        return 0;
    }
    next[0] = result->next.stance_rate_rad_s;
    next[1] = result->next.swing_angle_rad;
    next[2] = result->next.swing_rate_rad_s;
    return 1;
}

/* Gauss-Jordan with row exchange on the 3 x 4 system; 0 when it is singular. */
static int solve3(double a[3][4], double x[3])
{
    for (int c = 0; c < 3; c++) {
        int p = c;
        for (int i = c + 1; i < 3; i++) {
            if (real_abs(a[i][c]) > real_abs(a[p][c])) {
                p = i;
            }
        }
        for (int k = 0; k < 4; k++) {
            const double t = a[c][k];
            a[c][k] = a[p][k];
            a[p][k] = t;
        }
        if (!(real_abs(a[c][c]) > 1e-14)) {
            return 0;
        }
        for (int i = 0; i < 3; i++) {
            const double q = a[i][c] / a[c][c];
            for (int k = c; k < 4 && i != c; k++) {
                a[i][k] -= q * a[c][k];
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        x[i] = a[i][3] / a[i][i];
    }
    return 1;
}

enum fixed_point_status fixed_point_find(const struct walker *walker,
                                         const struct stride_settings *settings,
                                         double spring_rest_m, double x[3],
                                         struct stride_result *result)
{
    for (int iteration = 0; iteration < MAX_ITERATIONS; iteration++) {
        double next[3], system[3][4], correction[3];
        double residual = 0.0;
        struct stride_result side;
        if (!map(walker, settings, spring_rest_m, x, next, result)) {
            return FIXED_POINT_FAULT;
        }
        for (int i = 0; i < 3; i++) {
            system[i][3] = x[i] - next[i];
            residual = real_abs(system[i][3]) > residual ? real_abs(system[i][3]) : residual;
        }
        if (residual < TOLERANCE) {
            return FIXED_POINT_OK;
        }
        for (int j = 0; j < 3; j++) {
            double shifted[3] = {x[0], x[1], x[2]}, up[3], down[3];
            shifted[j] = x[j] + DIFFERENCE;
            if (!map(walker, settings, spring_rest_m, shifted, up, &side)) {
                return FIXED_POINT_FAULT;
            }
            shifted[j] = x[j] - DIFFERENCE;
            if (!map(walker, settings, spring_rest_m, shifted, down, &side)) {
                return FIXED_POINT_FAULT;
            }
            for (int i = 0; i < 3; i++) {
                system[i][j] = (up[i] - down[i]) / (2.0 * DIFFERENCE) - (i == j ? 1.0 : 0.0);
            }
        }
        if (!solve3(system, correction)) {
            return FIXED_POINT_NO_CONVERGENCE;
        }
        for (int i = 0; i < 3; i++) {
            x[i] += correction[i];
        }
    }
    return FIXED_POINT_NO_CONVERGENCE;
}
