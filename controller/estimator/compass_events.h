/* Heel strike and lift-off of the compass walker: point feet, straight legs, and an
 * ankle that extends only while it pushes off.
 *
 * Heel strike: the foot that lands releases a loaded spring, so the trailing ankle's first
 * extension is the surest sign, on any slope. The time of its start is extrapolated from the
 * extension's rate. On level ground theta_s + theta_n falls through 0 at the strike
 * (model/README.md), and if that crossing was seen just before, its time is taken. Without
 * a loaded spring the crossing alone decides. In mid-stance the sum rises through 0 (the foot
 * scuffs); only the falling crossing after that counts.
 *
 * Lift-off: the extending ankle has reached its spring's rest length, or has stopped extending.
 */
#ifndef CONTROLLER_ESTIMATOR_COMPASS_EVENTS_H
#define CONTROLLER_ESTIMATOR_COMPASS_EVENTS_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define compass_events_begin_phase REAL_SYMBOL(compass_events_begin_phase)
#define compass_events_watch_strike REAL_SYMBOL(compass_events_watch_strike)
#define compass_events_watch_lift_off REAL_SYMBOL(compass_events_watch_lift_off)

struct compass_events {
    real sum_rad; /* theta_s + theta_n at the last tick */
    real extension_before_m;
    real extension_peak_m; /* of the trailing ankle in this double support */
    uint32_t extension_peak_tick;
    uint32_t crossing_tick; /* of the sum, if crossed */
    real crossing_before_s;
    bool swing_passed; /* the sum was clearly above 0 in this stance */
    bool crossed;      /* and has fallen through 0 with the stance leg behind */
};

struct compass_event {
    bool happened;
    real age_s; /* the event lies this long before the tick of the call, >= 0 */
};

/* A support phase begins: forget the last one. */
void compass_events_begin_phase(struct compass_events *events, uint32_t tick);

/* Single support of leg `stance`, once every tick: watches for the other foot's landing. Constant
 * cost. */
struct compass_event compass_events_watch_strike(struct compass_events *events,
                                                 const struct control_params *params,
                                                 const struct controller_input *input,
                                                 enum side stance);

/* Double support since since_tick, once every tick: watches for the lift-off of the trailing leg
 * `leaving`. Constant cost. */
struct compass_event compass_events_watch_lift_off(struct compass_events *events,
                                                   const struct control_params *params,
                                                   const struct controller_input *input,
                                                   enum side leaving, uint32_t since_tick);

#endif
