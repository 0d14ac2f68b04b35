/* Are a person's sensors and latches where they belong? Shown while the person walks, before the first push.
 *
 * The foot switches are the reference, and physics is the limit. No number here was fitted to anybody:
 *   - A planted foot stays where it is while the hip goes on, so the leg that stands alone turns back, and the
 *     leg in the air turns forwards. A sensor that says otherwise, step after step, is mounted backwards, is
 *     the other leg's, or the person walks backwards: then there is nothing to assist, either.
 *   - A foot pushes off: as it leaves, its ankle is extended further than in the rest of its stance. One that
 *     was extended further before is the other leg's, or mounted backwards. Where the device pushes it may
 *     extend earlier, and a late switch sees it leave with its toes up again: such a stance says nothing.
 *   - An ankle that keeps one value through a stance, while the other one moves, is stuck; so are both that
 *     never moved in full steps.
 *   - The contact that is wired to a latch is the other foot's. A latch that says otherwise is on the wrong
 *     leg, with its drive, or its wire is broken.
 * All but the last is looked at when a foot lands or leaves, not in every tick.
 */
#ifndef CONTROLLER_ESTIMATOR_PLACEMENT_H
#define CONTROLLER_ESTIMATOR_PLACEMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/signals.h"

#define placement_edges REAL_SYMBOL(placement_edges)
#define placement_wires REAL_SYMBOL(placement_wires)
#define placement_found REAL_SYMBOL(placement_found)

/* What may be found, a bit for the left leg; the right one's is the next. The values appear on the bus. */
enum placement_finding {
    PLACEMENT_ANGLE = 1 << 0, /* the leg turns the wrong way for its foot */
    PLACEMENT_STUCK = 1 << 2, /* the ankle does not move, the other does, or neither */
    PLACEMENT_ANKLE = 1 << 4, /* the ankle extends at the wrong time for its foot */
    PLACEMENT_WIRE = 1 << 6   /* the contact at the latch is not the other foot's */
};

enum {
    PLACEMENT_STEPS = 5,   /* a leg turned the wrong way in so many steps in a row */
    PLACEMENT_STANCES = 3, /* an ankle was wrong in so many stances in a row */
    PLACEMENT_WIRE_TICKS = TICKS_OF_MS(150)
};

struct placement_leg {
    real from_rad;               /* as the foot in the air left */
    real turned_rad;             /* backwards, in its last single support */
    real low_m, high_m;          /* extension at the instants of this stance so far, */
    uint8_t instants;            /* and how many these are; 0 = its landing was not seen */
    uint8_t turns, stuck, early; /* what was wrong in a row, saturating */
    bool pushed; /* the spring was let go in this stance: how the ankle moves is its doing */
    uint16_t wire_ticks; /* the latch has contradicted the other foot for so long */
};

struct placement { /* all zeros to begin with */
    struct placement_leg leg[SIDE_COUNT];
    real moved_m[SIDE_COUNT]; /* the largest range of the ankle in a stance so far */
    bool single[SIDE_COUNT];  /* the other foot was seen to leave */
};

/* What happened to the feet in a tick. */
struct placement_view {
    bool lands[SIDE_COUNT], leaves[SIDE_COUNT];
    real angle_rad[SIDE_COUNT], extension_m[SIDE_COUNT];
};

/* A foot has landed or left. Constant cost, some 60 operations. */
void placement_edges(struct placement *placement, const struct placement_view *view);

/* Once a tick: what each foot's switch says, against what the other leg's latch hears of it, and whether the latch is
 * open. What is unknown contradicts nothing. Some 12 operations. */
void placement_wires(struct placement *placement, const struct controller_input *input);

/* Bits of enum placement_finding, 0 without. Pure. */
uint8_t placement_found(const struct placement *placement);

#endif
