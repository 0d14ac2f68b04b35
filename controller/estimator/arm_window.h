/* When a person's latch may be armed: from just before the other foot lands until any sign that the
 * own foot has left the ground.
 *
 * The latch's node opens on two signs: this window, and a contact edge of the other foot that is wired
 * to it. The window alone must not lead by much, in case that the edge is false. So it opens at a time
 * that is learned: the swing leg's slowing (person_events.h: landing) comes before the foot's contact
 * by about the same time in every step of a leg, whatever that time is. It opens ARM_LEAD_S before the
 * mean of it. The window ends with any of:
 *   - the own foot's switch opens, or is not heard;
 *   - the own leg turns back no faster than a third of the walking speed: its foot rolls off;
 *   - the own toe-off, found from the legs' angles;
 *   - the other foot landed longer than ARM_BEHIND_S ago;
 *   - no contact came, ARM_LATE_S behind its mean.
 * And it does not open where the own leg's newest double support was shorter than ARM_SUPPORT_LEAST_S: a foot
 * that leaves so soon is gone before its push is over. It counts as short where the legs' angles and the
 * switches both say so: either may be wrong by half of it.
 * Without foot switches no lag is learned. The window then opens a stated error behind the strike
 * that was found, and the node opens on it alone.
 */
#ifndef CONTROLLER_ESTIMATOR_ARM_WINDOW_H
#define CONTROLLER_ESTIMATOR_ARM_WINDOW_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/control_params.h"
#include "controller/estimator/walk_proof.h"
#include "controller/signals.h"

#define arm_window_update REAL_SYMBOL(arm_window_update)
#define arm_window_strike REAL_SYMBOL(arm_window_strike)
#define arm_window_toe_off REAL_SYMBOL(arm_window_toe_off)
#define arm_window_is_open REAL_SYMBOL(arm_window_is_open)
#define arm_window_has_time REAL_SYMBOL(arm_window_has_time)

/* How far the window opens ahead of the contact's mean time. With a contact that is falsely closed a
 * push comes that much early, and what the steps scatter. */
#define ARM_LEAD_S REAL(0.02)
#define ARM_BEHIND_S REAL(0.03)
#define ARM_LATE_S REAL(0.08)
/* A foot switch tells of the landing up to 40 ms late, and the motor is to be back 10 ms ahead of the toe-off
 * (springs.h: PUSH_LEAD_S): a double support below their sum leaves no time for a push. People who walk have
 * 80 ms and more; it goes to zero as they begin to run. */
#define ARM_SUPPORT_LEAST_S REAL(0.05)
/* Longer is a strike or toe-off that was not found. */
#define ARM_SUPPORT_MOST_S REAL(0.5)

/* Of the foot that is to land. */
struct arm_window {
    uint32_t slowing_tick; /* at which this swing began to slow; 0 = not yet */
    uint32_t edge_tick;    /* its contact; 0 = none in this swing */
    uint32_t strike_tick;  /* its strike as found from the angles; 0 = none in this swing */
    real lag_s;            /* mean of contact behind slowing */
    real support_s;        /* from its newest strike to the other leg's toe-off; 0 = not known */
    uint8_t learned;       /* steps behind the mean, saturating */
    bool closed;           /* for the rest of this step */
    bool was_slowing;
};

struct arm_view {
    bool slowing;               /* the leg that swings is being slowed, with its foot ahead */
    bool swings;                /* the leg is in its swing */
    uint32_t contact_tick;      /* of its switch's newest closing; 0 = never */
    enum foot_contact own_foot; /* the other leg, whose latch it is */
    bool own_leg_turns_back;
};

/* One tick of the foot that is to land. */
void arm_window_update(struct arm_window *window, const struct control_params *params,
                       const struct arm_view *view, uint32_t tick);

/* Its strike was found from the legs' angles, age_s ago. */
void arm_window_strike(struct arm_window *window, uint32_t tick, real age_s);

/* The other leg's toe-off was found from its angles, age_s ago; its switch opened in up_tick, or has not yet (tick).
 * The window closes for the rest of this step. */
void arm_window_toe_off(struct arm_window *window, uint32_t tick, real age_s, uint32_t up_tick);

/* Its newest double support lasted long enough for a push. */
bool arm_window_has_time(const struct arm_window *window);

/* The other leg's latch may be armed in this tick, if the window has time for a push. */
bool arm_window_is_open(const struct arm_window *window, const struct control_params *params,
                        uint32_t tick);

#endif
