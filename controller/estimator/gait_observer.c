#include "controller/estimator/gait_observer.h"

#include "controller/estimator/body_table.h"

void gait_observer_init(struct gait_observer *observer, const struct control_params *params)
{
    *observer = (struct gait_observer){0};
    model_observer_init(&observer->model, params);
    apex_finder_init(&observer->apex, params);
    for (int side = 0; side < SIDE_COUNT; side++) {
        observer->state.stride_share[side] = REAL(-1.0);
    }
}

/* A leg's fall through the vertical is a step's apex, when the body says so. */
static void watch_apexes(struct gait_observer *observer, const struct control_params *params,
                         const struct body *body, uint32_t tick)
{
    const real hysteresis_rad = params->angle_hysteresis_rad, least_rad = body->ahead_least_rad;
    enum apex_sign sign[SIDE_COUNT];
    apex_finder_watch(&observer->apex, &observer->history, observer->samples,
                      hysteresis_rad < least_rad ? least_rad : hysteresis_rad, tick, sign);
    for (int i = 0; i < SIDE_COUNT; i++) {
        const enum side side = (enum side)i;
        if (sign[i] == APEX_CROSSED) {
            if (body->pass_apex != NULL) {
                body->pass_apex(&observer->body, &observer->state, side, tick);
            }
            observer->state.stance_past_apex = true;
        } else if (sign[i] == APEX_COLLECTED &&
                   (body->is_step == NULL || body->is_step(&observer->body, side))) {
            apex_finder_begin(&observer->apex, &observer->model, side, tick);
        }
    }
}

static void remember(struct gait_observer *observer, const struct controller_input *input)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        observer->history.angle_rad[side][input->tick % GAIT_HISTORY] =
            input->leg[side].leg_angle_rad;
    }
    if (observer->samples < UINT32_MAX) {
        observer->samples++;
    }
}

void gait_observer_update(struct gait_observer *observer, const struct control_params *params,
                          const struct controller_input *input)
{
    const uint32_t tick = input->tick;
    const struct body *body = body_of(params->body);
    struct gait_state *gait = &observer->state;
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        gait->event[kind] = (struct gait_event){0};
    }
    gait->walk_shown = true;
    gait->walk_denied = false;
    remember(observer, input);
    const struct body_tick now = {
        .params = params,
        .input = input,
        .history = &observer->history,
        .samples = observer->samples,
        .speed = &observer->speed,
        .gait = gait,
        .clock = &observer->clock,
        .model = &observer->model,
    };
    body->update(&observer->body, &now);
    if (observer->apex.work.busy &&
        apex_finder_work(&observer->apex, params, &observer->model, gait, tick)) {
        walking_speed_apex(&observer->speed, observer->apex.work.centre_tick,
                           -gait->apex.stance_rate_rad_s);
    }
    watch_apexes(observer, params, body, tick);
    gait->strike_near = body->strike_near(&observer->body, params, gait, tick);
    stride_clock_shares(&observer->clock, tick, gait->stride_share);
}
