#include "controller/estimator/ankle_push.h"

#include "controller/signals.h"

/* 1 - e^(-2 h) and (1 - e^(-h))^2 / period for h = period / 5 ms. */
#define EXTENSION_GAIN REAL(0.32968)
#define RATE_GAIN_1_S REAL(32.859)

#define OVER_RATIO REAL(0.5)

/* Extended by less than this (4 mm on a 0.9 m leg), a foot is flat on the ground. */
#define EXTENDED REAL(0.0044)

void ankle_push_update(struct ankle_push *push, real extension, bool fresh, bool may_push,
                       real least_1_s, uint32_t tick)
{
    push->extension += CONTROL_PERIOD_S * push->rate_1_s;
    if (fresh) {
        const real off = extension - push->extension;
        push->extension += EXTENSION_GAIN * off;
        push->rate_1_s += RATE_GAIN_1_S * off;
    }
    if (!may_push) {
        push->peak_1_s = REAL(0.0);
        push->over = false;
    } else if (push->rate_1_s > push->peak_1_s) {
        push->peak_1_s = push->rate_1_s;
        push->over = false;
    } else if (!push->over && push->peak_1_s > least_1_s && push->extension > EXTENDED &&
               push->rate_1_s < OVER_RATIO * push->peak_1_s) {
        push->over = true;
        push->over_tick = tick;
    }
}

bool ankle_push_under_way(const struct ankle_push *push, real least_1_s)
{
    return !push->over && push->peak_1_s > least_1_s;
}
