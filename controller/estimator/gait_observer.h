/* From leg angles and ankle extension to gait events and the state at each apex.
 *
 *   samples -> history -> the body's rules -> heel strike, lift-off -> phase, stride clock
 *                  |            \-> model observer --\
 *                  \-> apex finder: fit of the samples -> fusion -> apex event and state
 *
 * The body's rules find heel strike and lift-off: compass_events.h for point feet, person_events.h
 * for a person (body_table.h). The apex is found in the same way for all (apex_finder.h). Event
 * times are interpolated inside the tick, and the sensors' latency is taken off.
 */
#ifndef CONTROLLER_ESTIMATOR_GAIT_OBSERVER_H
#define CONTROLLER_ESTIMATOR_GAIT_OBSERVER_H

#include "controller/control_params.h"
#include "controller/estimator/angle_history.h"
#include "controller/estimator/apex_finder.h"
#include "controller/estimator/body.h"
#include "controller/estimator/model_observer.h"
#include "controller/estimator/stride_clock.h"
#include "controller/estimator/walking_speed.h"
#include "controller/signals.h"

#define gait_observer_init REAL_SYMBOL(gait_observer_init)
#define gait_observer_update REAL_SYMBOL(gait_observer_update)

struct gait_observer {
    struct angle_history history;
    uint32_t samples; /* ticks since init, saturating */
    struct body_state body;
    struct model_observer model;
    struct apex_finder apex;
    struct stride_clock clock;
    struct walking_speed speed;
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
