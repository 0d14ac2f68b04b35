/* From leg angles and ankle extension to gait events and the state at each apex.
 *
 * Keeps a short history of both leg angles. The apex is the same for every body: the
 * stance leg's angle falls through 0. Heel strike and lift-off follow the rules of
 * the body it looks at: compass_events.h for point feet, leg_events.h for a person.
 * Event times are interpolated inside the tick and freed from the sensors' latency.
 *
 * The apex state is read from least-squares cubics through the samples half a
 * window before and after the crossing, so an apex is reported apex_window_s
 * after it happened: the law has hundreds of milliseconds (on a person about
 * 170) until the spring must be ready, and two-sided smoothing has no lag and
 * averages quantisation and noise.
 */
#ifndef CONTROLLER_GAIT_OBSERVER_H
#define CONTROLLER_GAIT_OBSERVER_H

#include "controller/compass_events.h"
#include "controller/control_params.h"
#include "controller/leg_events.h"
#include "controller/signals.h"

#define gait_observer_init REAL_SYMBOL(gait_observer_init)
#define gait_observer_update REAL_SYMBOL(gait_observer_update)

enum { GAIT_HISTORY = 256 }; /* samples a leg; a power of two >= 2 * window + 1 */

/* One leg's strides, for the gait phase. */
struct stride_clock {
    uint32_t strike_tick; /* of the newest heel strike */
    real strike_before_s; /* it lies this long before that tick */
    real stride_s;        /* running mean of the stride time; 0 = none measured yet */
    bool started;
};

struct gait_observer {
    real angle_rad[SIDE_COUNT][GAIT_HISTORY]; /* indexed by tick modulo GAIT_HISTORY */
    uint32_t samples;                         /* ticks since init, saturating */
    uint32_t window_ticks;                    /* half width of the apex fit */
    uint32_t apex_tick[SIDE_COUNT];
    bool apex_pending[SIDE_COUNT]; /* crossed, the fit's second half still to come */
    bool foot_ahead[SIDE_COUNT];   /* was ahead since the last falling crossing */
    struct compass_events compass;
    struct leg_events leg[SIDE_COUNT];
    struct stride_clock clock[SIDE_COUNT];
    uint32_t last_apex_tick;
    real yardstick_rad_s; /* running mean of the apex speed; 0 = none yet */
    struct gait_state state;
};

/* Starts with no history and phase PHASE_UNKNOWN. *params must be valid. */
void gait_observer_init(struct gait_observer *observer, const struct control_params *params);

/* Takes the samples of one tick (once a tick, in order; held values for missing
 * ones) and updates observer->state, whose events are those reported in this
 * tick. Cost: tens of operations for a compass walker, about 500 for a person,
 * and once a step a fit over 2 * window + 1 samples (about 20 operations each). */
void gait_observer_update(struct gait_observer *observer, const struct control_params *params,
                          const struct controller_input *input);

#endif
