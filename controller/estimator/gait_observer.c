#include "controller/estimator/gait_observer.h"

/* Yardstick of person_events before the first apex and long after the last one, and its
 * limits, all in sqrt(g/l): a slow first step. */
#define FIRST_SPEED_RATIO REAL(0.3)
#define LEAST_SPEED_RATIO REAL(0.1)
#define MOST_SPEED_RATIO REAL(0.8)
#define SPEED_FORGOTTEN_S REAL(3.0)
#define SPEED_MEAN_GAIN REAL(0.3)
#define SPEED_JUMP_RATIO REAL(0.3)

/* A person's leg must have been this far ahead for its fall through the vertical to
 * be a step's apex. */
#define PERSON_AHEAD_RAD REAL(0.06)

/* Back at the fit's crossing, the model's own lies within this. */
#define LANDING_MAX_S REAL(0.02)

/* Lost, the model starts anew from the samples when all of their window lies in the
 * single support. */
#define MODEL_RESTART_TICKS (2u * LEG_RATE_HALF_WINDOW + TICKS_OF_MS(8u))

/* A stride differing more than this from the mean starts a new mean. */
#define STRIDE_CHANGE_RATIO REAL(0.3)
#define STRIDE_MEAN_GAIN REAL(0.5)
#define STRIDE_LONGEST_S REAL(4.0)

static bool is_person(const struct control_params *params)
{
    return params->body == (real)BODY_PERSON;
}

void gait_observer_init(struct gait_observer *observer, const struct control_params *params)
{
    *observer = (struct gait_observer){0};
    observer->window_ticks = ticks_from_seconds(params->apex_window_s);
    model_observer_init(&observer->model, params);
    apex_fusion_init(&observer->judge);
    for (int side = 0; side < SIDE_COUNT; side++) {
        observer->state.stride_share[side] = REAL(-1.0);
    }
}

/* An event age_s before `now` as signals.h wants it: the first SYNC at or after it
 * and the rest. Age is that of the sample; the event is older by the latency. */
static void report(struct gait_state *state, const struct control_params *params,
                   enum gait_event_kind kind, enum side side, uint32_t now, real age_s)
{
    const real age = (age_s + params->sensor_latency_s) * (real)CONTROL_RATE_HZ;
    const real aged = age > REAL(0.0) ? age : REAL(0.0);
    const uint32_t whole = (uint32_t)aged;
    state->event[kind] = (struct gait_event){true, side, now - whole,
                                             (aged - (real)whole) * CONTROL_PERIOD_S, REAL(0.0)};
}

static void enter_phase(struct gait_observer *observer, enum gait_phase phase, enum side stance,
                        uint32_t tick)
{
    struct gait_state *state = &observer->state;
    state->phase = phase;
    state->stance = stance;
    state->phase_since_tick = tick;
    state->stance_past_apex = false;
    compass_events_begin_phase(&observer->compass, tick);
}

/* The apex speed's running mean, taken anew after a rest or a jump. */
static void follow_speed(struct gait_observer *observer, uint32_t tick, real speed_rad_s)
{
    const real mean = observer->walking_speed_rad_s;
    const bool anew = seconds_since(tick, observer->last_apex_tick) > SPEED_FORGOTTEN_S ||
                      real_abs(speed_rad_s - mean) > SPEED_JUMP_RATIO * mean;
    observer->walking_speed_rad_s =
        anew ? speed_rad_s : mean + SPEED_MEAN_GAIN * (speed_rad_s - mean);
    observer->last_apex_tick = tick;
}

/* ---- apex -------------------------------------------------------------------- */

/* The samples of this tick and their mirror images before the crossing, of both legs. */
static void continue_fit(struct gait_observer *observer, enum side side, uint32_t tick)
{
    const uint32_t centre = observer->apex_tick[side];
    const uint32_t after = tick % GAIT_HISTORY;
    const uint32_t before = (centre - (tick - centre)) % GAIT_HISTORY;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        apex_fit_add(&observer->fit[side][leg], observer->window_ticks,
                     observer->angle_rad[leg][after], observer->angle_rad[leg][before]);
    }
}

/* Stages of an apex's work, one a tick; between the fits and the report lie the steps
 * back in time, long ones: at 1/30 of the walker's time unit each, they cost nothing
 * in accuracy (1e-7 of the state). */
enum { STAGE_FIT = 0, STAGE_BACK = 1, BACK_STEPS = 4 };
enum { STAGE_LAND = STAGE_BACK + BACK_STEPS };

static void begin_work(struct gait_observer *observer, enum side side, uint32_t tick)
{
    struct apex_work *work = &observer->work;
    const struct model_observer *model = &observer->model;
    *work =
        (struct apex_work){.busy = true, .side = side, .centre_tick = observer->apex_tick[side]};
    work->modelled = model->phase == MODEL_SINGLE && model->stance == side;
    for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
        work->state[i] = model->state[i];
    }
    work->back_step_s = -seconds_since(tick, work->centre_tick) / (real)BACK_STEPS;
}

/* The last, short step to where the stance leg is upright; false if it leads nowhere. */
static bool land(const struct gait_observer *observer, struct apex_work *work)
{
    const real to_apex_s = -work->state[STANCE_ANGLE] / work->state[STANCE_RATE];
    if (!(work->state[STANCE_RATE] < REAL(0.0)) || !(real_abs(to_apex_s) < LANDING_MAX_S)) {
        return false;
    }
    work->model_before_s = -to_apex_s;
    model_observer_step(&observer->model, to_apex_s, work->state);
    return true;
}

static void report_apex(struct gait_observer *observer, const struct control_params *params,
                        uint32_t tick)
{
    struct gait_state *state = &observer->state;
    const struct apex_work *work = &observer->work;
    const struct apex_estimate fit = {-work->fit.speed_rad_s, work->swing_fit.angle_rad,
                                      work->swing_fit.rate_rad_s, REAL(0.0)};
    const struct apex_estimate model = {work->state[STANCE_RATE], work->state[SWING_ANGLE],
                                        work->state[SWING_RATE], REAL(1.0)};
    const struct apex_noise noise = {observer->model.noise_rad2, observer->model.slow_rad2};
    state->apex =
        apex_fusion_decide(&observer->judge, work->side, &fit, work->modelled ? &model : NULL,
                           &noise, observer->window_ticks);
    const real before_s = work->fit.before_tick_s +
                          state->apex.confidence * (work->model_before_s - work->fit.before_tick_s);
    report(state, params, GAIT_APEX, work->side, tick,
           seconds_since(tick, work->centre_tick) + before_s);
    state->event[GAIT_APEX].speed_rad_s = -state->apex.stance_rate_rad_s;
    follow_speed(observer, work->centre_tick, -state->apex.stance_rate_rad_s);
}

static void work_on_apex(struct gait_observer *observer, const struct control_params *params,
                         uint32_t tick)
{
    struct apex_work *work = &observer->work;
    if (!work->busy) {
        return;
    }
    if (work->stage == STAGE_FIT) {
        const struct apex_sums *fit = observer->fit[work->side];
        work->fit = apex_fit_solve(&fit[work->side], observer->window_ticks);
        work->swing_fit = apex_fit_other_leg(&fit[side_other(work->side)], observer->window_ticks,
                                             work->fit.before_tick_s);
        work->busy = work->fit.speed_rad_s > REAL(0.0);
        work->stage = work->modelled ? work->stage : STAGE_LAND - 1;
    } else if (work->stage < STAGE_LAND) {
        model_observer_step(&observer->model, work->back_step_s, work->state);
    } else if (work->stage == STAGE_LAND) {
        work->modelled = work->modelled && land(observer, work);
    } else { /* in a tick of its own: the law and its telegram come with it */
        work->busy = false;
        report_apex(observer, params, tick);
    }
    work->stage++;
}

/* A falling zero crossing of one leg's angle is the apex of that leg's stance:
 * only a leg that carries the body swings backwards through the vertical. */
static void watch_apex(struct gait_observer *observer, const struct control_params *params,
                       enum side side, uint32_t tick)
{
    struct gait_state *state = &observer->state;
    const real angle = observer->angle_rad[side][tick % GAIT_HISTORY];
    const real ahead = is_person(params) && params->angle_hysteresis_rad < PERSON_AHEAD_RAD
                           ? PERSON_AHEAD_RAD
                           : params->angle_hysteresis_rad;
    if (angle > ahead) {
        observer->foot_ahead[side] = true;
    }
    if (observer->foot_ahead[side] && angle <= REAL(0.0)) {
        observer->foot_ahead[side] = false;
        observer->apex_pending[side] = observer->samples > observer->window_ticks;
        observer->apex_tick[side] = tick;
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            apex_fit_begin(&observer->fit[side][leg],
                           observer->angle_rad[leg][tick % GAIT_HISTORY]);
        }
        if (!is_person(params) && (state->phase != PHASE_SINGLE_SUPPORT || state->stance != side)) {
            enter_phase(observer, PHASE_SINGLE_SUPPORT, side, tick);
        }
        state->stance_past_apex = true;
    } else if (observer->apex_pending[side]) {
        continue_fit(observer, side, tick);
    }
    if (observer->apex_pending[side] &&
        tick - observer->apex_tick[side] >= observer->window_ticks) {
        observer->apex_pending[side] = false;
        /* A person's legs that fall back together are a bow or a sway, no step. */
        if (!is_person(params) || observer->leg[side_other(side)].contact == LEG_SWING) {
            begin_work(observer, side, tick);
        }
    }
}

/* ---- the stride's clock ------------------------------------------------------- */

/* A stride of either leg has ended: both go at one pace, so the newer one tells more. */
static void strike_clock(struct gait_observer *observer, const struct gait_event *strike)
{
    struct stride_clock *clock = &observer->clock[strike->side];
    const real stride_s = seconds_since(strike->tick, clock->strike_tick) - strike->before_tick_s +
                          clock->strike_before_s;
    const real mean = observer->stride_s;
    if (clock->started && stride_s <= STRIDE_LONGEST_S) {
        const bool anew = real_abs(stride_s - mean) > STRIDE_CHANGE_RATIO * mean;
        observer->stride_s = anew ? stride_s : mean + STRIDE_MEAN_GAIN * (stride_s - mean);
    }
    clock->started = true;
    clock->strike_tick = strike->tick;
    clock->strike_before_s = strike->before_tick_s;
}

static real stride_share(const struct gait_observer *observer, enum side side, uint32_t tick)
{
    const struct stride_clock *clock = &observer->clock[side];
    if (!clock->started || !(observer->stride_s > REAL(0.0))) {
        return REAL(-1.0);
    }
    const real since_s = seconds_since(tick, clock->strike_tick) + clock->strike_before_s;
    return since_s > STRIDE_LONGEST_S
               ? REAL(-1.0)
               : real_clamp(since_s / observer->stride_s, REAL(0.0), REAL(1.0));
}

/* ---- supports ----------------------------------------------------------------- */

static void strike(struct gait_observer *observer, const struct control_params *params,
                   enum side landed, uint32_t tick, real age_s)
{
    report(&observer->state, params, GAIT_HEEL_STRIKE, landed, tick, age_s);
    strike_clock(observer, &observer->state.event[GAIT_HEEL_STRIKE]);
    enter_phase(observer, PHASE_DOUBLE_SUPPORT, side_other(landed), tick);
}

static void lift_off(struct gait_observer *observer, const struct control_params *params,
                     enum side leaving, uint32_t tick, real age_s)
{
    report(&observer->state, params, GAIT_LIFT_OFF, leaving, tick, age_s);
    enter_phase(observer, PHASE_SINGLE_SUPPORT, side_other(leaving), tick);
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

/* A lost model starts from the samples' own angles and slopes. */
static void restart_model(struct gait_observer *observer, uint32_t tick)
{
    const struct gait_state *gait = &observer->state;
    if (observer->model.phase != MODEL_LOST || gait->phase != PHASE_SINGLE_SUPPORT ||
        tick - gait->phase_since_tick != MODEL_RESTART_TICKS) {
        return;
    }
    const uint32_t centre = tick - LEG_RATE_HALF_WINDOW;
    const real *stance = observer->angle_rad[gait->stance];
    const real *swing = observer->angle_rad[side_other(gait->stance)];
    const real state[SINGLE_SUPPORT_STATES] = {
        [STANCE_ANGLE] = stance[centre % GAIT_HISTORY],
        [SWING_ANGLE] = swing[centre % GAIT_HISTORY],
        [STANCE_RATE] = person_events_rate(stance, GAIT_HISTORY, centre),
        [SWING_RATE] = person_events_rate(swing, GAIT_HISTORY, centre)};
    model_observer_begin(&observer->model, gait->stance, tick, state,
                         (real)LEG_RATE_HALF_WINDOW * CONTROL_PERIOD_S);
}

static void watch_compass(struct gait_observer *observer, const struct control_params *params,
                          const struct controller_input *input)
{
    const struct gait_state *state = &observer->state;
    struct compass_event event;
    model_observer_advance(&observer->model, input);
    restart_model(observer, input->tick);
    if (state->phase == PHASE_UNKNOWN) {
        guess_stance(observer, params, input);
    }
    switch (state->phase) {
    case PHASE_SINGLE_SUPPORT:
        event = compass_events_strike(&observer->compass, params, input, state->stance);
        if (event.happened) {
            model_observer_strike(&observer->model, input->tick, event.age_s,
                                  input->sea[state->stance].precompression_m);
            strike(observer, params, side_other(state->stance), input->tick, event.age_s);
        }
        break;
    case PHASE_DOUBLE_SUPPORT:
        event = compass_events_lift_off(&observer->compass, params, input, state->stance,
                                        state->phase_since_tick);
        if (event.happened) {
            model_observer_lift_off(&observer->model, input->tick,
                                    input->sea[state->stance].precompression_m);
            lift_off(observer, params, state->stance, input->tick, event.age_s);
        }
        break;
    default:
        break;
    }
}

/* Forward speed at the last apexes, bounded; a slow step's when that is long ago. */
static real walking_speed(const struct gait_observer *observer, const struct control_params *params,
                          uint32_t tick)
{
    const real unit = real_sqrt(params->gravity_m_s2 / params->leg_length_m);
    const real speed = observer->walking_speed_rad_s;
    if (!(speed > REAL(0.0)) || seconds_since(tick, observer->last_apex_tick) > SPEED_FORGOTTEN_S) {
        return FIRST_SPEED_RATIO * unit;
    }
    return real_clamp(speed, LEAST_SPEED_RATIO * unit, MOST_SPEED_RATIO * unit);
}

static void watch_person(struct gait_observer *observer, const struct control_params *params,
                         const struct controller_input *input)
{
    const uint32_t tick = input->tick;
    const uint32_t centre = tick - LEG_RATE_HALF_WINDOW;
    if (observer->samples <= 2 * LEG_RATE_HALF_WINDOW) {
        return;
    }
    const real per_leg_length = REAL(1.0) / params->leg_length_m;
    struct leg_view view = {.walking_speed_rad_s = walking_speed(observer, params, tick)};
    for (int i = 0; i < SIDE_COUNT; i++) {
        const real *angle = observer->angle_rad[i];
        view.rate_rad_s = person_events_rate(angle, GAIT_HISTORY, centre);
        view.ahead_rad =
            angle[centre % GAIT_HISTORY] - observer->angle_rad[1 - i][centre % GAIT_HISTORY];
        view.extension = input->leg[i].ankle_extension_m * per_leg_length;
        view.fresh = input->leg[i].age_ticks == 0;
        const struct leg_event event = person_events_update(&observer->leg[i], &view, tick);
        if (event.kind == LEG_EVENT_STRIKE) {
            strike(observer, params, (enum side)i, tick, event.age_s);
        } else if (event.kind == LEG_EVENT_TOE_OFF) {
            lift_off(observer, params, (enum side)i, tick, event.age_s);
        }
    }
}

/* A compass walker's ankle cannot extend before the other foot lands, so from its
 * apex on nothing can go wrong; a person's can, and their swing must be at its end. */
static bool strike_near(const struct gait_observer *observer, const struct control_params *params)
{
    const struct gait_state *state = &observer->state;
    if (state->phase == PHASE_DOUBLE_SUPPORT) {
        return true;
    }
    if (is_person(params)) {
        const struct person_events *swing = &observer->leg[side_other(state->stance)];
        return swing->landing || swing->waiting.kind == LEG_EVENT_STRIKE;
    }
    return state->phase == PHASE_SINGLE_SUPPORT && state->stance_past_apex;
}

void gait_observer_update(struct gait_observer *observer, const struct control_params *params,
                          const struct controller_input *input)
{
    const uint32_t tick = input->tick;
    for (int kind = 0; kind < GAIT_EVENT_KINDS; kind++) {
        observer->state.event[kind] = (struct gait_event){0};
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        observer->angle_rad[side][tick % GAIT_HISTORY] = input->leg[side].leg_angle_rad;
    }
    if (observer->samples < UINT32_MAX) {
        observer->samples++;
    }
    if (is_person(params)) {
        watch_person(observer, params, input);
    } else {
        watch_compass(observer, params, input);
    }
    work_on_apex(observer, params, tick);
    watch_apex(observer, params, SIDE_LEFT, tick);
    watch_apex(observer, params, SIDE_RIGHT, tick);
    observer->state.strike_near = strike_near(observer, params);
    for (int side = 0; side < SIDE_COUNT; side++) {
        observer->state.stride_share[side] = stride_share(observer, (enum side)side, tick);
    }
}
