/* What became of each stance's push-off: given, or why not.
 *
 * A push-off is prescribed when a leg's stance begins while assistance may load its spring. It is given
 * when the latch was seen open between arming and the own foot's lift-off. If not, the first of these
 * was the reason:
 *   latch open    the latch did not report closed, so the spring could not be loaded at all
 *   not loaded    the spring was not at its target when the other foot landed: the latch was not armed
 *   not released  loaded and armed, but the latch did not open
 * Misses in a row, of either leg, are counted too: the assistance is withdrawn after
 * PUSH_WATCH_MISSES (conditions.h).
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

/* The values appear on the bus. */
enum push_outcome {
    PUSH_NONE = 0, /* none was prescribed */
    PUSH_GIVEN = 1,
    PUSH_LATCH_OPEN = 2,
    PUSH_NOT_LOADED = 3,
    PUSH_NOT_RELEASED = 4,
    PUSH_OUTCOMES = 5
};

enum { PUSH_WATCH_MISSES = 3 }; /* pushes in a row that were prescribed and not given */

struct push_leg {
    bool prescribed;               /* in this stance */
    bool waited;                   /* for the latch to close, and still does */
    bool armed;                    /* at some tick of it */
    bool opened;                   /* the latch, while armed or after */
    bool struck;                   /* the other foot has landed */
    bool loaded;                   /* when it did */
    uint8_t last;                  /* enum push_outcome of the last stance */
    uint32_t behind_ticks;         /* the motor was far behind its reference; saturates */
    uint32_t count[PUSH_OUTCOMES]; /* since the start; saturate */
};

struct push_watch {
    struct push_leg leg[SIDE_COUNT];
    uint8_t missed_in_row; /* saturating */
};

/* A walk begins: nothing is prescribed and nothing missed. What was counted stays. */
void push_watch_begin(struct push_watch *watch);

/* A stance begins whose push-off is prescribed. One that has no end yet ends now. */
void push_watch_prescribe(struct push_watch *watch, enum side side);

/* Once a tick: whether this leg is armed, its latch, and whether its motor is far behind. waits: the
 * spring is not loaded because the latch is not closed. */
void push_watch_tick(struct push_watch *watch, enum side side, bool armed, bool waits, bool behind,
                     enum latch_state latch);

/* The other foot has landed: loaded says whether this leg's spring is at its target. */
void push_watch_strike(struct push_watch *watch, enum side side, bool loaded);

/* The stance is over. Returns what became of its push-off, PUSH_NONE where none was prescribed. */
enum push_outcome push_watch_end(struct push_watch *watch, enum side side);

#endif
