/* The once-per-step law: apex speed in, precompression of the next push-off out.
 *
 * Paper eq. (16), in forward speed v = -theta_s' (model.md: with the printed sign
 * and signed rates it destabilises):
 *     r0[k] = finv(v*) - kp (v* - v[k])
 * finv is the inverse of the fixed-point curve (speed_table.h). The command v*
 * follows the desired speed by a ramp per step, because the law's basin is
 * narrow: a jump of 0.02 rad/s falls, a ramp of 0.01 per step does not. r0 is
 * limited in value and in change per step.
 */
#ifndef CONTROLLER_STEP_LAW_H
#define CONTROLLER_STEP_LAW_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define step_law_init REAL_SYMBOL(step_law_init)
#define step_law_update REAL_SYMBOL(step_law_update)

struct step_law {
    real command_rad_s; /* v*, after the ramp */
    real r0_m;          /* the last answer */
    uint32_t steps;
};

/* Starts from the gait of params->start_r0_m. *params must be valid. */
void step_law_init(struct step_law *law, const struct control_params *params);

/* One step: measured forward apex speed and desired speed, both rad/s and > 0,
 * give the precompression in metres for this step's push-off, within
 * r0_min..r0_max. A speed that is not finite leaves the last answer standing.
 * Call once per apex. Cost: one table inversion and tens of operations. */
real step_law_update(struct step_law *law, const struct control_params *params,
                     real measured_rad_s, real desired_rad_s);

#endif
