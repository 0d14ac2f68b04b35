/* Steady gaits of a walker whose latch opens a known time after heel strike.
 *
 * The trailing ankle extends by itself until the spring is released, so a push-off of r0 gives less than
 * one in time. The laws' tables of such a walker are made from these gaits: then eq. (16) and the gains ask
 * for what the late push-off needs. Nothing is released earlier.
 * Computed in double whatever the caller is compiled for; plain doubles. The same bits everywhere.
 */
#ifndef SIM_HOST_GAIT_LATE_GAIT_H
#define SIM_HOST_GAIT_LATE_GAIT_H

#include "sim_host/gait/gait_curve.h"

/* Longest delay served, s. With a longer one no gain of eq. (16) holds the paper's walker's gaits. */
#define LATE_GAIT_MOST_S 0.025

/* gait_curve() for the release delay_s, 0..LATE_GAIT_MOST_S, after heel strike; beyond that
 * GAIT_CURVE_BAD_WALKER. A single point at which the map jumps, because a slow ankle comes back before its
 * spring is released, is bridged. About 10 ms a point; delay_s 0: gait_curve() itself. */
enum gait_curve_error late_gait_curve(const struct gait_walker *walker, double delay_s,
                                      double r0_min_m, double r0_step_m, int count,
                                      struct gait_point *points, int *reached);

#endif
