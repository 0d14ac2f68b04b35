/* Feedback of the whole apex state, with gains scheduled over the branch of gaits: what dlqr and
 * deadbeat share. */
#ifndef CONTROLLER_LAWS_STATE_FEEDBACK_H
#define CONTROLLER_LAWS_STATE_FEEDBACK_H

#include "controller/control_params.h"
#include "controller/laws/step_law.h"

#define state_feedback_begin REAL_SYMBOL(state_feedback_begin)
#define state_feedback_r0 REAL_SYMBOL(state_feedback_r0)

/* The gait at the ramped command, and the apex' departure from it. Cost: gait_branch_at(). */
struct gait_branch_point state_feedback_begin(struct step_law *law,
                                              const struct control_params *params,
                                              const struct apex *apex, real desired_rad_s,
                                              real departure[3]);

/* r0 of the gait, less gain . departure; m. Pure. */
real state_feedback_r0(const struct gait_branch_point *gait, const real gain[3],
                       const real departure[3]);

#endif
