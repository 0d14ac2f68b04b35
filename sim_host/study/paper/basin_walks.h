/* What becomes of many starts: each walks until it is at its gait, falls, or has walked long enough.
 *
 * On the batch engine, many at a time; a start's outcome depends on that start alone. */
#ifndef SIM_HOST_STUDY_PAPER_BASIN_WALKS_H
#define SIM_HOST_STUDY_PAPER_BASIN_WALKS_H

#include <stddef.h>

#include "sim_host/gait/orbit.h"

enum basin_outcome { BASIN_FALLS = 0, BASIN_CONVERGES = 1, BASIN_WALKS_ON = 2, BASIN_OUTCOMES = 3 };

#define BASIN_NEAR 1e-4 /* this near to the gait (rad, rad/s) counts as there */

struct basin_start {
    const struct problem *problem; /* prepared; all of one walker, r0 and law of each */
    const double *gait;            /* its three numbers */
    double x[3];                   /* stance rate, swing angle, swing rate */
};

struct basin_end {
    enum basin_outcome outcome;
    int strides; /* whole ones until then */
    enum stride_fault fault;
};

/* Runs `count` >= 1 starts in the calling thread, at most `strides` strides each. Allocates 300 bytes a start while it
 * runs. Returns 0, or -1 without memory. Cost: about a microsecond a stride. */
int basin_walks(const struct basin_start *starts, size_t count, int strides,
                struct basin_end *ends);

#endif
