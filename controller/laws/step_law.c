#include "controller/laws/step_law.h"

#include "controller/laws/law_table.h"

/* Parameters are validated; a number that a failing memory has changed since means eq. (16). */
static const struct law *row_of(const struct control_params *params)
{
    const struct law *row = law_of(params->law);
    return row != NULL ? row : &LAW_ROW(proportional);
}

void step_law_init(struct step_law *law, const struct control_params *params)
{
    const real start_rad_s = speed_table_speed(&params->table, params->start_r0_m);
    *law = (struct step_law){.command_rad_s = start_rad_s,
                             .target_speed_rad_s = start_rad_s,
                             .r0_m = params->start_r0_m,
                             .is_final = true};
    const struct law *row = row_of(params);
    if (row->init != NULL) {
        row->init(law, params);
    }
}

static real limited(const struct step_law *law, const struct control_params *params, real wanted_m)
{
    return real_clamp(step_law_approach(law->r0_m, wanted_m, params->r0_change_max_m),
                      params->r0_min_m, params->r0_max_m);
}

real step_law_update(struct step_law *law, const struct control_params *params,
                     const struct apex_estimate *estimate, real desired_rad_s)
{
    const struct law *row = row_of(params);
    const struct apex apex = {estimate->stance_rate_rad_s, estimate->swing_angle_rad,
                              estimate->swing_rate_rad_s};
    if (law->steps < UINT32_MAX) {
        law->steps++;
    }
    law->is_final = true;
    if (!real_is_finite(apex.stance_rate_rad_s) || !real_is_finite(desired_rad_s) ||
        (row->needs_branch && !real_is_finite(apex.swing_angle_rad + apex.swing_rate_rad_s))) {
        return law->r0_m;
    }
    const real wanted_m = row->step(law, params, &apex, desired_rad_s);
    law->target_speed_rad_s = law->command_rad_s;
    law->r0_m = limited(law, params, wanted_m);
    return law->r0_m;
}

bool step_law_work(struct step_law *law, const struct control_params *params)
{
    if (law->is_final) {
        return false;
    }
    const struct law *row = row_of(params);
    return row->work != NULL && row->work(law, params);
}

void step_law_finish(struct step_law *law, const struct control_params *params)
{
    const struct law *row = row_of(params);
    if (!law->is_final && row->finish != NULL) {
        row->finish(law);
    }
    law->is_final = true;
}
