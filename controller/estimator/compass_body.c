#include "controller/estimator/body.h"
#include "controller/estimator/body_table.h"
#include "controller/estimator/gait_events.h"

/* Lost, the model starts anew from the samples when all of their window lies in the
 * single support. */
#define MODEL_RESTART_TICKS (2u * LEG_RATE_HALF_WINDOW + TICKS_OF_MS(8u))

static void enter_phase(struct body_state *body, struct gait_state *gait, enum gait_phase phase,
                        enum side stance, uint32_t tick)
{
    gait_events_enter(gait, phase, stance, tick);
    compass_events_begin_phase(&body->compass, tick);
}

/* Before the first event: the leg in front carries the body next. */
static void guess_stance(struct body_state *body, const struct body_tick *now)
{
    const struct controller_input *input = now->input;
    const real difference =
        input->leg[SIDE_LEFT].leg_angle_rad - input->leg[SIDE_RIGHT].leg_angle_rad;
    if (real_abs(difference) > now->params->angle_hysteresis_rad) {
        enter_phase(body, now->gait, PHASE_SINGLE_SUPPORT,
                    difference > REAL(0.0) ? SIDE_LEFT : SIDE_RIGHT, input->tick);
    }
}

/* A lost model starts from the samples' own angles and slopes. */
static void restart_model(const struct body_tick *now)
{
    const struct gait_state *gait = now->gait;
    const uint32_t tick = now->input->tick;
    if (now->model->phase != MODEL_LOST || gait->phase != PHASE_SINGLE_SUPPORT ||
        tick - gait->phase_since_tick != MODEL_RESTART_TICKS) {
        return;
    }
    const uint32_t centre = tick - LEG_RATE_HALF_WINDOW;
    const real *stance = now->history->angle_rad[gait->stance];
    const real *swing = now->history->angle_rad[side_other(gait->stance)];
    const real state[SINGLE_SUPPORT_STATES] = {[STANCE_ANGLE] = stance[centre % GAIT_HISTORY],
                                               [SWING_ANGLE] = swing[centre % GAIT_HISTORY],
                                               [STANCE_RATE] = person_events_rate(stance, centre),
                                               [SWING_RATE] = person_events_rate(swing, centre)};
    model_observer_begin(now->model, gait->stance, tick, state,
                         (real)LEG_RATE_HALF_WINDOW * CONTROL_PERIOD_S);
}

static void look_for_strike(struct body_state *body, const struct body_tick *now)
{
    const struct controller_input *input = now->input;
    const enum side stance = now->gait->stance;
    const struct compass_event event =
        compass_events_watch_strike(&body->compass, now->params, input, stance);
    if (event.happened) {
        model_observer_strike(now->model, input->tick, event.age_s,
                              input->sea[stance].precompression_m);
        gait_events_strike(now->gait, now->clock, now->params, side_other(stance), input->tick,
                           event.age_s);
        compass_events_begin_phase(&body->compass, input->tick);
    }
}

static void look_for_lift_off(struct body_state *body, const struct body_tick *now)
{
    const struct controller_input *input = now->input;
    const enum side leaving = now->gait->stance;
    const struct compass_event event = compass_events_watch_lift_off(
        &body->compass, now->params, input, leaving, now->gait->phase_since_tick);
    if (event.happened) {
        model_observer_lift_off(now->model, input->tick, input->sea[leaving].precompression_m);
        gait_events_lift_off(now->gait, now->params, leaving, input->tick, event.age_s);
        compass_events_begin_phase(&body->compass, input->tick);
    }
}

static void update(struct body_state *body, const struct body_tick *now)
{
    model_observer_advance(now->model, now->input);
    restart_model(now);
    if (now->gait->phase == PHASE_UNKNOWN) {
        guess_stance(body, now);
    }
    if (now->gait->phase == PHASE_SINGLE_SUPPORT) {
        look_for_strike(body, now);
    } else if (now->gait->phase == PHASE_DOUBLE_SUPPORT) {
        look_for_lift_off(body, now);
    }
}

/* Only the leg that carries the body swings backwards through the vertical. */
static void pass_apex(struct body_state *body, struct gait_state *gait, enum side stance,
                      uint32_t tick)
{
    if (gait->phase != PHASE_SINGLE_SUPPORT || gait->stance != stance) {
        enter_phase(body, gait, PHASE_SINGLE_SUPPORT, stance, tick);
    }
}

/* A compass walker's ankle cannot extend before the other foot lands: from its apex on an armed
 * latch does no harm. */
static bool strike_near(const struct body_state *body, const struct control_params *params,
                        const struct gait_state *gait, uint32_t tick)
{
    (void)params;
    (void)tick;
    (void)body;
    return gait->phase == PHASE_DOUBLE_SUPPORT ||
           (gait->phase == PHASE_SINGLE_SUPPORT && gait->stance_past_apex);
}

const struct body BODY_ROW(compass) = {
    .update = update,
    .pass_apex = pass_apex,
    .is_step = NULL,
    .strike_near = strike_near,
    .ahead_least_rad = REAL(0.0),
    .legs_take_turns = true,
    .ankle_is_held = true,
};
