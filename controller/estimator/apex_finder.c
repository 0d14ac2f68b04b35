#include "controller/estimator/apex_finder.h"

#include "controller/estimator/gait_events.h"

/* Back at the fit's crossing, the model's own lies within this. */
#define LANDING_MAX_S REAL(0.02)

void apex_finder_init(struct apex_finder *finder, const struct control_params *params)
{
    *finder = (struct apex_finder){0};
    finder->window_ticks = ticks_from_seconds(params->apex_window_s);
    apex_fusion_init(&finder->fusion);
}

/* The samples of this tick and their mirror images before the crossing, of both legs. */
static void continue_fit(struct apex_finder *finder, const struct angle_history *history,
                         enum side side, uint32_t tick)
{
    const uint32_t centre = finder->apex_tick[side];
    const uint32_t before = centre - (tick - centre);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        apex_fit_add(&finder->fit[side][leg], finder->window_ticks,
                     angle_history_at(history, leg, tick), angle_history_at(history, leg, before));
    }
}

static enum apex_sign watch_leg(struct apex_finder *finder, const struct angle_history *history,
                                uint32_t samples, enum side side, real ahead_rad, uint32_t tick)
{
    const real angle = angle_history_at(history, (int)side, tick);
    if (angle > ahead_rad) {
        finder->foot_ahead[side] = true;
    }
    if (finder->foot_ahead[side] && angle <= REAL(0.0)) {
        finder->foot_ahead[side] = false;
        finder->apex_pending[side] = samples > finder->window_ticks;
        finder->apex_tick[side] = tick;
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            apex_fit_begin(&finder->fit[side][leg], angle_history_at(history, leg, tick));
        }
        return APEX_CROSSED;
    }
    if (!finder->apex_pending[side]) {
        return APEX_NONE;
    }
    continue_fit(finder, history, side, tick);
    if (tick - finder->apex_tick[side] < finder->window_ticks) {
        return APEX_NONE;
    }
    finder->apex_pending[side] = false;
    return APEX_COLLECTED;
}

void apex_finder_watch(struct apex_finder *finder, const struct angle_history *history,
                       uint32_t samples, real ahead_rad, uint32_t tick,
                       enum apex_sign sign[SIDE_COUNT])
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        sign[side] = watch_leg(finder, history, samples, (enum side)side, ahead_rad, tick);
    }
}

/* Stages of an apex's work, one a tick; between the fits and the report lie the steps
 * back in time, long ones: at 1/30 of the walker's time unit each, they cost nothing
 * in accuracy (1e-7 of the state). */
enum { STAGE_FIT = 0, STAGE_BACK = 1, BACK_STEPS = 4 };
enum { STAGE_LAND = STAGE_BACK + BACK_STEPS };

void apex_finder_begin(struct apex_finder *finder, const struct model_observer *model,
                       enum side side, uint32_t tick)
{
    struct apex_work *work = &finder->work;
    *work = (struct apex_work){.busy = true, .side = side, .centre_tick = finder->apex_tick[side]};
    work->modelled = model->phase == MODEL_SINGLE && model->stance == side;
    for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
        work->state[i] = model->state[i];
    }
    work->back_step_s = -seconds_since(tick, work->centre_tick) / (real)BACK_STEPS;
}

/* The last, short step to where the stance leg is upright; false if it leads nowhere. */
static bool land(const struct model_observer *model, struct apex_work *work)
{
    const real to_apex_s = -work->state[STANCE_ANGLE] / work->state[STANCE_RATE];
    if (!(work->state[STANCE_RATE] < REAL(0.0)) || !(real_abs(to_apex_s) < LANDING_MAX_S)) {
        return false;
    }
    work->model_before_s = -to_apex_s;
    model_observer_step(model, to_apex_s, work->state);
    return true;
}

static void report_apex(struct apex_finder *finder, const struct control_params *params,
                        const struct model_observer *model, struct gait_state *gait, uint32_t tick)
{
    const struct apex_work *work = &finder->work;
    const struct apex_estimate fit = {-work->fit.speed_rad_s, work->swing_fit.angle_rad,
                                      work->swing_fit.rate_rad_s, REAL(0.0)};
    const struct apex_estimate modelled = {work->state[STANCE_RATE], work->state[SWING_ANGLE],
                                           work->state[SWING_RATE], REAL(1.0)};
    const struct apex_noise noise = {model->noise_rad2, model->slow_rad2};
    gait->apex =
        apex_fusion_decide(&finder->fusion, work->side, &fit, work->modelled ? &modelled : NULL,
                           &noise, finder->window_ticks);
    const real before_s = work->fit.before_tick_s +
                          gait->apex.confidence * (work->model_before_s - work->fit.before_tick_s);
    gait_events_report(gait, params, GAIT_APEX, work->side, tick,
                       seconds_since(tick, work->centre_tick) + before_s);
    gait->event[GAIT_APEX].speed_rad_s = -gait->apex.stance_rate_rad_s;
}

bool apex_finder_work(struct apex_finder *finder, const struct control_params *params,
                      const struct model_observer *model, struct gait_state *gait, uint32_t tick)
{
    struct apex_work *work = &finder->work;
    bool reported = false;
    if (!work->busy) {
        return false;
    }
    if (work->stage == STAGE_FIT) {
        const struct apex_sums *fit = finder->fit[work->side];
        work->fit = apex_fit_solve(&fit[work->side], finder->window_ticks);
        work->swing_fit = apex_fit_other_leg(&fit[side_other(work->side)], finder->window_ticks,
                                             work->fit.before_tick_s);
        work->busy = work->fit.speed_rad_s > REAL(0.0);
        work->stage = work->modelled ? work->stage : STAGE_LAND - 1;
    } else if (work->stage < STAGE_LAND) {
        model_observer_step(model, work->back_step_s, work->state);
    } else if (work->stage == STAGE_LAND) {
        work->modelled = work->modelled && land(model, work);
    } else { /* in a tick of its own: the law and its telegram come with it */
        work->busy = false;
        report_apex(finder, params, model, gait, tick);
        reported = true;
    }
    work->stage++;
    return reported;
}
