/* The independent watchdog, and the gate that decides when to feed it.
 *
 * A watchdog that any activity feeds protects nothing. The gate collects signs
 * of progress and lets one feed through only when every one of them has been
 * seen since the last feed.
 */
#ifndef HAL_WATCHDOG_H
#define HAL_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

/* Signs of progress: bits, as the control task reports them. */
enum watchdog_progress {
    WATCHDOG_CONTROL = 1 << 0,    /* the bus took the commands of a tick */
    WATCHDOG_BUS = 1 << 1,        /* the own SYNC was seen on the bus */
    WATCHDOG_SUPERVISOR = 1 << 2, /* the supervisor judged that very tick */
    WATCHDOG_ALL = WATCHDOG_CONTROL | WATCHDOG_BUS | WATCHDOG_SUPERVISOR
};

struct watchdog_ops {
    /* Restarts the time-out. Loop only; never blocks; O(1). */
    void (*feed)(void *context);
};

struct watchdog {
    const struct watchdog_ops *ops;
    void *context;
};

struct watchdog_gate {
    const struct watchdog *watchdog;
    uint32_t seen;  /* bits of enum watchdog_progress since the last feed */
    uint32_t feeds; /* saturates */
};

/* Prepares a gate in front of *watchdog, which the caller keeps alive. */
static inline void watchdog_gate_init(struct watchdog_gate *gate, const struct watchdog *watchdog)
{
    gate->watchdog = watchdog;
    gate->seen = 0;
    gate->feeds = 0;
}

/* Adds the bits of `progress`; feeds the watchdog and starts afresh when all
 * bits of WATCHDOG_ALL are together. Unknown bits are ignored. Returns true
 * when it fed. Loop only; O(1). */
static inline bool watchdog_gate_report(struct watchdog_gate *gate, uint32_t progress)
{
    gate->seen |= progress & (uint32_t)WATCHDOG_ALL;
    if (gate->seen != (uint32_t)WATCHDOG_ALL) {
        return false;
    }
    gate->seen = 0;
    if (gate->feeds < UINT32_MAX) {
        gate->feeds++;
    }
    gate->watchdog->ops->feed(gate->watchdog->context);
    return true;
}

#endif
