/* An actuator of round numbers for tests: 1000 rad/m, 10 kg of reflected rotor, 10 kN/m on a lever of
 * 0.12 m, without friction, losses or play. */
#ifndef TESTS_SUPPORT_ROUND_ACTUATOR_H
#define TESTS_SUPPORT_ROUND_ACTUATOR_H

#include "sim_host/plant/sea_config.h"

static inline void round_actuator(struct sea_config *config)
{
    sea_config_default(config);
    config->motor_inertia_kg_m2 = 1e-5;
    config->torque_constant_Nm_A = 0.05; /* 50 N/A */
    config->resistance_ohm = 0.5;
    config->inductance_H = 1e-4;
    config->current_continuous_A = 5.0;
    config->current_peak_A = 20.0;
    config->motor_speed_max_rad_s = 900.0;
    config->winding_thermal_K_W = 1.0;
    config->winding_thermal_time_s = 20.0;
    config->housing_thermal_K_W = 4.0;
    config->housing_thermal_time_s = 800.0;
    config->travel_per_turn_m = 6.283185307179586e-3;
    config->efficiency_forward = 1.0;
    config->efficiency_backward = 1.0;
    config->spring_N_per_m = 10000.0;
    config->spring_limit_m = 0.06;
    config->lever_m = 0.12;
    config->supply_V = 48.0;
    config->supply_ohm = 0.0;
    config->supply_current_max_A = 20.0;
    config->position_gain_1_s = 80.0;
    config->speed_bandwidth_rad_s = 400.0;
    config->encoder_counts_per_turn = 1048576.0;
    config->speed_limit_m_s = 0.9;
    config->stroke_max_m = 0.05;
    config->unload_rate_m_s = 0.3;
    config->latch_holding_N = 800.0;
    config->latch_release_s = 0.004;
    config->latch_jitter_s = 0.001;
    config->latch_reclose_s = 0.005;
    config->latch_reclose_m = 0.0005;
}

#endif
