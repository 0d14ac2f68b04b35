/* The wearer's own say: a button that pauses and stops, and a cue of what comes.
 *
 *   a press        pauses: the pushes become smaller over WEARER_FADE_STEPS steps, then the assistance ends
 *   a second one   while they become smaller: it ends at once. In a pause: it goes on, behind steady steps anew
 *   held for 1.5 s stops at once; it takes a new request of the operator to go on
 * A button that hangs is held. The emergency stop is another one. What the operator asked for stays asked
 * for in a pause, and ends it when it is taken back.
 * A request that no step follows within WEARER_WAIT_TICKS is given up, too.
 *
 * One instance a walker; all zeros to begin with. Constant cost, some 10 operations a call.
 */
#ifndef CONTROLLER_SUPERVISOR_WEARER_H
#define CONTROLLER_SUPERVISOR_WEARER_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/supervisor/supervisor.h"
#include "model/tick.h"

#define wearer_update REAL_SYMBOL(wearer_update)
#define wearer_end_step REAL_SYMBOL(wearer_end_step)
#define wearer_allows REAL_SYMBOL(wearer_allows)

enum {
    WEARER_PRESS_TICKS = TICKS_OF_MS(30), /* shorter is bounce */
    WEARER_HOLD_TICKS = TICKS_OF_MS(1500),
    WEARER_FADE_STEPS = 3,
    WEARER_FADE_TICKS = TICKS_OF_MS(4000), /* and no longer than that */
    WEARER_WAIT_TICKS = TICKS_OF_MS(60000)
};

/* The values appear on the bus. */
enum wearer_cue {
    WEARER_CUE_NONE = 0,
    WEARER_CUE_SOON = 1, /* the next steps will be assisted: the light is on */
    WEARER_CUE_ASSISTS = 2,
    WEARER_CUE_FADES = 3, /* the wearer has asked for an end: the light is on */
    WEARER_CUE_PAUSED = 4
};

struct wearer {
    uint16_t pressed_ticks; /* saturating */
    uint16_t fade_ticks;    /* the pushes have become smaller for so long */
    uint16_t wait_ticks;    /* ready, and asked for, for so long */
    uint8_t fade_steps;     /* until the end; 0 = they do not become smaller */
    bool paused;
    bool stopped;
};

/* Once a tick. pressed: the button. requested: by the operator, and not spent. fades: there are pushes
 * that may become smaller, else a press pauses at once. */
void wearer_update(struct wearer *wearer, bool pressed, bool requested, enum supervisor_state state,
                   bool fades);

/* A step has ended. Returns what part of their size the pushes have from now on, 0..1. */
real wearer_end_step(struct wearer *wearer);

/* Nothing of the wearer's forbids the assistance. Pure. */
bool wearer_allows(const struct wearer *wearer);

#endif
