/* The stride's clock: how long strides last, and how much of its stride each leg has gone by.
 *
 * A stride goes from a heel strike to the next one of the same leg. Both legs go at one pace, so
 * one running mean of the stride time serves both.
 */
#ifndef CONTROLLER_ESTIMATOR_STRIDE_CLOCK_H
#define CONTROLLER_ESTIMATOR_STRIDE_CLOCK_H

#include "controller/signals.h"

#define stride_clock_strike REAL_SYMBOL(stride_clock_strike)
#define stride_clock_shares REAL_SYMBOL(stride_clock_shares)

struct stride_clock { /* all zeros to begin with */
    struct {
        uint32_t strike_tick; /* of the newest heel strike */
        real strike_before_s; /* it lies this long before that tick */
        bool started;
    } leg[SIDE_COUNT];
    real stride_s; /* running mean of both legs' stride times; 0 = none measured yet */
};

/* A heel strike: a stride of that leg has ended, the next begins. Constant cost. */
void stride_clock_strike(struct stride_clock *clock, const struct gait_event *strike);

/* Per leg the part of its stride gone by since its heel strike, 0..1; -1 = not known. Constant
 * cost: two divisions. */
void stride_clock_shares(const struct stride_clock *clock, uint32_t tick, real share[SIDE_COUNT]);

#endif
