/* The once-per-step laws: apex state in, precompression of the next push-off out.
 *
 * LAW_PROPORTIONAL: paper eq. (16), in forward speed v = -theta_s' (model.md: with the printed sign
 * and signed rates it destabilises):
 *     r0[k] = finv(v*) - kp (v* - v[k])
 * finv is the inverse of the fixed-point curve (speed_table.h). The command v*
 * follows the desired speed by a ramp per step, because the law's basin is
 * narrow: a jump of 0.02 rad/s falls, a ramp of 0.01 per step does not. r0 is
 * limited in value and in change per step.
 *
 * LAW_PERSON, for a person in the device:
 *     r0[k] = r0* - kp (m[k] - v[k]),  m[k] = running mean of the person's own v
 * A person walks at 1.3 to 1.9 rad/s at the apex, above every steady gait of the
 * compass model, so there is no finv to read a feed-forward from, and a v* that
 * is not theirs would have the device argue with their choice of speed, step after
 * step at its limit. So the push-off is the prescribed r0* (start_r0_m), the target
 * is the speed they keep by themselves, forgotten over PERSON_MEAN_STEPS steps, and
 * eq. (16) acts on what is left: the departure of this step from their own mean.
 * Since that departure averages to nothing, so does the correction: over time the
 * device gives what was prescribed, and it never pulls towards a speed of its own.
 * Its kp keeps the sign that stabilises the model; that it steadies a person is not
 * claimed (kp_m_s_rad = 0 gives the prescription alone).
 *
 * LAW_DLQR and LAW_DEADBEAT, on the whole apex state x, gains scheduled over the branch of gaits:
 *     r0[k] = r0*(v*) - K(v*) (x[k] - x*(v*))
 * with the same ramp of the command. LAW_PREDICTIVE searches with the model on board and needs no ramp
 * (laws/predictive_law.h); eq. (16) is what it starts from and falls back to.
 *
 * Laws that need long work between apex and heel strike do it in step_law_work(), a bounded share a
 * tick; the others are final at once.
 */
#ifndef CONTROLLER_LAWS_STEP_LAW_H
#define CONTROLLER_LAWS_STEP_LAW_H

#include "controller/control_params.h"
#include "controller/laws/predictive_law.h"
#include "controller/signals.h"

#define step_law_init REAL_SYMBOL(step_law_init)
#define step_law_update REAL_SYMBOL(step_law_update)
#define step_law_work REAL_SYMBOL(step_law_work)
#define step_law_finish REAL_SYMBOL(step_law_finish)

struct step_law {
    real command_rad_s;      /* v* of eq. (16), after the ramp */
    real target_speed_rad_s; /* the forward apex speed that the last answer steers for */
    real r0_m;               /* the last answer */
    real mean_rad_s;         /* LAW_PERSON: the person's own mean apex speed */
    uint32_t steps;
    bool is_final;      /* r0_m stands; false while step_law_work() may still better it */
    bool used_fallback; /* the predictive law answered by eq. (16) */
    bool searchable;    /* the predictive law knows its walker */
    struct predictive_law predictive;
};

enum { PERSON_MEAN_STEPS = 16 };

/* Starts from the gait of params->start_r0_m. *params must be valid. */
void step_law_init(struct step_law *law, const struct control_params *params);

/* One step: the apex state (its stance rate < 0) and the desired forward apex speed (rad/s, > 0)
 * give the precompression in metres for this step's push-off, within
 * r0_min..r0_max: final if law->is_final, else the answer to begin with. An apex or speed that is not
 * finite leaves the last answer standing.
 * Call once per apex. Cost: one table inversion and tens of operations. */
real step_law_update(struct step_law *law, const struct control_params *params,
                     const struct apex_estimate *apex, real desired_rad_s);

/* A share of the search for a better answer; call once a tick after step_law_update. Returns true when
 * law->r0_m is worth following anew, and when it has become final. Nothing to do when it is final.
 * Cost bound: predictive_law_work(). At most PREDICTIVE_UNITS calls lead to the final answer. */
bool step_law_work(struct step_law *law, const struct control_params *params);

/* The push-off cannot wait: the answer that stands is final. */
void step_law_finish(struct step_law *law);

#endif
