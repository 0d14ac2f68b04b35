#include "controller/laws/law_table.h"
#include "controller/laws/state_feedback.h"

static real step(struct step_law *law, const struct control_params *params, const struct apex *apex,
                 real desired_rad_s)
{
    real departure[3];
    const struct gait_branch_point gait =
        state_feedback_begin(law, params, apex, desired_rad_s, departure);
    return state_feedback_r0(&gait, gait.deadbeat_gain, departure);
}

const struct law LAW_ROW(deadbeat) = {.step = step, .needs_branch = true, .has_own_gains = true};
