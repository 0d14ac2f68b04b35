/* The last samples of both legs' angles, by tick. */
#ifndef CONTROLLER_ESTIMATOR_ANGLE_HISTORY_H
#define CONTROLLER_ESTIMATOR_ANGLE_HISTORY_H

#include "controller/signals.h"

enum { GAIT_HISTORY = 256 }; /* samples a leg; a power of two >= 2 * window + 1 */

struct angle_history {
    real angle_rad[SIDE_COUNT][GAIT_HISTORY]; /* indexed by tick modulo GAIT_HISTORY */
};

/* The angle of one leg at `tick`, one of the last GAIT_HISTORY. */
static inline real angle_history_at(const struct angle_history *history, int side, uint32_t tick)
{
    return history->angle_rad[side][tick % GAIT_HISTORY];
}

#endif
