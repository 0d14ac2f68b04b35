/* How events get into the gait's state: their times as signals.h wants them, and the support
 * phases that they begin. */
#ifndef CONTROLLER_ESTIMATOR_GAIT_EVENTS_H
#define CONTROLLER_ESTIMATOR_GAIT_EVENTS_H

#include "controller/control_params.h"
#include "controller/estimator/stride_clock.h"
#include "controller/signals.h"

#define gait_events_report REAL_SYMBOL(gait_events_report)
#define gait_events_enter REAL_SYMBOL(gait_events_enter)
#define gait_events_strike REAL_SYMBOL(gait_events_strike)
#define gait_events_lift_off REAL_SYMBOL(gait_events_lift_off)

/* Reports an event in this tick. age_s: of the samples that showed it, before SYNC `now`; the
 * event itself is older by the sensors' latency. Constant cost, as all of these. */
void gait_events_report(struct gait_state *gait, const struct control_params *params,
                        enum gait_event_kind kind, enum side side, uint32_t now, real age_s);

/* A support phase begins at this tick. */
void gait_events_enter(struct gait_state *gait, enum gait_phase phase, enum side stance,
                       uint32_t tick);

/* The foot of `landed` has landed: reports it, begins the double support, and the leg's stride. */
void gait_events_strike(struct gait_state *gait, struct stride_clock *clock,
                        const struct control_params *params, enum side landed, uint32_t now,
                        real age_s);

/* The foot of `leaving` has left the ground: reports it, begins the single support. */
void gait_events_lift_off(struct gait_state *gait, const struct control_params *params,
                          enum side leaving, uint32_t now, real age_s);

#endif
