#include "sim_host/plant/start_hold.h"

#include <stddef.h>

#include "sim_host/plant/range.h"

void start_hold_params_default(double leg_length_m, struct start_hold_params *params)
{
    *params = (struct start_hold_params){
        .release_tick = 1000,
        .release_grid_ticks = 100,
        .settle_ticks = 20,
        .position_tolerance_m = 5e-4 * leg_length_m,
        .least_load_m = 1e-3 * leg_length_m,
        .hold_after_fall = false,
        .fall_ticks = 500,
    };
}

const char *start_hold_params_check(const struct start_hold_params *params)
{
    const struct range ranges[] = {
        {"release_grid_ticks", (double)params->release_grid_ticks, 1.0, 1e6},
        {"settle_ticks", (double)params->settle_ticks, 0.0, 1e6},
        {"position_tolerance_m", params->position_tolerance_m, 1e-9, 1.0},
        {"least_load_m", params->least_load_m, 0.0, 1.0},
        {"fall_ticks", (double)params->fall_ticks, 0.0, 1e7},
    };
    return range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
}

void start_hold_init(struct start_hold *start_hold, const struct start_hold_params *params)
{
    *start_hold = (struct start_hold){
        .params = *params, .holding = true, .grid_origin_tick = params->release_tick};
}

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

/* The stance spring stands loaded where its drive was told to. */
static bool is_settled(const struct start_hold_params *params, const struct start_hold_view *view)
{
    /* Still enough not to leave the tolerance within a tenth of a second. */
    return view->drives_enabled && view->stance_target_m >= params->least_load_m &&
           magnitude(view->stance_position_m - view->stance_target_m) <=
               params->position_tolerance_m &&
           magnitude(view->stance_speed_m_s) <= 10.0 * params->position_tolerance_m;
}

static enum start_hold_action wait_for_load(struct start_hold *start_hold, uint64_t tick,
                                            const struct start_hold_view *view)
{
    const struct start_hold_params *params = &start_hold->params;
    if (!is_settled(params, view)) {
        start_hold->settled_ticks = 0;
        return START_HOLD_NONE;
    }
    if (start_hold->settled_ticks < params->settle_ticks) {
        start_hold->settled_ticks++;
        return START_HOLD_NONE;
    }
    if (tick < start_hold->grid_origin_tick ||
        (tick - start_hold->grid_origin_tick) % params->release_grid_ticks != 0) {
        return START_HOLD_NONE;
    }
    start_hold->holding = false;
    return START_HOLD_LET_GO;
}

enum start_hold_action start_hold_tick(struct start_hold *start_hold, uint64_t tick,
                                       const struct start_hold_view *view)
{
    if (start_hold->holding) {
        return wait_for_load(start_hold, tick, view);
    }
    if (!view->fault) {
        start_hold->fallen = false;
        return START_HOLD_NONE;
    }
    if (!start_hold->fallen) {
        start_hold->fallen = true;
        start_hold->fallen_since_tick = tick;
    }
    if (!start_hold->params.hold_after_fall ||
        tick - start_hold->fallen_since_tick < start_hold->params.fall_ticks) {
        return START_HOLD_NONE;
    }
    start_hold->holding = true;
    start_hold->fallen = false;
    start_hold->settled_ticks = 0;
    return START_HOLD_TAKE_HOLD;
}
