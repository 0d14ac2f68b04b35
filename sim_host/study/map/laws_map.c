#include "sim_host/study/map/laws_map.h"

#include "sim_host/study/study_walker.h"

int laws_stride(const struct gait_walker *gait_walker, enum laws_accuracy accuracy,
                const double apex[3], double r0_m, double slope_rad, double rise,
                struct laws_stride *result)
{
    const struct apex from = {apex[0], apex[1], apex[2]};
    const struct ground ground = {slope_rad, rise};
    struct walker walker;
    struct stride_settings settings;
    struct stride_result r;
    *result = (struct laws_stride){.fault = STRIDE_BAD_INPUT};
    if (study_walker(gait_walker, STUDY_COARSE_UNITS, &walker, &settings) != 0) {
        return result->fault;
    }
    if (accuracy == LAWS_FINE) {
        settings = stride_settings_accurate(&walker);
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
