/* Time and the tick as the mains see them: a table of functions and a context.
 *
 * model/ and controller/ never read a clock (time is an argument there); the
 * mains do, to send a SYNC at every period and to stamp records.
 */
#ifndef HAL_CLOCK_H
#define HAL_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

struct clock_ops {
    /* Time since start, ns, never decreasing. Loop or ISR; O(1). */
    uint64_t (*now_ns)(void *context);

    /* Takes one elapsed tick period (TICK_PERIOD_US) from the port's count:
     * true once per period that ended, false when none is left. Periods that
     * nobody took are kept (see missed_ticks), so the mean rate is exact; only
     * those that ended while interrupts were held up are not made up for.
     * Loop only; never blocks; O(1). */
    bool (*take_tick)(void *context);

    /* Periods that ended while an earlier one still waited, in the port or for
     * its interrupt, since start; saturates. A healthy loop shows 0. Loop only; O(1). */
    uint32_t (*missed_ticks)(void *context);
};

struct clock {
    const struct clock_ops *ops;
    void *context;
};

static inline uint64_t clock_now_ns(const struct clock *clock)
{
    return clock->ops->now_ns(clock->context);
}

static inline bool clock_take_tick(const struct clock *clock)
{
    return clock->ops->take_tick(clock->context);
}

static inline uint32_t clock_missed_ticks(const struct clock *clock)
{
    return clock->ops->missed_ticks(clock->context);
}

#endif
