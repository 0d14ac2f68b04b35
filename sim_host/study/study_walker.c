#include "sim_host/study/study_walker.h"

int study_walker(const struct gait_walker *from, double step_units, struct walker *walker,
                 struct stride_settings *settings)
{
    const struct walker_params params = {from->hip_mass_kg, from->leg_mass_kg, from->leg_length_m,
                                         from->ankle_stiffness_N_m, from->gravity_m_s2};
    if (walker_init(walker, &params) != WALKER_OK) {
        return -1;
    }
    *settings = stride_settings_fixed(walker, step_units * walker->time_unit_s);
    settings->phase_limit_s = 10.0 * walker->time_unit_s;
    return 0;
}

double study_rate_unit_m_s(const struct gait_walker *walker)
{
    return __builtin_sqrt(walker->gravity_m_s2 * walker->leg_length_m);
}
