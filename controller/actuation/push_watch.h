/* What became of each stance's push-off: given, or why not.
 *
 * A push-off is prescribed when a leg's stance begins while assistance may load its spring. It is given
 * when the latch was seen open between arming and the own foot's lift-off. If not, the first of these
 * was the reason:
 *   latch open    the latch did not report closed, so the spring could not be loaded at all
 *   not loaded    the spring was not at its target when the other foot landed
 *   not released  loaded and armed, but the latch did not open
 * A push that was given may still drag: the motor is not back when the foot is to be free in swing.
 * Misses in a row, of either leg, and drags in a row are counted too: the assistance is withdrawn after
 * PUSH_WATCH_MISSES (conditions.h).
 * A latch that tells whether it holds has to tell both in a stride that releases it. One that was loaded
 * and armed in so many strides in a row, and told the same all the time, is stuck, or its report is: what
 * depends on the report does not work then, and the other leg's pushes do not excuse it.
 *
 * One instance a walker; all zeros to begin with. Constant cost, some ten operations a call.
 */
#ifndef CONTROLLER_ACTUATION_PUSH_WATCH_H
#define CONTROLLER_ACTUATION_PUSH_WATCH_H

#include "controller/signals.h"

#define push_watch_begin REAL_SYMBOL(push_watch_begin)
#define push_watch_prescribe REAL_SYMBOL(push_watch_prescribe)
#define push_watch_tick REAL_SYMBOL(push_watch_tick)
#define push_watch_strike REAL_SYMBOL(push_watch_strike)
#define push_watch_end REAL_SYMBOL(push_watch_end)
#define push_watch_drag REAL_SYMBOL(push_watch_drag)

/* The values appear on the bus. */
enum push_outcome {
    PUSH_NONE = 0, /* none was prescribed */
    PUSH_GIVEN = 1,
    PUSH_LATCH_OPEN = 2,
    PUSH_NOT_LOADED = 3,
    PUSH_NOT_RELEASED = 4,
    PUSH_DRAGS = 5, /* given, and not over when the foot was to be free in swing */
    PUSH_OUTCOMES = 6
};

enum { PUSH_WATCH_MISSES = 3 };    /* pushes in a row that were not given, or that dragged */
enum { PUSH_WATCH_UNCHANGED = 3 }; /* releases of a leg in a row without a change of its latch */
enum { PUSH_WATCH_CLOSED = 1, PUSH_WATCH_OPEN = 2 };

struct push_leg {
    bool prescribed;               /* in this stance */
    bool waited;                   /* for the latch to close, and still does */
    bool armed;                    /* at some tick of it */
    bool full;                     /* its spring was at its target at some tick of it, */
    uint32_t full_tick;            /* the first of them */
    bool opened;                   /* the latch, while armed or after */
    bool struck;                   /* the other foot has landed */
    bool loaded;                   /* by then */
    bool dragged;                  /* since the last stance ended */
    uint8_t told;                  /* by the latch since then: bits of PUSH_WATCH_CLOSED, _OPEN */
    uint8_t unchanged_in_row;      /* releases that should have changed what it tells; saturates */
    uint8_t last;                  /* enum push_outcome of the last stance */
    uint32_t behind_ticks;         /* the motor was far behind its reference; saturates */
    uint32_t count[PUSH_OUTCOMES]; /* since the start; saturate */
};

struct push_watch {
    struct push_leg leg[SIDE_COUNT];
    uint8_t missed_in_row, dragged_in_row; /* saturating */
};

/* A walk begins: nothing is prescribed and nothing missed. What was counted stays. */
void push_watch_begin(struct push_watch *watch);

/* A stance begins whose push-off is prescribed. One that has no end yet ends now. */
void push_watch_prescribe(struct push_watch *watch, enum side side);

/* What a tick shows of a leg. */
struct push_view {
    bool full; /* the spring is at its target */
    bool armed;
    bool waits;  /* the spring is not loaded because the latch is not closed */
    bool behind; /* the motor is far behind its reference */
    enum latch_state latch;
};

/* Once a tick. */
void push_watch_tick(struct push_watch *watch, enum side side, const struct push_view *view,
                     uint32_t tick);

/* The other foot landed at strike_tick, which may be some ticks ago. */
void push_watch_strike(struct push_watch *watch, enum side side, uint32_t strike_tick);

/* The spring pushes at a foot in swing. True when that is new in this swing. */
bool push_watch_drag(struct push_watch *watch, enum side side);

/* Whether so many pushes in a row were not given, or dragged, that the assistance is to end. */
static inline bool push_watch_fails(const struct push_watch *watch)
{
    return watch->missed_in_row >= PUSH_WATCH_MISSES || watch->dragged_in_row >= PUSH_WATCH_MISSES;
}

/* Whether this leg's latch, which tells of itself, did not change in PUSH_WATCH_UNCHANGED releases. */
static inline bool push_watch_latch_is_stuck(const struct push_watch *watch, enum side side)
{
    return watch->leg[side].unchanged_in_row >= PUSH_WATCH_UNCHANGED;
}

/* The stance is over. Returns what became of its push-off, PUSH_NONE where none was prescribed. */
enum push_outcome push_watch_end(struct push_watch *watch, enum side side);

#endif
