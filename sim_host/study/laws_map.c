#include "sim_host/study/laws_map.h"

#include "model/stride.h"

int laws_stride(const struct gait_walker *gait_walker, enum laws_accuracy accuracy,
                const double apex[3], double r0_m, double slope_rad, double rise,
                struct laws_stride *result)
{
    const struct walker_params params = {
        gait_walker->hip_mass_kg, gait_walker->leg_mass_kg, gait_walker->leg_length_m,
        gait_walker->ankle_stiffness_N_m, gait_walker->gravity_m_s2};
    const struct apex from = {apex[0], apex[1], apex[2]};
    const struct ground ground = {slope_rad, rise};
    struct walker walker;
    struct stride_result r;
    *result = (struct laws_stride){.fault = STRIDE_BAD_INPUT};
    if (walker_init(&walker, &params) != WALKER_OK) {
        return result->fault;
    }
    struct stride_settings settings = stride_settings_accurate(&walker);
    if (accuracy == LAWS_COARSE) {
        settings = stride_settings_fixed(&walker, 0.08 * walker.time_unit_s);
        settings.phase_limit_s = 10.0 * walker.time_unit_s;
    }
    result->fault = (int)stride_on_ground(&walker, &settings, &from, r0_m, &ground, &r);
    result->next[0] = r.next.stance_rate_rad_s;
    result->next[1] = r.next.swing_angle_rad;
    result->next[2] = r.next.swing_rate_rad_s;
    result->apex_to_strike_s = r.apex_to_strike_s;
    result->double_support_s = r.double_support_s;
    result->lift_off_to_apex_s = r.lift_off_to_apex_s;
    result->step_length_m = r.step_length_m;
    result->after_collision[0] = r.inter_leg_rad;
    result->after_collision[1] = r.ankle_rate_m_s;
    return result->fault;
}

const char *laws_fault_name(int fault)
{
    return stride_fault_name((enum stride_fault)fault);
}
