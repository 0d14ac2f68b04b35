/* The decision of a step: when the law runs, what of its answer is given, and the step's record.
 *
 * At the apex the law answers. It may improve its answer until the other foot lands; then the
 * answer is final and the step's record is written, once. The device gives assist_level times the
 * law's precompression: a person's assist level rises from 0 to 1 over engage_ramp_steps steady
 * steps, the test mode's is 1 from the start. What the drives bear (step_plan_bear) is a share of that.
 */
#ifndef CONTROLLER_LAWS_STEP_PLAN_H
#define CONTROLLER_LAWS_STEP_PLAN_H

#include "controller/laws/step_law.h"
#include "controller/signals.h"

#define step_plan_begin REAL_SYMBOL(step_plan_begin)
#define step_plan_raise_assist REAL_SYMBOL(step_plan_raise_assist)
#define step_plan_lower_assist REAL_SYMBOL(step_plan_lower_assist)
#define step_plan_bear REAL_SYMBOL(step_plan_bear)
#define step_plan_update REAL_SYMBOL(step_plan_update)
#define step_plan_fade REAL_SYMBOL(step_plan_fade)

struct step_plan {
    struct step_law law;
    struct step_record pending_step; /* of the apex whose push-off the law still works on */
    real change_max_m;               /* of r0 from step to step, by the parameters as it engaged */
    real assist_level;               /* of the law's precompression that is given, 0..1 */
    real assist_most;                /* what the device has shown that it can give, 0..1 */
    real device_share;               /* of that, what the drives bear now, 0..1 (derate.h) */
    bool step_pending;
};

/* What actuation does in this tick. */
struct step_decision {
    real load_m; /* the precompression of the step of `side`, as far as known now */
    enum side side;
    bool assists;  /* a spring may be loaded */
    bool improved; /* the law's answer has changed, and may change again */
    bool new_step; /* the step is decided: load_m is its push-off */
};

/* A walk begins: the law starts from the gait of start_r0_m, no step is pending. */
void step_plan_begin(struct step_plan *plan, const struct control_params *params);

/* A steady step has ended while walking: the assist level rises by one part of
 * engage_ramp_steps, to at most 1, or what the device can give; not in test mode. */
void step_plan_raise_assist(struct step_plan *plan, const struct control_params *params);

/* A prescribed push-off was not given, or dragged: a smaller one may be loaded, and taken back, in time.
 * The assist level falls to three quarters and rises no higher in this walk; not in test mode. */
void step_plan_lower_assist(struct step_plan *plan, const struct control_params *params);

/* The drives bear this share of the prescription, 0..1, from the next step on; it stays when a walk begins. */
void step_plan_bear(struct step_plan *plan, real share);

/* The wearer has asked for an end: the assist level falls to this share of itself, 0..1, and rises no higher. */
void step_plan_fade(struct step_plan *plan, real share);

/* Once a tick while assisting, with the observer's events of this tick. desired_speed_rad_s: the
 * forward apex speed asked for, > 0. *step: the record of the last decided step, replaced in the
 * tick of decision.new_step. Cost bound: one step_law_update() or step_law_work(). */
struct step_decision step_plan_update(struct step_plan *plan, const struct control_params *params,
                                      const struct gait_state *gait, real desired_speed_rad_s,
                                      struct step_record *step);

#endif
