/* The set of states from which some sequence of push-offs keeps a walker up, found on a grid.
 *
 * After heel strike two numbers are left of a walker's state: the angle between its legs, and the rate at which
 * the ankle begins to extend. All that follows until the next heel strike is a function of them and of r0. So
 * the states lie in a plane. Wanted is the largest set of states each of which has a push-off that leads back
 * into the set (Aubin's viability kernel). The search removes states that have none, until nothing changes.
 *
 * The grid gives two bounds. OUTER, in cells: a push-off makes a box of the images of a cell's corners, and the
 * cell stays while some such box meets a cell that stays. What leaves the grid stays. INNER, in nodes: a node stays
 * while some push-off leads it into a cell whose corners all stay. The true set lies between. A finer grid
 * brings the bounds together.
 *
 * Plain doubles, SI units. The same bits for any number of threads.
 */
#ifndef SIM_HOST_STUDY_MAP_VIABILITY_KERNEL_H
#define SIM_HOST_STUDY_MAP_VIABILITY_KERNEL_H

#include <stdbool.h>

#include "sim_host/gait/gait_curve.h"

/* Between legs (rad, spaced by ratio), ankle rate over (angle times sqrt(g l)) (spaced evenly). */
struct viability_state {
    double legs_rad, rate;
};

struct viability_range {
    double legs_low_rad, legs_high_rad; /* above 0 */
    double rate_low, rate_high;         /* from 0 on */
    double r0_low_m, r0_high_m;         /* above 0; spaced by ratio */
    int legs, rates, pushes;            /* number of each, at least 2 */
};

/* What one push-off at a node leads to. */
struct viability_image {
    float log_legs; /* VIABILITY_NO_IMAGE: the stride ends in a fault */
    float rate;
};
#define VIABILITY_NO_IMAGE 1e9f

struct viability_grid {
    struct gait_walker walker;
    struct viability_range range;
    struct viability_image
        *image; /* [node * pushes + push], node = legs index * rates + rate index */
    int nodes;
};

/* Computes the grid's images on `threads` cores: about a microsecond each. Returns 0, or -1 without memory. Release with
 * viability_free(). */
int viability_make(struct viability_grid *grid, const struct gait_walker *walker,
                   const struct viability_range *range, int threads);
void viability_free(struct viability_grid *grid);

/* The state after the heel strike that follows an apex; false when there is none. */
bool viability_after_apex(const struct gait_walker *walker, const double apex[3],
                          struct viability_state *state);

enum viability_side { VIABILITY_OUTER, VIABILITY_INNER };

/* Finds the largest set whose push-offs lead back into it: of cells (outer; numbered by their lower corner's
 * node), or of nodes (inner). set[nodes] receives 1 or 0. Returns the number of rounds until nothing changed,
 * 0 without memory. */
int viability_kernel(const struct viability_grid *grid, enum viability_side side,
                     unsigned char *set);

/* Whether a state lies in a set of that side. What lies beyond the grid is in the outer ones. */
bool viability_has(const struct viability_grid *grid, enum viability_side side,
                   const unsigned char *set, const struct viability_state *state);

#endif
