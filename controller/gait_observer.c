#include "controller/gait_observer.h"

#include "controller/apex_fit.h"

/* Without any extension this long after heel strike there is no push-off: the
 * support has passed to the leading leg. */
#define NO_PUSH_OFF_S REAL(0.03)

/* Extension that has stopped growing for this long has reached its end. */
#define EXTENSION_SETTLED_S REAL(0.02)

/* Shares of the leg length: an extension that counts as one, and how close to
 * the spring's rest length the ankle counts as fully extended. */
#define EXTENSION_SEEN_SHARE REAL(0.001)
#define EXTENSION_DONE_SHARE REAL(0.0002)

static uint32_t ticks_from_seconds(real seconds)
{
    return (uint32_t)(seconds * (real)CONTROL_RATE_HZ + REAL(0.5));
}

static real angle_at(const struct gait_observer *observer, enum side side, uint32_t tick)
{
    return observer->angle_rad[side][tick % GAIT_HISTORY];
}

void gait_observer_init(struct gait_observer *observer, const struct control_params *params)
{
    *observer = (struct gait_observer){0};
    observer->window_ticks = ticks_from_seconds(params->apex_window_s);
}

/* How long before `tick` a value went from `before` (> 0) to `now` (<= 0), by the
 * straight line between the two samples. */
static real since_crossing_s(real before, real now)
{
    const real fall = before - now;
    return fall > REAL(0.0) ? CONTROL_PERIOD_S * (-now / fall) : REAL(0.0);
}

static void enter_phase(struct gait_observer *observer, enum gait_phase phase, enum side stance,
                        uint32_t tick)
{
    struct gait_state *state = &observer->state;
    state->phase = phase;
    state->stance = stance;
    state->phase_since_tick = tick;
    state->stance_past_apex = false;
    observer->swing_passed = false;
    observer->extension_peak_m = REAL(0.0);
    observer->extension_peak_tick = tick;
}

/* A falling zero crossing of one leg's angle is the apex of that leg's stance:
 * only a leg that carries the body swings backwards through the vertical. */
static void watch_apex(struct gait_observer *observer, const struct control_params *params,
                       enum side side, uint32_t tick)
{
    struct gait_state *state = &observer->state;
    const real angle = angle_at(observer, side, tick);

    if (angle > params->angle_hysteresis_rad) {
        observer->foot_ahead[side] = true;
    }
    if (observer->foot_ahead[side] && angle <= REAL(0.0)) {
        observer->foot_ahead[side] = false;
        observer->apex_pending[side] = observer->samples > observer->window_ticks;
        observer->apex_tick[side] = tick;
        if (state->phase != PHASE_SINGLE_SUPPORT || state->stance != side) {
            enter_phase(observer, PHASE_SINGLE_SUPPORT, side, tick);
        }
        state->stance_past_apex = true;
    }
    if (!observer->apex_pending[side] ||
        tick - observer->apex_tick[side] < observer->window_ticks) {
        return;
    }
    observer->apex_pending[side] = false;
    const struct apex_fit fit = apex_fit_solve(observer->angle_rad[side], GAIT_HISTORY,
                                               observer->apex_tick[side], observer->window_ticks);
    if (fit.speed_rad_s > REAL(0.0)) {
        const struct angle_fit swing =
            apex_fit_other_leg(observer->angle_rad[side_other(side)], GAIT_HISTORY,
                               observer->apex_tick[side], observer->window_ticks, fit.before_tick_s);
        state->event[GAIT_APEX] = (struct gait_event){
            true, side, observer->apex_tick[side], fit.before_tick_s, fit.speed_rad_s};
        state->apex = (struct apex_estimate){-fit.speed_rad_s, swing.angle_rad, swing.rate_rad_s,
                                             REAL(0.0)};
    }
}

static void watch_heel_strike(struct gait_observer *observer, const struct control_params *params,
                              uint32_t tick)
{
    struct gait_state *state = &observer->state;
    const enum side stance = state->stance;
    const real sum = angle_at(observer, SIDE_LEFT, tick) + angle_at(observer, SIDE_RIGHT, tick);
    const real before = observer->sum_rad;
    observer->sum_rad = sum;

    if (state->phase != PHASE_SINGLE_SUPPORT) {
        return;
    }
    if (sum > params->angle_hysteresis_rad) {
        observer->swing_passed = true; /* the scuff, rising through 0, lies behind */
    }
    if (observer->swing_passed && sum <= REAL(0.0) && angle_at(observer, stance, tick) < REAL(0.0)) {
        state->event[GAIT_HEEL_STRIKE] = (struct gait_event){
            true, side_other(stance), tick, since_crossing_s(before, sum), REAL(0.0)};
        enter_phase(observer, PHASE_DOUBLE_SUPPORT, stance, tick);
    }
}

/* True when the trailing ankle has nothing left to give. */
static bool push_off_ended(const struct gait_observer *observer, const struct control_params *params,
                           const struct controller_input *input)
{
    const enum side side = observer->state.stance;
    const real extension = input->leg[side].ankle_extension_m;
    const real seen = EXTENSION_SEEN_SHARE * params->leg_length_m;
    const real done = EXTENSION_DONE_SHARE * params->leg_length_m;

    if (observer->extension_peak_m < seen) {
        return input->tick - observer->state.phase_since_tick >= ticks_from_seconds(NO_PUSH_OFF_S);
    }
    return extension >= input->sea[side].precompression_m - done ||
           extension < observer->extension_peak_m - seen ||
           input->tick - observer->extension_peak_tick >= ticks_from_seconds(EXTENSION_SETTLED_S);
}

static void watch_lift_off(struct gait_observer *observer, const struct control_params *params,
                           const struct controller_input *input)
{
    struct gait_state *state = &observer->state;
    if (state->phase != PHASE_DOUBLE_SUPPORT) {
        return;
    }
    const enum side leaving = state->stance;
    const real extension = input->leg[leaving].ankle_extension_m;
    if (extension > observer->extension_peak_m) {
        observer->extension_peak_m = extension;
        observer->extension_peak_tick = input->tick;
    }
    if (push_off_ended(observer, params, input)) {
        state->event[GAIT_LIFT_OFF] =
            (struct gait_event){true, leaving, input->tick, REAL(0.0), REAL(0.0)};
        enter_phase(observer, PHASE_SINGLE_SUPPORT, side_other(leaving), input->tick);
    }
}

/* Before the first event: the leg in front carries the body next. */
static void guess_stance(struct gait_observer *observer, const struct control_params *params,
                         const struct controller_input *input)
{
    const real difference =
        input->leg[SIDE_LEFT].leg_angle_rad - input->leg[SIDE_RIGHT].leg_angle_rad;
    if (real_abs(difference) > params->angle_hysteresis_rad) {
        enter_phase(observer, PHASE_SINGLE_SUPPORT, difference > REAL(0.0) ? SIDE_LEFT : SIDE_RIGHT,
                    input->tick);
    }
}

void gait_observer_update(struct gait_observer *observer, const struct control_params *params,
                          const struct controller_input *input)
{
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        observer->state.event[kind] = (struct gait_event){0};
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        observer->angle_rad[side][input->tick % GAIT_HISTORY] = input->leg[side].leg_angle_rad;
    }
    if (observer->samples < UINT32_MAX) {
        observer->samples++;
    }
    if (observer->state.phase == PHASE_UNKNOWN) {
        guess_stance(observer, params, input);
    }
    watch_lift_off(observer, params, input);
    watch_heel_strike(observer, params, input->tick);
    watch_apex(observer, params, SIDE_LEFT, input->tick);
    watch_apex(observer, params, SIDE_RIGHT, input->tick);
}
