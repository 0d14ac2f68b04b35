#include "controller/laws/proportional.h"

#include "controller/laws/law_table.h"

real proportional_step(struct step_law *law, const struct control_params *params,
                       const struct apex *apex, real desired_rad_s)
{
    const real measured_rad_s = -apex->stance_rate_rad_s;
    step_law_ramp_command(law, params, desired_rad_s);
    const real feed_forward_m = speed_table_inverse(&params->table, law->command_rad_s);
    return feed_forward_m - params->kp_m_s_rad * (law->command_rad_s - measured_rad_s);
}

const struct law LAW_ROW(proportional) = {.step = proportional_step};
