/* Both springs over the step: loaded from the own heel strike on, set to the step's r0, armed,
 * unloaded after the own lift-off; and unloaded at every stop.
 *
 * sea_reference.h moves one leg's motor; here the gait's events and the step's decision reach both
 * legs, and the latch is armed only while the other foot may land. A person's spring is loaded only
 * behind a latch that reports closed. It is taken back as soon as its push is over, so that what is left
 * of it does not drag at the foot in swing: when the ankle has reached the motor or comes back, when the
 * own foot's switch opens, and early enough that next to nothing of the spring is left as the foot
 * leaves. That time, and how far the ankle is extended then, are learned, leg by leg: a toe-off is known
 * too late for its own step. A spring is loaded no further than its motor is back in that time; a leg's
 * first push is a harmless one, that shows it. What was prescribed and not given is known (push_watch.h).
 */
#ifndef CONTROLLER_ACTUATION_SPRINGS_H
#define CONTROLLER_ACTUATION_SPRINGS_H

#include "controller/actuation/push_watch.h"
#include "controller/actuation/sea_reference.h"
#include "controller/laws/step_plan.h"
#include "controller/signals.h"
#include "controller/supervisor/supervisor.h"

#define springs_begin REAL_SYMBOL(springs_begin)
#define springs_stop REAL_SYMBOL(springs_stop)
#define springs_follow REAL_SYMBOL(springs_follow)
#define springs_place REAL_SYMBOL(springs_place)
#define springs_command REAL_SYMBOL(springs_command)

/* The time from the latch's opening to toe-off: before any was seen, and its limits. */
#define PUSH_FIRST_S REAL(0.1)
#define PUSH_LEAST_S REAL(0.001)
#define PUSH_MOST_S REAL(0.4)
/* So long after toe-off the foot is free. */
#define SWING_FREE_S REAL(0.05)
/* The motor is to be back so long before: toe-offs scatter, the more the slower somebody walks, and are
 * found late by up to 30 ms in a person who was not fitted. */
#define PUSH_LEAD_S REAL(0.01)
#define PUSH_LEAD_UNFITTED_S REAL(0.03)
#define PUSH_SCATTER_RATIO REAL(0.06)

struct springs {
    struct sea_reference sea[SIDE_COUNT];
    struct sea_stop stop; /* limits of a stop, by the parameters as it engaged */
    struct push_watch watch;
    bool may_load[SIDE_COUNT];         /* by the latch, as of the last tick */
    bool waits[SIDE_COUNT];            /* to be loaded, as soon as it may */
    bool waits_final[SIDE_COUNT];      /* and to what the step has decided */
    real waiting_m[SIDE_COUNT];        /* to this */
    real farthest_m[SIDE_COUNT];       /* the ankle since the latch is open */
    bool open[SIDE_COUNT];             /* the latch, as of the last tick */
    uint32_t open_tick[SIDE_COUNT];    /* since when */
    real push_s[SIDE_COUNT];           /* mean time from there to toe-off; 0 = none seen */
    real left_m[SIDE_COUNT];           /* mean extension of the ankle then */
    bool left[SIDE_COUNT];             /* that time has passed in this push */
    uint32_t up_tick[SIDE_COUNT];      /* the own foot's switch opened in this push; 0 = not yet */
    bool swings[SIDE_COUNT];           /* the foot has left, */
    uint32_t toe_off_tick[SIDE_COUNT]; /* then */
    real reach_m[SIDE_COUNT];          /* from further out a motor is not back in time */
    bool drags;                        /* a spring was found to push at a foot in swing */
};

/* A walk begins: both references start at the motors' positions. */
void springs_begin(struct springs *springs, const struct control_params *params,
                   const struct controller_input *input);

/* The assistance ends: both springs are unloaded with the limits of a stop. */
void springs_stop(struct springs *springs, const struct controller_input *input);

/* Once a tick while assisting: the decision and the gait's events of this tick. first_stance: no
 * apex has been seen in this walk, so the first stance began without a heel strike. A leg
 * without a drive is never loaded. Returns what
 * became of a push-off whose stance ended in this tick, PUSH_DRAGS of one that was found to drag, else
 * PUSH_NONE. Constant cost. */
enum push_outcome springs_follow(struct springs *springs, const struct step_decision *decision,
                                 const struct controller_input *input,
                                 const struct gait_state *gait, bool first_stance);

/* Commissioning moves a motor by itself: this is where its reference is, from which a stop begins. */
void springs_place(struct springs *springs, enum side side, real reference_m);

/* Once a tick in the states that may enable: advances both references and writes both requests.
 * A drive that is not heard while unloading is switched off. Constant cost. */
void springs_command(struct springs *springs, const struct control_params *params,
                     const struct controller_input *input, enum supervisor_state state,
                     const struct gait_state *gait, struct sea_request request[SIDE_COUNT]);

#endif
