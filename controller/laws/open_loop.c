#include "controller/laws/law_table.h"
#include "controller/laws/step_law.h"

static real step(struct step_law *law, const struct control_params *params, const struct apex *apex,
                 real desired_rad_s)
{
    (void)apex;
    (void)desired_rad_s;
    const real r0_m =
        step_law_approach(law->r0_m, params->open_loop_r0_m, params->open_loop_ramp_m);
    law->command_rad_s = speed_table_speed(&params->table, r0_m);
    return r0_m;
}

const struct law LAW_ROW(open_loop) = {.step = step};
