#include "controller/estimator/arm_window.h"

#define LAG_MEAN_GAIN REAL(0.3)
/* A contact further than this from the slowing belongs to something else. */
#define LAG_MOST_S REAL(0.25)
enum { LEARNED_LEAST = 2 };

static bool has_switches(const struct control_params *params)
{
    return params->foot_switches > REAL(0.5);
}

static void learn(struct arm_window *window)
{
    /* A contact ahead of the slowing is one at the slowing: there is no earlier time to open at. */
    const real lag_s = window->edge_tick > window->slowing_tick
                           ? seconds_since(window->edge_tick, window->slowing_tick)
                           : REAL(0.0);
    if (lag_s > LAG_MOST_S) {
        return;
    }
    window->lag_s =
        window->learned == 0 ? lag_s : window->lag_s + LAG_MEAN_GAIN * (lag_s - window->lag_s);
    if (window->learned < UINT8_MAX) {
        window->learned++;
    }
}

static void begin(struct arm_window *window, uint32_t tick)
{
    window->slowing_tick = tick;
    window->edge_tick = 0;
    window->strike_tick = 0;
    window->closed = false;
}

/* The contact of this swing: its edge may come some ticks ahead of the slowing. */
static bool is_contact_of_step(const struct arm_window *window, const struct arm_view *view,
                               uint32_t tick)
{
    return view->contact_tick != 0 && window->edge_tick == 0 && window->slowing_tick != 0 &&
           seconds_since(tick, view->contact_tick) <= ARM_BEHIND_S;
}

static bool has_left(const struct arm_window *window, const struct control_params *params,
                     const struct arm_view *view, uint32_t tick)
{
    if (!view->own_leg_turns_back) {
        return true;
    }
    if (!has_switches(params)) {
        return window->strike_tick != 0 &&
               seconds_since(tick, window->strike_tick) > ARM_BEHIND_S + params->strike_error_s;
    }
    return view->own_foot != FOOT_DOWN ||
           (window->edge_tick != 0 && seconds_since(tick, window->edge_tick) > ARM_BEHIND_S) ||
           seconds_since(tick, window->slowing_tick) > window->lag_s + ARM_LATE_S;
}

void arm_window_update(struct arm_window *window, const struct control_params *params,
                       const struct arm_view *view, uint32_t tick)
{
    if (view->slowing && !window->was_slowing) {
        begin(window, tick);
    }
    window->was_slowing = view->slowing || (window->was_slowing && view->swings);
    if (is_contact_of_step(window, view, tick)) {
        window->edge_tick = view->contact_tick;
        learn(window);
    }
    if (window->slowing_tick != 0 && has_left(window, params, view, tick)) {
        window->closed = true;
    }
}

void arm_window_strike(struct arm_window *window, uint32_t tick, real age_s)
{
    const uint32_t age = ticks_from_seconds(age_s > REAL(0.0) ? age_s : REAL(0.0));
    window->strike_tick = tick > age ? tick - age : 1;
}

void arm_window_toe_off(struct arm_window *window, uint32_t tick, real age_s, uint32_t up_tick)
{
    window->closed = true;
    if (window->strike_tick == 0) {
        return; /* its beginning was not found: the one before counts */
    }
    const real found_s = seconds_since(tick, window->strike_tick) - age_s;
    const real told_s = window->edge_tick != 0 && up_tick > window->edge_tick
                            ? seconds_since(up_tick, window->edge_tick)
                            : REAL(0.0);
    const real support_s = found_s > told_s ? found_s : told_s;
    if (support_s < ARM_SUPPORT_MOST_S) {
        window->support_s = support_s;
    }
}

bool arm_window_has_time(const struct arm_window *window)
{
    return window->support_s >= ARM_SUPPORT_LEAST_S;
}

bool arm_window_is_open(const struct arm_window *window, const struct control_params *params,
                        uint32_t tick)
{
    if (window->slowing_tick == 0 || window->closed) {
        return false;
    }
    if (!has_switches(params)) {
        return params->strike_error_s > REAL(0.0) && window->strike_tick != 0 &&
               seconds_since(tick, window->strike_tick) >= params->strike_error_s;
    }
    return window->learned >= LEARNED_LEAST &&
           seconds_since(tick, window->slowing_tick) + ARM_LEAD_S >= window->lag_s;
}
