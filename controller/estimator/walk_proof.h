/* Is it walking, and forwards? Shown step by step from the foot switches, not assumed.
 *
 * In a step of forward walking one foot leaves the ground while the other stands. Over the standing
 * foot the hip goes on, so its leg turns back. The other foot lands ahead of it, and then both feet
 * are on the ground for a while (double support). Each of these parts is looked for:
 *   - running has flight: a foot lands, or leaves, with the other in the air;
 *   - backwards the standing leg turns forwards;
 *   - on the spot it does not turn, and the foot that lands is not ahead;
 *   - who rocks or scissors on both feet has no step at all;
 *   - in a harness no foot ever lands.
 * Switches have a bias of up to some ten milliseconds each way: limits of time allow for it.
 *
 * One instance a walker. Constant cost, tens of operations a tick.
 */
#ifndef CONTROLLER_ESTIMATOR_WALK_PROOF_H
#define CONTROLLER_ESTIMATOR_WALK_PROOF_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/signals.h"

#define walk_proof_update REAL_SYMBOL(walk_proof_update)

struct foot_history {
    enum foot_contact contact; /* without bounce */
    uint16_t other_ticks;      /* so long the switch has said something else */
    uint32_t since_tick;       /* of `contact`; 0 = not seen to begin */
    uint32_t raw_up_tick;      /* the switch itself opened here, */
    uint32_t raw_edge_tick;    /* and closed here, having been open for long enough; 0 = never */
    bool raw_up;
};

struct walk_proof { /* all zeros to begin with */
    struct foot_history foot[SIDE_COUNT];
    real single_from_rad[SIDE_COUNT]; /* the standing leg's angle as the other foot left */
    bool single[SIDE_COUNT];          /* that was seen */
    uint32_t steps;                   /* forward steps in a row, saturating */
};

enum walk_sign {
    WALK_NOTHING_NEW = 0,
    WALK_STEP_SHOWN = 1,  /* a forward step has ended */
    WALK_STEP_DENIED = 2, /* what has just happened does not happen in forward walking */
    WALK_FOOT_CHANGED = 3 /* a foot left, as it should */
};

/* One tick: the switches' values and both legs' angles. Returns what is new. */
enum walk_sign walk_proof_update(struct walk_proof *proof, const enum foot_contact foot[SIDE_COUNT],
                                 const real angle_rad[SIDE_COUNT], uint32_t tick);

#endif
