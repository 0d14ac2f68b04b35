/* Mounting offsets of the leg sensors, from quiet standing.
 *
 * A person who stands still on both feet, side by side, has both legs vertical and both ankles
 * not extended. What the sensors read then is their mounting error. The person stands for
 * ZEROING_S. If they move, or a reading is further from zero than a mounting error can be,
 * nothing is changed and the state says why. A body that leans looks like the same offset of
 * both sensors: stand as upright as you walk.
 */
#ifndef CONTROLLER_SCREENING_ZEROING_H
#define CONTROLLER_SCREENING_ZEROING_H

#include "controller/signals.h"

#define zeroing_start REAL_SYMBOL(zeroing_start)
#define zeroing_update REAL_SYMBOL(zeroing_update)
#define zeroing_stop REAL_SYMBOL(zeroing_stop)

#define ZEROING_S REAL(3.0)

/* The values appear on the bus and in logs. */
enum zeroing_state {
    ZEROING_IDLE = 0,
    ZEROING_RUNNING = 1,
    ZEROING_DONE = 2,     /* mean holds the new offsets */
    ZEROING_MOVED = 3,    /* refused: the legs were not still */
    ZEROING_TOO_FAR = 4,  /* refused: no mounting is so far off */
    ZEROING_NO_SAMPLE = 5 /* refused: a sample was missing or not finite for too long */
};

/* What the sensors read where they should read zero. */
struct zero_offsets {
    real angle_rad[SIDE_COUNT];
    real ankle_m[SIDE_COUNT];
};

struct zeroing {
    enum zeroing_state state;
    uint32_t samples, missing;
    struct zero_offsets mean; /* of the samples so far */
    real least_rad[SIDE_COUNT], greatest_rad[SIDE_COUNT];
};

/* Begins to collect, from nothing. */
void zeroing_start(struct zeroing *zeroing);

/* One tick's raw legs (no offset taken off). While not running, nothing happens.
 * Constant cost. */
void zeroing_update(struct zeroing *zeroing, const struct leg_measurement *leg);

/* Gives up a run as ZEROING_MOVED; nothing else is changed. */
void zeroing_stop(struct zeroing *zeroing);

#endif
