/* The walker's state from the model and the sensors together: a hybrid observer.
 *
 *   single support  the model (model/single_support.h) predicts the four states from sample to
 *                   sample, and each sample corrects them (observer_gains.h)
 *   heel strike     the state of that moment, out of a short history, goes through the
 *                   collision map
 *   double support  the released spring drives the chain; the measured ankle corrects it
 *   lift-off        the legs swap roles
 * So an apex is known from the whole stance before it. Stepping back to it from a later time
 * uses the samples after it, too.
 *
 * "Now" is when the newest sample was taken. Where body and model differ grossly, or an event
 * is impossible, the observer is lost (MODEL_LOST) until the next lift-off or a restart.
 */
#ifndef CONTROLLER_ESTIMATOR_MODEL_OBSERVER_H
#define CONTROLLER_ESTIMATOR_MODEL_OBSERVER_H

#include "controller/control_params.h"
#include "controller/signals.h"
#include "model/double_support.h"
#include "model/single_support.h"

#define model_observer_init REAL_SYMBOL(model_observer_init)
#define model_observer_advance REAL_SYMBOL(model_observer_advance)
#define model_observer_strike REAL_SYMBOL(model_observer_strike)
#define model_observer_lift_off REAL_SYMBOL(model_observer_lift_off)
#define model_observer_lose REAL_SYMBOL(model_observer_lose)
#define model_observer_begin REAL_SYMBOL(model_observer_begin)
#define model_observer_step REAL_SYMBOL(model_observer_step)

enum model_phase { MODEL_LOST = 0, MODEL_SINGLE = 1, MODEL_DOUBLE = 2 };

/* About 32 ms; a power of two. */
enum { MODEL_SLOW_TICKS = TICK_PERIOD_US < 2000 ? 32 : TICK_PERIOD_US < 4000 ? 16 : 8 };
enum { MODEL_HISTORY = 32 }; /* ticks; a power of two above the longest age of a strike */

struct model_observer {
    struct walker walker;
    bool usable; /* the parameters make a walker */
    enum model_phase phase;
    enum side stance;                  /* the supporting leg; in double support the trailing one */
    real state[SINGLE_SUPPORT_STATES]; /* in single support, at the newest sample */
    real ankle[DOUBLE_SUPPORT_STATES]; /* in double support */
    real behind_s;                     /* `ankle` was so long before the newest sample */
    real toe_distance_m;
    real history[MODEL_HISTORY][SINGLE_SUPPORT_STATES]; /* by tick */
    uint32_t since_tick;                                /* of the single support */
    uint32_t knot;      /* of observer_gains, rising with the time since lift-off */
    uint32_t off_ticks; /* in a row with a gross disagreement */
    /* Mean squares of the angles' noise, estimated: white, and slow: what changes within
     * MODEL_SLOW_TICKS beyond that. */
    real noise_rad2;
    real slow_rad2;
    real error_rad[SIDE_COUNT][MODEL_SLOW_TICKS]; /* measured minus predicted, by tick */
    uint32_t errors;                              /* ticks of this single support in error_rad */
};

/* Lost at first. *params must be valid; parameters that make no walker leave the
 * observer unusable, that is lost for ever. */
void model_observer_init(struct model_observer *observer, const struct control_params *params);

/* One tick: predicts to the newest sample and corrects by it. Every tick in order.
 * Cost: one midpoint step (about 800 instructions on a Cortex-M4F). */
void model_observer_advance(struct model_observer *observer, const struct controller_input *input);

/* The other foot landed age_s before the newest sample; rest_m is the rest extension
 * of the trailing ankle's spring, which is released. Cost: a step and a map; the next
 * tick's step is longer. */
void model_observer_strike(struct model_observer *observer, uint32_t tick, real age_s, real rest_m);

/* The trailing foot has left the ground at or about the newest sample: the next single
 * support, from where the chain's motion reached rest_m. Cost: one step. */
void model_observer_lift_off(struct model_observer *observer, uint32_t tick, real rest_m);

/* Gives up: MODEL_LOST until model_observer_begin(). */
void model_observer_lose(struct model_observer *observer);

/* Starts anew within a single support of leg `stance`, from the state that it had age_s
 * before the newest sample. Cost: one step. */
void model_observer_begin(struct model_observer *observer, enum side stance, uint32_t tick,
                          const real *state, real age_s);

/* Single-support motion by h_s (either sign), from and to `state`. One step. */
void model_observer_step(const struct model_observer *observer, real h_s, real *state);

#endif
