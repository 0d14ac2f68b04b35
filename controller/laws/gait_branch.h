/* What the laws know of their walker from the start: its steady gaits by speed, the cost of
 * returning to each, and the gains that do it.
 *
 * One entry per forward apex speed, equally spaced, on the long-period branch. Per entry: the gait
 * (push-off and apex state), the infinite-horizon quadratic cost of the return map linearised there
 * (Riccati solution), and two feedback gains on the apex state. Made in double by
 * sim_host/gait/laws_table from the model, for any walker.
 *
 * Costs are in (rad/s)^2 of the paper's walker's time, so that the same weights serve every size.
 */
#ifndef CONTROLLER_LAWS_GAIT_BRANCH_H
#define CONTROLLER_LAWS_GAIT_BRANCH_H

#include <stdint.h>

#include "model/stride.h"

#define gait_branch_check REAL_SYMBOL(gait_branch_check)
#define gait_branch_at REAL_SYMBOL(gait_branch_at)
#define gait_branch_departure REAL_SYMBOL(gait_branch_departure)
#define gait_branch_cost REAL_SYMBOL(gait_branch_cost)
#define gait_branch_distance REAL_SYMBOL(gait_branch_distance)

enum { GAIT_BRANCH_MAX = 40, GAIT_BRANCH_MIN = 4, GAIT_BRANCH_COSTS = 6 };

struct gait_branch_point {
    real r0_m;
    real swing_angle_rad;
    real swing_rate_rad_s;
    /* Riccati solution P, symmetric, of the departures of (stance rate, swing angle, swing rate):
     * 11, 22, 33, then the sums 12+21, 13+31, 23+32. */
    real cost[GAIT_BRANCH_COSTS];
    real lqr_gain[3];      /* r0 = r0* - gain . departure, least quadratic cost */
    real deadbeat_gain[3]; /* the same form; all eigenvalues of the closed map zero */
};

struct gait_branch {
    uint32_t count; /* GAIT_BRANCH_MIN..GAIT_BRANCH_MAX used entries; 0 = no table: eq. (16) only */
    real speed_min_rad_s;
    real speed_step_rad_s;
    real r0_weight;     /* cost of a push-off away from the gait's own, per m^2 */
    real travel_weight; /* cost per rad/s of still having to travel along the branch */
    struct gait_branch_point point[GAIT_BRANCH_MAX];
};

/* 1 when the table may be used: grid positive and finite, entries finite, r0 rising. One pass. */
int gait_branch_check(const struct gait_branch *branch);

/* The gait at a speed between the ends (clamped to them): the gait itself by a cubic through four
 * neighbours, cost and gains linearly. Returns the speed after clamping. Precondition: checked.
 * Constant cost, about 200 operations. */
real gait_branch_at(const struct gait_branch *branch, real speed_rad_s,
                    struct gait_branch_point *gait);

/* Departure of an apex from the gait of that speed, in the order of the gains. */
void gait_branch_departure(const struct gait_branch_point *gait, real speed_rad_s,
                           const struct apex *apex, real departure[3]);

/* Cost to go from an apex to the gait by the linearised map, with r0_m the push-off that led there. */
real gait_branch_cost(const struct gait_branch *branch, const struct gait_branch_point *gait,
                      real speed_rad_s, const struct apex *apex, real r0_m);

/* Cost to go to the target gait by way of the branch: to the gait that is cheapest to reach now, and
 * from there along the branch:  min over s of  cost_s(apex) + travel_weight |v* - v_s|.
 * So a far target is approached along the branch, only as fast as its gaits still catch the walker,
 * and a near one is reached directly. *target is the interpolated gait at v*.
 * Cost: about 20 operations an entry. */
real gait_branch_distance(const struct gait_branch *branch, const struct gait_branch_point *target,
                          real target_speed_rad_s, const struct apex *apex, real r0_m);

#endif
