/* From leg angles and ankle extension to gait events and the state at each apex.
 *
 * Keeps a short history of both leg angles. The apex is the same for every body: the
 * stance leg's angle falls through 0. Heel strike and lift-off follow the rules of
 * the body it looks at: compass_events.h for point feet, person_events.h for a person.
 * Event times are interpolated inside the tick and freed from the sensors' latency.
 *
 * The apex state comes from the model observer, which knows the whole stance, and
 * from least-squares cubics through the samples within a window of the crossing,
 * which know nothing of the walker; apex_fusion.h decides between them. The apex is
 * reported a window (apex_window_s) and some ticks after it happened: the law has
 * hundreds of milliseconds (on a person about 170) until the spring must be ready,
 * and samples from both sides smooth without lag. The ticks after the window spread
 * the work: one fit or one step back in time each.
 */
#ifndef CONTROLLER_ESTIMATOR_GAIT_OBSERVER_H
#define CONTROLLER_ESTIMATOR_GAIT_OBSERVER_H

#include "controller/control_params.h"
#include "controller/estimator/apex_fit.h"
#include "controller/estimator/apex_fusion.h"
#include "controller/estimator/compass_events.h"
#include "controller/estimator/model_observer.h"
#include "controller/estimator/person_events.h"
#include "controller/signals.h"

#define gait_observer_init REAL_SYMBOL(gait_observer_init)
#define gait_observer_update REAL_SYMBOL(gait_observer_update)

enum { GAIT_HISTORY = 256 }; /* samples a leg; a power of two >= 2 * window + 1 */

/* An apex whose window is full, on its way to the report. */
struct apex_work {
    bool busy;
    uint32_t stage;
    enum side side;
    uint32_t centre_tick; /* first sample at or below zero */
    struct apex_fit fit;
    struct angle_fit swing_fit;
    bool modelled;                     /* the model observer was in this stance's single support */
    real state[SINGLE_SUPPORT_STATES]; /* its state on the way back to the apex */
    real back_step_s;
    real model_before_s; /* its apex lies this long before the centre tick */
};

/* One leg's strides, for the gait phase. */
struct stride_clock {
    uint32_t strike_tick; /* of the newest heel strike */
    real strike_before_s; /* it lies this long before that tick */
    bool started;
};

struct gait_observer {
    real angle_rad[SIDE_COUNT][GAIT_HISTORY]; /* indexed by tick modulo GAIT_HISTORY */
    uint32_t samples;                         /* ticks since init, saturating */
    uint32_t window_ticks;                    /* half width of the apex fit */
    uint32_t apex_tick[SIDE_COUNT];
    bool apex_pending[SIDE_COUNT];                /* crossed, the fit's second half still to come */
    struct apex_sums fit[SIDE_COUNT][SIDE_COUNT]; /* of both legs around an apex of [side] */
    bool foot_ahead[SIDE_COUNT];                  /* was ahead since the last falling crossing */
    struct compass_events compass;
    struct person_events leg[SIDE_COUNT];
    struct model_observer model;
    struct apex_fusion judge;
    struct apex_work work;
    struct stride_clock clock[SIDE_COUNT];
    real stride_s; /* running mean of both legs' stride times; 0 = none measured yet */
    uint32_t last_apex_tick;
    real walking_speed_rad_s; /* running mean of the apex speed; 0 = none yet */
    struct gait_state state;
};

/* Starts with no history and phase PHASE_UNKNOWN. *params must be valid. */
void gait_observer_init(struct gait_observer *observer, const struct control_params *params);

/* Takes the samples of one tick (once a tick, in order; held values for missing
 * ones) and updates observer->state, whose events are those reported in this
 * tick. Cost: one midpoint step of the model a tick (about 800 instructions on a
 * Cortex-M4F), for a person about 500 operations; after an apex, for eight ticks,
 * one fit over 2 * window + 1 samples (about 10 operations each) or one more step. */
void gait_observer_update(struct gait_observer *observer, const struct control_params *params,
                          const struct controller_input *input);

#endif
