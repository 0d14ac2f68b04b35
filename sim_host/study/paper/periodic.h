/* Finding walks of a period above one at given parameters. */
#ifndef SIM_HOST_STUDY_PAPER_PERIODIC_H
#define SIM_HOST_STUDY_PAPER_PERIODIC_H

#include "sim_host/gait/orbit.h"

/* From a prepared problem of period 1 with its gait at x: finds a walk of exactly `period` strides.
 * First by walking until the walk settles and looking for near-returns, then, for powers of two, by
 * following the cascade of doublings from r0 = 0.05 and from 0.3 leg lengths.
 * 1 found: *problem has the period, *orbit the walk, evaluated. 0: none found. */
int periodic_find(struct problem *problem, const double x[3], int period, struct orbit *orbit);

/* Walks `strides` strides from x (changed on the way); 0 when the walker falls. */
int periodic_walk(const struct problem *problem, int strides, double x[3]);

/* Leaves the gait x along its most unstable direction by `size`, so that a long run shows where walks go. */
void periodic_push_off_gait(const struct problem *problem, double size, double x[3]);

#endif
