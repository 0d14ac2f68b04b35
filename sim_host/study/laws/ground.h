/* Mean steps to failure on uneven ground by the transfer operator (Byl, Tedrake 2009: Metastable walking machines).
 *
 * Apex states are gathered into cells as they are reached, with one representative a cell. Every cell's
 * transitions under the distribution of the ground make a sparse stochastic matrix, with "fallen" as its
 * absorbing state. The quasi-stationary distribution gives the chance to fall per step.
 */
#ifndef SIM_HOST_STUDY_LAWS_GROUND_H
#define SIM_HOST_STUDY_LAWS_GROUND_H

#include "sim_host/study/laws/laws.h"

struct ground_operator_result {
    double mean_steps; /* to failure, from the gait on; INFINITY if no cell fails */
    double
        settled_steps; /* the same for one who has long been walking: 1 / the chance to fall per step */
    int cells;
    bool full; /* more cells were reached than there is room for: the result is a guess */
};

/* Evaluates the law at the gait of speed_rad_s. The law learns nothing from step to step: each answer is that of
 * a fresh law at that cell. Rises are uniform within +- rise_most leg lengths: heights, or else the incline that
 * rises so much on a step of step_share leg lengths. Returns 0, or -1 without memory. */
int ground_operator(const struct law_setup *setup, double speed_rad_s, double rise_most,
                    double step_share, bool heights, struct ground_operator_result *result);

/* What one rise does to a steady gait, the push-off being chosen before it is met. */
struct ground_rise {
    double climbed;    /* v^2 l / (2 g), leg lengths: what the apex' energy climbs by itself */
    double own_push;   /* largest rise survived by the gait's own push-off, leg lengths */
    double any_push;   /* by the best push-off of all (every one of a fine grid tried) */
    double any_push_m; /* that push-off */
    double
        level_speed; /* the next apex speed it leads to on level ground, rad/s; 0: it falls there */
};

/* By bisection on the map; survival is taken to end once as the rise grows. */
void ground_rise_survived(const struct law_setup *setup, double speed_rad_s,
                          struct ground_rise *rise);

#endif
