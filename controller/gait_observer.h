/* From leg angles to gait events: apex, heel strike, lift-off.
 *
 * Keeps a short history of both leg angles. Events are the crossings that define
 * them in the model (model.md): apex = the stance leg's angle falls through 0;
 * heel strike = theta_s + theta_n falls through 0 with theta_s < 0; lift-off =
 * the extending ankle has reached its spring's rest length. Crossing times are
 * interpolated inside the tick.
 *
 * The apex speed is read from a least-squares cubic through the samples half a
 * window before and after the crossing, so an apex is reported apex_window_s
 * after it happened: the law has hundreds of milliseconds (on a person about
 * 170) until the spring must be ready, and two-sided smoothing has no lag and
 * averages quantisation and noise.
 */
#ifndef CONTROLLER_GAIT_OBSERVER_H
#define CONTROLLER_GAIT_OBSERVER_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define gait_observer_init REAL_SYMBOL(gait_observer_init)
#define gait_observer_update REAL_SYMBOL(gait_observer_update)

enum { GAIT_HISTORY = 256 }; /* samples a leg; a power of two >= 2 * window + 1 */

struct gait_observer {
    real angle_rad[SIDE_COUNT][GAIT_HISTORY]; /* indexed by tick modulo GAIT_HISTORY */
    real sum_rad;                             /* theta_s + theta_n at the last tick */
    real extension_peak_m;                    /* of the trailing ankle in this double support */
    uint32_t extension_peak_tick;
    uint32_t samples;      /* ticks since init, saturating */
    uint32_t window_ticks; /* half width of the apex fit */
    uint32_t apex_tick[SIDE_COUNT];
    bool apex_pending[SIDE_COUNT]; /* crossed, the fit's second half still to come */
    bool foot_ahead[SIDE_COUNT];   /* was ahead since the last falling crossing */
    bool swing_passed;             /* theta_s + theta_n was clearly above 0 in this stance */
    struct gait_state state;
};

/* Starts with no history and phase PHASE_UNKNOWN. *params must be valid. */
void gait_observer_init(struct gait_observer *observer, const struct control_params *params);

/* Takes the samples of one tick (once a tick, in order; held values for missing
 * ones) and updates observer->state, whose events are those reported in this
 * tick. Cost: tens of operations, and once a step a fit over 2 * window + 1
 * samples (about 10 operations each). */
void gait_observer_update(struct gait_observer *observer, const struct control_params *params,
                          const struct controller_input *input);

#endif
