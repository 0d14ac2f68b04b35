#include "controller/estimator/body.h"
#include "controller/estimator/body_table.h"
#include "controller/estimator/gait_events.h"

/* A person's leg must have been this far ahead for its fall through the vertical to
 * be a step's apex. */
#define AHEAD_RAD REAL(0.06)
/* A planted foot's leg turns back at about the walking speed. While the foot still carries, the leg turns
 * back at this part of it at least; it comes to rest as the foot leaves the ground. Looked at over the
 * last QUICK_TICKS, which lags by half of that: an early sign of toe-off, and of a sudden stop. */
#define TURNS_BACK_RATIO REAL(0.35)
enum { QUICK_TICKS = TICKS_OF_MS(8) };
/* Both legs at rest for so long: the person has stopped. In walking one of them always moves. */
#define STOPPED_S REAL(0.15)
/* Faster over the standing foot than this, in sqrt(g/l), is no walking: a Froude number of 0.72. People
 * break into a run at about 0.5 (Kram et al., J Exp Biol 200:821, 1997). */
#define WALK_MOST_RATIO REAL(0.85)

static bool has_switches(const struct control_params *params)
{
    return params->foot_switches > REAL(0.5);
}

static real strike_bias_s(const struct control_params *params, int side)
{
    return side == SIDE_LEFT ? params->strike_bias_left_s : params->strike_bias_right_s;
}

static real toe_off_bias_s(const struct control_params *params, int side)
{
    return side == SIDE_LEFT ? params->toe_off_bias_left_s : params->toe_off_bias_right_s;
}

static void find_events(struct body_state *body, const struct body_tick *now, int side,
                        const struct leg_view *view)
{
    const uint32_t tick = now->input->tick;
    const struct leg_event event = person_events_update(&body->leg[side], view, tick);
    if (event.kind == LEG_EVENT_STRIKE) {
        gait_events_strike(now->gait, now->clock, now->params, (enum side)side, tick, event.age_s);
        arm_window_strike(&body->window[side], tick, event.age_s + now->params->sensor_latency_s);
    } else if (event.kind == LEG_EVENT_TOE_OFF) {
        gait_events_lift_off(now->gait, now->params, (enum side)side, tick, event.age_s);
        const struct foot_history *foot = &body->proof.foot[side];
        arm_window_toe_off(&body->window[1 - side], tick,
                           event.age_s + now->params->sensor_latency_s,
                           foot->raw_up ? foot->raw_up_tick : tick);
    }
}

/* Whether it is forward walking: by the switches, and by what needs none. */
static void show_walking(struct body_state *body, const struct body_tick *now,
                         real walking_speed_rad_s)
{
    const struct control_params *params = now->params;
    const uint32_t tick = now->input->tick;
    enum foot_contact foot[SIDE_COUNT];
    real angle_rad[SIDE_COUNT];
    for (int side = 0; side < SIDE_COUNT; side++) {
        foot[side] = now->input->leg[side].foot;
        angle_rad[side] = now->input->leg[side].leg_angle_rad;
    }
    const enum walk_sign sign = walk_proof_update(&body->proof, foot, angle_rad, tick);
    const bool runs = walking_speed_rad_s >
                      WALK_MOST_RATIO * real_sqrt(params->gravity_m_s2 / params->leg_length_m);
    const bool stopped = seconds_since(tick, body->leg[SIDE_LEFT].moved_tick) > STOPPED_S &&
                         seconds_since(tick, body->leg[SIDE_RIGHT].moved_tick) > STOPPED_S;
    now->gait->walk_denied = runs || stopped || (has_switches(params) && sign == WALK_STEP_DENIED);
    now->gait->walk_shown =
        has_switches(params) ? body->proof.steps > 0 : params->strike_error_s > REAL(0.0);
}

/* Whether sensors and latches are where they belong. Without switches the feet are known from the legs' angles
 * only, which then cannot contradict them; their ankles still can. */
static void look_at_placement(struct body_state *body, const struct body_tick *now)
{
    const uint32_t tick = now->input->tick;
    const struct gait_event *strike = &now->gait->event[GAIT_HEEL_STRIKE];
    const struct gait_event *lift_off = &now->gait->event[GAIT_LIFT_OFF];
    const bool switches = has_switches(now->params);
    struct placement_view view;
    bool moved = false;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct foot_history *foot = &body->proof.foot[side];
        const bool changed = foot->since_tick == tick;
        view.lands[side] = switches ? changed && foot->contact == FOOT_DOWN
                                    : strike->happened && strike->side == (enum side)side;
        view.leaves[side] = switches ? changed && foot->contact == FOOT_UP
                                     : lift_off->happened && lift_off->side == (enum side)side;
        view.angle_rad[side] = now->input->leg[side].leg_angle_rad;
        view.extension_m[side] = now->input->leg[side].ankle_extension_m;
        moved = moved || view.lands[side] || view.leaves[side];
    }
    if (moved) {
        placement_edges(&body->placement, &view);
    }
    placement_wires(&body->placement, now->input);
    now->gait->misplaced = placement_found(&body->placement);
}

static bool turns_back(const struct body_tick *now, int side, real walking_speed_rad_s)
{
    const uint32_t tick = now->input->tick;
    const real turn_rad = angle_history_at(now->history, side, tick) -
                          angle_history_at(now->history, side, tick - QUICK_TICKS);
    return turn_rad <
           -TURNS_BACK_RATIO * walking_speed_rad_s * (real)QUICK_TICKS * CONTROL_PERIOD_S;
}

static void watch_windows(struct body_state *body, const struct body_tick *now,
                          real walking_speed_rad_s)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct person_events *leg = &body->leg[side];
        const int own = 1 - side;
        const struct arm_view view = {
            .slowing = leg->landing,
            .swings = leg->contact == LEG_SWING,
            .contact_tick = body->proof.foot[side].raw_edge_tick,
            .own_foot = now->input->leg[own].foot,
            .own_leg_turns_back = turns_back(now, own, walking_speed_rad_s),
        };
        arm_window_update(&body->window[side], now->params, &view, now->input->tick);
    }
}

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
        view.rate_rad_s = person_events_rate(now->history->angle_rad[i], centre);
        view.ahead_rad = angle_history_at(now->history, i, centre) -
                         angle_history_at(now->history, 1 - i, centre);
        view.extension = leg->ankle_extension_m * per_leg_length;
        view.fresh = leg->age_ticks == 0;
        view.strike_bias_s = strike_bias_s(now->params, i);
        view.toe_off_bias_s = toe_off_bias_s(now->params, i);
        find_events(body, now, i, &view);
    }
    watch_windows(body, now, view.walking_speed_rad_s);
    show_walking(body, now, now->speed->mean_rad_s);
    look_at_placement(body, now);
}

/* A person's legs that fall back together are a bow or a sway, no step. */
static bool is_step(const struct body_state *body, enum side stance)
{
    return body->leg[side_other(stance)].contact == LEG_SWING;
}

/* A latch is armed within its window only, and where the leg's last step left time for a push. */
static bool strike_near(const struct body_state *body, const struct control_params *params,
                        const struct gait_state *gait, uint32_t tick)
{
    const struct arm_window *window = &body->window[side_other(gait->stance)];
    return arm_window_is_open(window, params, tick) && arm_window_has_time(window);
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
