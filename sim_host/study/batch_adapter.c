#include "sim_host/study/batch_adapter.h"

struct batch_walker batch_adapter_walker(const struct walker_params *params)
{
    const struct batch_walker walker = {params->hip_mass_kg, params->leg_mass_kg,
                                        params->leg_length_m, params->ankle_stiffness_N_m,
                                        params->gravity_m_s2};
    return walker;
}

void batch_adapter_push(const struct problem *problem, struct batch_item *item)
{
    item->push_m = problem_push_off(problem, item->apex[0]);
}

void batch_adapter_by_apex(const struct problem *problem, const struct batch_slopes *slopes,
                           double by_x[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            by_x[i][j] = slopes->by_apex[i][j] - (j == 0 ? problem->kp * slopes->by_push[i] : 0.0);
        }
    }
}
