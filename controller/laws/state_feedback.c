#include "controller/laws/state_feedback.h"

struct gait_branch_point state_feedback_begin(struct step_law *law,
                                              const struct control_params *params,
                                              const struct apex *apex, real desired_rad_s,
                                              real departure[3])
{
    struct gait_branch_point gait;
    step_law_ramp_command(law, params, desired_rad_s);
    const real speed_rad_s = gait_branch_at(params->branch, law->command_rad_s, &gait);
    gait_branch_departure(&gait, speed_rad_s, apex, departure);
    return gait;
}

real state_feedback_r0(const struct gait_branch_point *gait, const real gain[3],
                       const real departure[3])
{
    return gait->r0_m - (gain[0] * departure[0] + gain[1] * departure[1] + gain[2] * departure[2]);
}
