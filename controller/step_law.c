#include "controller/step_law.h"

static real approach(real from, real to, real largest_change)
{
    return from + real_clamp(to - from, -largest_change, largest_change);
}

void step_law_init(struct step_law *law, const struct control_params *params)
{
    law->command_rad_s = speed_table_speed(&params->table, params->start_r0_m);
    law->r0_m = params->start_r0_m;
    law->mean_rad_s = REAL(0.0);
    law->steps = 0;
}

static real proportional(struct step_law *law, const struct control_params *params,
                         real measured_rad_s, real desired_rad_s)
{
    law->command_rad_s = approach(law->command_rad_s, desired_rad_s, params->speed_ramp_rad_s);
    const real feed_forward_m = speed_table_inverse(&params->table, law->command_rad_s);
    return feed_forward_m - params->kp_m_s_rad * (law->command_rad_s - measured_rad_s);
}

static real open_loop(struct step_law *law, const struct control_params *params)
{
    const real r0_m = approach(law->r0_m, params->open_loop_r0_m, params->open_loop_ramp_m);
    law->command_rad_s = speed_table_speed(&params->table, r0_m);
    return r0_m;
}

/* The mean over all steps so far, then over about the last WEARER_MEAN_STEPS; this
 * step is compared with the mean before it. */
static real wearer(struct step_law *law, const struct control_params *params, real measured_rad_s)
{
    if (law->steps <= 1) {
        law->mean_rad_s = measured_rad_s;
    }
    law->command_rad_s = law->mean_rad_s;
    const uint32_t over = law->steps < WEARER_MEAN_STEPS ? law->steps : WEARER_MEAN_STEPS;
    law->mean_rad_s += (measured_rad_s - law->mean_rad_s) / (real)over;
    return params->start_r0_m - params->kp_m_s_rad * (law->command_rad_s - measured_rad_s);
}

real step_law_update(struct step_law *law, const struct control_params *params,
                     real measured_rad_s, real desired_rad_s)
{
    if (law->steps < UINT32_MAX) {
        law->steps++;
    }
    if (!real_is_finite(measured_rad_s) || !real_is_finite(desired_rad_s)) {
        return law->r0_m;
    }
    real wanted_m;
    if (params->law == (real)LAW_OPEN_LOOP) {
        wanted_m = open_loop(law, params);
    } else if (params->law == (real)LAW_WEARER) {
        wanted_m = wearer(law, params, measured_rad_s);
    } else {
        wanted_m = proportional(law, params, measured_rad_s, desired_rad_s);
    }
    law->r0_m = real_clamp(approach(law->r0_m, wanted_m, params->r0_change_max_m), params->r0_min_m,
                           params->r0_max_m);
    return law->r0_m;
}
