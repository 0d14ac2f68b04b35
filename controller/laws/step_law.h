/* The once-per-step laws: apex state in, precompression of the next push-off out.
 *
 * This runs the law of the parameter `law` (law_table.h). The answer is limited in value and in
 * change per step, whatever the law wants. An apex that is not finite leaves the last answer.
 *
 * proportional: paper eq. (16), in forward speed v = -theta_s' (with the printed sign and signed
 * rates it destabilises: model/README.md):
 *     r0[k] = finv(v*) - kp (v* - v[k])
 * finv is the inverse of the fixed-point curve (speed_table.h). The command v* follows the desired
 * speed by a ramp per step, because the law's basin is narrow: the walker falls after a jump of
 * 0.02 rad/s, it does not with a ramp of 0.01 rad/s a step.
 *
 * open-loop: constant r0, approached by a ramp from the start gait.
 *
 * dlqr and deadbeat, on the whole apex state x, with gains scheduled over the branch of gaits:
 *     r0[k] = r0*(v*) - K(v*) (x[k] - x*(v*))
 * with the same ramp of the command.
 *
 * predictive: a search with the model on board (predictive_search.h), without a ramp. It starts
 * from eq. (16) and falls back to it.
 *
 * person, for a person in the device:
 *     r0[k] = r0* - kp (m[k] - v[k]),  m[k] = running mean of the person's own v
 * A person walks at 1.3 to 1.9 rad/s at the apex, above every steady gait of the compass model. So
 * there is no finv for a feed-forward. A v* that is not theirs would work against their own choice
 * of speed, step after step at its limit. So the push-off is the prescribed r0* (start_r0_m), and
 * the target is the speed that they keep by themselves, as a mean over about PERSON_MEAN_STEPS
 * steps. Eq. (16) acts on what is left: the departure of this step from their own mean. That
 * departure averages to zero, and so does the correction: over time the device gives what was
 * prescribed, and it never pulls towards a speed of its own. No push has more than 1.1 times the
 * prescribed energy, whatever the pace: r0[k] is at most 1.04 r0*. kp keeps the sign that stabilises the
 * model. That it steadies a person is not claimed (kp_m_s_rad = 0 gives the prescription alone).
 *
 * A law that needs long work between apex and heel strike does a bounded part of it in each
 * step_law_work(); the others are final at once.
 */
#ifndef CONTROLLER_LAWS_STEP_LAW_H
#define CONTROLLER_LAWS_STEP_LAW_H

#include "controller/control_params.h"
#include "controller/laws/predictive_search.h"
#include "controller/signals.h"

#define step_law_init REAL_SYMBOL(step_law_init)
#define step_law_update REAL_SYMBOL(step_law_update)
#define step_law_work REAL_SYMBOL(step_law_work)
#define step_law_finish REAL_SYMBOL(step_law_finish)

enum { PERSON_MEAN_STEPS = 16 };

/* What the laws remember. */
struct step_law {
    real command_rad_s;      /* v*, after the ramp */
    real target_speed_rad_s; /* the forward apex speed that the last answer steers for */
    real r0_m;               /* the last answer */
    real mean_rad_s;         /* person: their own mean apex speed; 0 = no step yet */
    uint32_t steps;          /* apexes so far; saturates */
    bool is_final;           /* r0_m stands; false while step_law_work() may improve it */
    bool used_fallback;      /* the predictive law answered by eq. (16) */
    bool searchable;         /* the predictive law's model takes this walker */
    struct predictive_search predictive;
};

/* Starts from the gait of params->start_r0_m. *params must be valid. */
void step_law_init(struct step_law *law, const struct control_params *params);

/* One step: the apex state (its stance rate < 0) and the desired forward apex speed (rad/s, > 0)
 * give the precompression in metres for this step's push-off, within r0_min..r0_max. It is final
 * if law->is_final, else the answer to begin with. An apex or speed that is not finite leaves the
 * last answer. Call once per apex. Cost: one table inversion and tens of operations. */
real step_law_update(struct step_law *law, const struct control_params *params,
                     const struct apex_estimate *apex, real desired_rad_s);

/* A part of the search for a better answer; call once a tick after step_law_update. Returns true
 * when law->r0_m has changed, and when it has become final. Does nothing when it is final. Cost
 * bound: predictive_search_work(). At most PREDICTIVE_UNITS calls lead to the final answer. */
bool step_law_work(struct step_law *law, const struct control_params *params);

/* The push-off cannot wait: the answer of now is final. */
void step_law_finish(struct step_law *law, const struct control_params *params);

/* ---- for the laws ------------------------------------------------------------------ */

static inline real step_law_approach(real from, real to, real largest_change)
{
    return from + real_clamp(to - from, -largest_change, largest_change);
}

/* The command follows the desired speed, by speed_ramp_rad_s a step. */
static inline void step_law_ramp_command(struct step_law *law, const struct control_params *params,
                                         real desired_rad_s)
{
    law->command_rad_s =
        step_law_approach(law->command_rad_s, desired_rad_s, params->speed_ramp_rad_s);
}

#endif
