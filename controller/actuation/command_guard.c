#include "controller/actuation/command_guard.h"

/* A command may rise by so much of what the reference's speed limit allows in a tick. */
#define SLEW_RATIO REAL(1.25)
/* And this much at commissioning: its fastest oscillation takes half of that limit. */
#define MOTION_SLEW_RATIO REAL(0.6)

/* The largest r0 of this walk: raised while walking, at most to the person's ceiling. */
static real largest_r0_m(const struct control_params *params)
{
    return params->r0_ceiling_m > params->r0_max_m ? params->r0_ceiling_m : params->r0_max_m;
}

void command_guard_begin(struct command_guard *guard, const struct control_params *params)
{
    guard->slew_limit_m = SLEW_RATIO * params->sea_speed_max_m_s * CONTROL_PERIOD_S;
    guard->command_limit_m = largest_r0_m(params) + params->sea_tolerance_m;
}

void command_guard_begin_motions(struct command_guard *guard, const struct control_params *params,
                                 real share)
{
    guard->slew_limit_m = MOTION_SLEW_RATIO * params->sea_speed_max_m_s * CONTROL_PERIOD_S;
    guard->command_limit_m = share * params->r0_max_m + params->sea_tolerance_m;
}

/*@ requires \valid_read(guard) && \valid_read(last) && \valid(request);
    requires \separated(request, guard) && \separated(request, last);
    assigns *request; */
static void limit(const struct command_guard *guard, const struct sea_request *last,
                  struct sea_request *request)
{
    const real lowest_m = -guard->command_limit_m;
    const real highest_m = last->precompression_m + guard->slew_limit_m;
    if (last->enable && request->precompression_m > highest_m) {
        request->precompression_m = highest_m;
    }
    /* Switched off, a drive would let its loaded spring go. */
    if (last->enable && request->precompression_m > guard->command_limit_m) {
        request->precompression_m = guard->command_limit_m;
        request->latch_armed = false;
    }
    /* Outside, or not a number. */
    if (!real_is_within(request->precompression_m, lowest_m, guard->command_limit_m)) {
        request->precompression_m = REAL(0.0);
        request->enable = false;
        request->latch_armed = false;
    }
    /*@ assert wp_within_limit: request->enable ==>
          \ge_float(request->precompression_m, lowest_m) &&
          \le_float(request->precompression_m, guard->command_limit_m); */
    /*@ assert wp_rises_slowly: request->enable && last->enable ==>
          !\gt_float(request->precompression_m, highest_m); */
}

void command_guard_limit(struct command_guard *guard, bool powered,
                         struct sea_request request[SIDE_COUNT])
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (powered) {
            limit(guard, &guard->last[side], &request[side]);
        } else {
            request[side] = (struct sea_request){REAL(0.0), false, false};
        }
        guard->last[side] = request[side];
    }
}
