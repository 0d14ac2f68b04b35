/* Many walks under the controller's laws at once.
 *
 * The laws run as in the device: in float, one after the other. The map between their answers runs on the batch
 * engine, many walkers side by side. A walk's strides are those of laws_walk_step() at LAWS_FINE, to the engine's
 * accuracy. They depend on that walk alone, not on the other walks or the number of threads.
 */
#ifndef SIM_HOST_STUDY_LAWS_WALKS_H
#define SIM_HOST_STUDY_LAWS_WALKS_H

#include <stddef.h>

#include "sim_host/study/laws/setup.h"

/* What lies ahead of one walk's next stride. */
struct laws_ahead {
    double desired_rad_s;   /* the speed wanted of it */
    double seen[3];         /* the apex that the law is told; in: the true one */
    double slope_rad, rise; /* of the ground, as for laws_stride(); in: level */
};

/* Says what lies ahead of walk i. Called from several threads, for each walk in the order of its strides. */
typedef void laws_look(void *context, size_t i, struct laws_ahead *ahead);

/* Assesses walk i after a stride. It fell where walk->stride.fault is not 0; walk->apex is then the last one
 * before. Called as laws_look is. Returns 0 to go on, else the walk is done. */
typedef int laws_assess(void *context, size_t i, const struct laws_walk *walk);

struct laws_course {
    const struct law_setup *setup; /* its accuracy is not asked for */
    struct laws_walk walk;         /* in: started by laws_walk_start(); out: where it ended */
};

/* Walks every course until it falls, `assess` ends it, or `strides` strides, on `threads` cores (0: all).
 * stride.double_support_s stays 0. Returns 0, or -1 after a message (no memory, or a walker out of range).
 * Cost: a microsecond a stride and the law's answer, 0.1 ms with the predictive law. */
int laws_walks_run(struct laws_course *courses, size_t count, int strides, laws_look *look,
                   laws_assess *assess, void *context, int threads);

#endif
