/* Both springs over the step: loaded from the own heel strike on, set to the step's r0, armed,
 * unloaded after the own lift-off; and unloaded at every stop.
 *
 * sea_reference.h moves one leg's motor; here the gait's events and the step's decision reach both
 * legs, and the latch is armed only while the other foot may land.
 */
#ifndef CONTROLLER_ACTUATION_SPRINGS_H
#define CONTROLLER_ACTUATION_SPRINGS_H

#include "controller/actuation/sea_reference.h"
#include "controller/laws/step_plan.h"
#include "controller/signals.h"
#include "controller/supervisor/supervisor.h"

#define springs_begin REAL_SYMBOL(springs_begin)
#define springs_stop REAL_SYMBOL(springs_stop)
#define springs_follow REAL_SYMBOL(springs_follow)
#define springs_command REAL_SYMBOL(springs_command)

struct springs {
    struct sea_reference sea[SIDE_COUNT];
    struct sea_stop stop; /* limits of a stop, by the parameters as it engaged */
};

/* A walk begins: both references start at the motors' positions. */
void springs_begin(struct springs *springs, const struct control_params *params,
                   const struct controller_input *input);

/* The assistance ends: both springs are unloaded with the limits of a stop. */
void springs_stop(struct springs *springs, const struct controller_input *input);

/* Once a tick while assisting: the decision and the gait's events of this tick. first_stance: no
 * apex has been seen in this walk, so the first stance began without a heel strike. A leg without a
 * drive is never loaded. Constant
 * cost. */
void springs_follow(struct springs *springs, const struct step_decision *decision,
                    const struct controller_input *input, const struct gait_state *gait,
                    bool first_stance);

/* Once a tick in the states that may enable: advances both references and writes both requests.
 * A drive that is not heard while unloading is switched off. Constant cost. */
void springs_command(struct springs *springs, const struct control_params *params,
                     const struct controller_input *input, enum supervisor_state state,
                     const struct gait_state *gait, struct sea_request request[SIDE_COUNT]);

#endif
