/* The ground under a walk of a session, the same on the map and through the chain. */
#include <math.h>

#include "sim_host/study/laws/session_internal.h"

double session_slope_rad(const struct session_config *config, int step)
{
    if (config->slope_ramp_rad <= 0.0) {
        return config->slope_rad;
    }
    const double gone = config->slope_ramp_rad * (step + 1);
    return fabs(config->slope_rad) < gone ? config->slope_rad : copysign(gone, config->slope_rad);
}

void session_ground_init(struct session_ground *ground, const struct law_setup *setup,
                         const struct session_config *config)
{
    struct laws_stride stride;
    double apex[3];
    const double r0_m = law_setup_gait(setup, config->to_rad_s, apex);
    (void)laws_stride(&setup->truth, LAWS_COARSE, apex, r0_m, 0.0, 0.0, &stride);
    ground->step_share = stride.step_length_m / setup->truth.leg_length_m;
    rng_init(&ground->rng, config->seed, 71);
}

double session_ground_rise(struct session_ground *ground, const struct session_config *config)
{
    return config->rise_most * (2.0 * rng_uniform(&ground->rng) - 1.0);
}
