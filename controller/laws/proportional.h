/* Paper eq. (16) in forward speed, see step_law.h: also what the predictive law falls back to. */
#ifndef CONTROLLER_LAWS_PROPORTIONAL_H
#define CONTROLLER_LAWS_PROPORTIONAL_H

#include "controller/control_params.h"
#include "controller/laws/step_law.h"

#define proportional_step REAL_SYMBOL(proportional_step)

/* The precompression wanted at this apex, m, before its limits. desired_rad_s: forward apex speed
 * asked for, > 0; law->command_rad_s follows it by the ramp. Cost: one table inversion. */
real proportional_step(struct step_law *law, const struct control_params *params,
                       const struct apex *apex, real desired_rad_s);

#endif
