/* Eigenvalues of steady gaits under eq. (16), and the gain that suits a whole branch of them.
 *
 * r0[k] = r0* - kp (v* - v[k]), v = -x0: the law adds -kp dG/dr0 to the first column of the map's derivative. So
 * the closed loop of any gain follows from the derivatives without the law.
 */
#ifndef SIM_HOST_GAIT_LOOP_GAIN_H
#define SIM_HOST_GAIT_LOOP_GAIN_H

#include "sim_host/gait/linear.h"

struct loop_point {
    double r0_m, speed_rad_s;
    double by_apex[3][3], by_r0[3]; /* derivative of the next apex */
};

/* Eigenvalues of one gait under the law, largest magnitude first. kp in m per rad/s. */
void loop_gain_eigenvalues(const struct loop_point *point, double kp, struct eigenvalue values[3]);

/* The largest magnitude over all the gaits; below 1: each is stable. */
double loop_gain_largest(const struct loop_point *points, int count, double kp);

/* The gain that makes that smallest, looked for from 0 to LOOP_GAIN_MOST `unit` (1 for the paper's walker). */
#define LOOP_GAIN_MOST 0.2
double loop_gain_best(const struct loop_point *points, int count, double unit);

#endif
