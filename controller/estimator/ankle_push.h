/* How fast a person's ankle extends, and when its push-off is over.
 *
 * A foot leaves the ground between the steepest extension of its ankle and the full one.
 * By then the calf's push is spent. The mark is where the rate has fallen to half of its
 * peak: in noise a slope is easier to place than an extremum. Lengths are ratios to the
 * leg's length, so that rates compare with the leg's.
 *
 * The rate comes from a second-order tracking filter, critically damped (Benedict &
 * Bordner 1962), of 5 ms: eight bytes instead of a history.
 */
#ifndef CONTROLLER_ESTIMATOR_ANKLE_PUSH_H
#define CONTROLLER_ESTIMATOR_ANKLE_PUSH_H

#include <stdbool.h>
#include <stdint.h>

#include "model/real.h"

#define ankle_push_update REAL_SYMBOL(ankle_push_update)
#define ankle_push_under_way REAL_SYMBOL(ankle_push_under_way)

/* What the filter's rate lags behind the ankle's. */
#define ANKLE_PUSH_LAG_S REAL(0.01)

struct ankle_push { /* all zeros to begin with */
    real extension; /* filtered, over the leg's length */
    real rate_1_s;
    real peak_1_s;      /* highest rate of this push; 0 = none */
    uint32_t over_tick; /* at which the rate had fallen to half of that, if `over` */
    bool over;
};

/* One tick. extension: ankle extension over leg length, taken only when `fresh`, else
 * the last rate goes on. may_push: the leg is behind the other, its foot not yet
 * known to have left the ground; otherwise the push is forgotten.
 * least_1_s: a peak below it is no push, > 0. About 20 operations. */
void ankle_push_update(struct ankle_push *push, real extension, bool fresh, bool may_push,
                       real least_1_s, uint32_t tick);

/* A push that is not over yet. */
bool ankle_push_under_way(const struct ankle_push *push, real least_1_s);

#endif
