#include "controller/estimator/gait_events.h"

#include "controller/estimator/angle_history.h"

/* No event is placed before the oldest sample that is kept. */
#define AGE_MOST_TICKS ((real)GAIT_HISTORY)

static real ticks_of_age(real age)
{
    if (real_is_within(age, REAL(0.0), AGE_MOST_TICKS)) {
        return age;
    }
    return age > AGE_MOST_TICKS ? AGE_MOST_TICKS : REAL(0.0);
}

void gait_events_report(struct gait_state *gait, const struct control_params *params,
                        enum gait_event_kind kind, enum side side, uint32_t now, real age_s)
{
    const real age = (age_s + params->sensor_latency_s) * (real)CONTROL_RATE_HZ;
    const real aged = ticks_of_age(age);
    const uint32_t whole = (uint32_t)aged;
    gait->event[kind] = (struct gait_event){true, side, now - whole,
                                            (aged - (real)whole) * CONTROL_PERIOD_S, REAL(0.0)};
}

void gait_events_enter(struct gait_state *gait, enum gait_phase phase, enum side stance,
                       uint32_t tick)
{
    gait->phase = phase;
    gait->stance = stance;
    gait->phase_since_tick = tick;
    gait->stance_past_apex = false;
}

void gait_events_strike(struct gait_state *gait, struct stride_clock *clock,
                        const struct control_params *params, enum side landed, uint32_t now,
                        real age_s)
{
    gait_events_report(gait, params, GAIT_HEEL_STRIKE, landed, now, age_s);
    stride_clock_strike(clock, &gait->event[GAIT_HEEL_STRIKE]);
    gait_events_enter(gait, PHASE_DOUBLE_SUPPORT, side_other(landed), now);
}

void gait_events_lift_off(struct gait_state *gait, const struct control_params *params,
                          enum side leaving, uint32_t now, real age_s)
{
    gait_events_report(gait, params, GAIT_LIFT_OFF, leaving, now, age_s);
    gait_events_enter(gait, PHASE_SINGLE_SUPPORT, side_other(leaving), now);
}
