/* Finds the start of the two branches of period-1 gaits, for any walker.
 *
 * "long" and "short" name them by step period. The short one is the faster at the apex, and always unstable. The
 * branch is followed from the paper's gaits at r0 = 0.05 in the walker's own units (M = 1, l = 1, g = 1). There
 * a walker is two numbers: m/M and k l / (M g).
 */
#ifndef SIM_HOST_GAIT_BRANCH_H
#define SIM_HOST_GAIT_BRANCH_H

#include "sim_host/gait/orbit.h"

enum branch { BRANCH_LONG = 0, BRANCH_SHORT = 1 };

/* A gait in the walker's own units: place in parameter space, state, and the last two steps' secant. */
struct branch_gait {
    double mass_ratio, stiffness, r0; /* m/M, k l / (M g), r0 / l */
    double x[3];                      /* rates times sqrt(l/g) */
    struct stride_result stride;      /* from it, in own units; valid after branch_follow */
};

/* The paper's walker's gait at r0 = 0.05. */
struct branch_gait branch_start(enum branch branch);

/* Follows the branch in a straight line of (mass ratio, stiffness, r0), in steps that adapt.
 * Returns 1 when there; 0 when the branch was lost: *gait is then the last gait found. */
int branch_follow(struct branch_gait *gait, double mass_ratio, double stiffness, double r0);

/* The gait of a walker at r0_m, in SI units. 1 found; 0 lost, *lost_r0_m (may be NULL) tells near where. */
int branch_find(enum branch branch, const struct walker_params *params, double r0_m, double x[3],
                double *lost_r0_m);

#endif
