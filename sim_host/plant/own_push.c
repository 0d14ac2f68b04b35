#include "sim_host/plant/own_push.h"

static double limited(double x, double low, double high)
{
    return x < low ? low : (x > high ? high : x);
}

/* Precompression of the steady gait at this speed. */
static double steady_rest_m(const struct own_push_params *params, double speed_rad_s)
{
    int i = 1;
    while (i < params->count - 1 && params->speed_rad_s[i] < speed_rad_s) {
        i++;
    }
    const double low = params->speed_rad_s[i - 1], high = params->speed_rad_s[i];
    const double part = limited((speed_rad_s - low) / (high - low), 0.0, 1.0);
    return params->rest_first_m + ((double)(i - 1) + part) * params->rest_step_m;
}

void own_push_init(struct own_push *push, const struct own_push_params *params)
{
    *push = (struct own_push){.params = *params, .speed_rad_s = params->start_rad_s, .share = 1.0};
    if (params->present) {
        push->wanted_m = steady_rest_m(params, params->start_rad_s);
    }
}

/* Energy share that stands ready in the device. */
static double ready_share(const struct own_push *push, const struct sea *sea)
{
    if (sea->latch != SEA_LATCH_CLOSED || !sea->command.latch_armed ||
        sea->command.mode != SEA_POSITION) {
        return 0.0;
    }
    const double stiffness = sea->params.spring_N_per_m / push->params.spring_N_per_m;
    const double part = sea->position_m / push->wanted_m;
    return limited(stiffness * part * part, 0.0, 1.0);
}

void own_push_tick(struct own_push *push, struct plant *plant)
{
    const struct own_push_params *params = &push->params;
    const struct walk *walk = &plant->walk;
    if (!params->present || walk->phase == WALK_DOUBLE) {
        return; /* a push under way runs to its end */
    }
    if (walk->current.apex_time_s != push->apex_time_s && walk->current.apex_time_s > 0.0) {
        push->apex_time_s = walk->current.apex_time_s;
        push->speed_rad_s += limited(params->target_rad_s - push->speed_rad_s, -params->ramp_rad_s,
                                     params->ramp_rad_s);
        const double rest_m = steady_rest_m(params, push->speed_rad_s);
        const double off_rad_s = push->speed_rad_s - walk->current.apex_speed_rad_s;
        push->wanted_m =
            limited(rest_m - params->gain_m_s_rad * off_rad_s, 0.1 * rest_m, params->rest_max_m);
    }
    push->share = 1.0 - ready_share(push, &plant->sea[walk->stance]);
    plant_set_own_push(plant, push->share > 0.01 ? push->share * params->spring_N_per_m : 0.0,
                       push->wanted_m);
}
