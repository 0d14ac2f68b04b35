#include "controller/estimator/body.h"
#include "controller/estimator/body_table.h"
#include "controller/estimator/gait_events.h"

/* A person's leg must have been this far ahead for its fall through the vertical to
 * be a step's apex. */
#define AHEAD_RAD REAL(0.06)

static void update(struct body_state *body, const struct body_tick *now)
{
    const uint32_t tick = now->input->tick;
    const uint32_t centre = tick - LEG_RATE_HALF_WINDOW;
    if (now->samples <= 2 * LEG_RATE_HALF_WINDOW) {
        return;
    }
    const real per_leg_length = REAL(1.0) / now->params->leg_length_m;
    struct leg_view view = {.walking_speed_rad_s = walking_speed_at(now->speed, now->params, tick)};
    for (int i = 0; i < SIDE_COUNT; i++) {
        const struct leg_measurement *leg = &now->input->leg[i];
        view.rate_rad_s = person_events_rate(now->history->angle_rad[i], GAIT_HISTORY, centre);
        view.ahead_rad = angle_history_at(now->history, i, centre) -
                         angle_history_at(now->history, 1 - i, centre);
        view.extension = leg->ankle_extension_m * per_leg_length;
        view.fresh = leg->age_ticks == 0;
        const struct leg_event event = person_events_update(&body->leg[i], &view, tick);
        if (event.kind == LEG_EVENT_STRIKE) {
            gait_events_strike(now->gait, now->clock, now->params, (enum side)i, tick, event.age_s);
        } else if (event.kind == LEG_EVENT_TOE_OFF) {
            gait_events_lift_off(now->gait, now->params, (enum side)i, tick, event.age_s);
        }
    }
}

/* A person's legs that fall back together are a bow or a sway, no step. */
static bool is_step(const struct body_state *body, enum side stance)
{
    return body->leg[side_other(stance)].contact == LEG_SWING;
}

/* A person's ankle can extend at any time: the other leg's swing must be at its end. */
static bool strike_near(const struct body_state *body, const struct gait_state *gait)
{
    const struct person_events *swing = &body->leg[side_other(gait->stance)];
    return gait->phase == PHASE_DOUBLE_SUPPORT || swing->landing ||
           swing->waiting.kind == LEG_EVENT_STRIKE;
}

const struct body BODY_ROW(person) = {
    .update = update,
    .pass_apex = NULL,
    .is_step = is_step,
    .strike_near = strike_near,
    .ahead_least_rad = AHEAD_RAD,
    .legs_take_turns = false,
    .ankle_is_held = false,
};
