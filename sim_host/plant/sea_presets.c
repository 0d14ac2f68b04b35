#include "sim_host/plant/sea.h"

#include <stddef.h>
#include <string.h>

#include "sim_host/plant/range.h"

/* A 16-bit encoder on the motor of a 5 mm screw: 65536 counts * 200 turns/m. */
#define TWO_PI 6.283185307179586

static const double COUNTS_PER_M = 65536.0 * 200.0;

static void fill_common(const struct sea_subject *subject, struct sea_params *params)
{
    const double length_m = subject->leg_length_m;
    const double speed_m_s = __builtin_sqrt(subject->gravity_m_s2 * length_m);
    memset(params, 0, sizeof *params);
    params->spring_N_per_m = subject->spring_N_per_m;
    params->drive_period_s = 1e-4;
    params->stroke_min_m = 0.0;
    params->unload_rate_m_s = 0.58 * speed_m_s;
    params->counts_per_m = COUNTS_PER_M;
    params->release_on = SEA_RELEASE_CONTACT_OR_EXTENSION;
    params->extension_trigger_m = 2e-4 * length_m;
    params->reclose_m = 2e-4 * length_m;
    params->holding_N = 1e9;
    params->ambient_degC = 25.0;
    params->dc_link_V = 48.0;
    params->thermal_time_s = 600.0;
    params->loop_damping = 1.0;
}

static void fill_ideal(const struct sea_subject *subject, struct sea_params *params)
{
    const double length_m = subject->leg_length_m;
    params->ideal_motor = true;
    params->ideal_foot = true;
    params->stroke_max_m = 0.5 * length_m;
    params->end_stop_min_m = 0.0;
    params->end_stop_max_m = params->stroke_max_m;
    params->rated_force_N = subject->spring_N_per_m * params->stroke_max_m;
    params->motor_mass_kg = subject->total_mass_kg;
    params->loop_bandwidth_rad_s = 400.0;
    params->force_limit_N = 1e9;
    params->speed_limit_m_s = 1e9;
    params->acceleration_limit_m_s2 = 1e9;
    params->force_per_current_N_A = params->rated_force_N / 10.0;
}

/* The motor must not yield while the spring pushes off, or the step's energy is
 * not what the law commanded. Its reflected mass of four bodies is what a
 * rotor of 4.4e-5 kg m^2 shows through a 2.5 mm screw to a 70 kg person; with a
 * 60 Hz loop the drive's stiffness m w^2 is about 6,000 springs for both the
 * paper's walker and the adult. The speed limit lets the foot be back before the
 * legs pass, and the spring loaded before the next heel strike. The drive may accelerate
 * three quarters more than a controller's reference (g): with less it overshoots what it
 * is to follow and leans on its end stop; and it unloads by itself at nearly its speed limit, so
 * that a spring at full stroke is slack in less than 0.3 s. */
static void fill_real(const struct sea_subject *subject, struct sea_params *params)
{
    const double length_m = subject->leg_length_m;
    const double speed_m_s = __builtin_sqrt(subject->gravity_m_s2 * length_m);
    const double stroke_m = 0.35 * length_m;
    const double full_N = subject->spring_N_per_m * stroke_m;
    params->motor_mass_kg = 4.0 * subject->total_mass_kg;
    params->loop_bandwidth_rad_s = 377.0;
    params->loop_integral_rad_s = 60.0;
    params->coulomb_N = 0.01 * full_N;
    params->viscous_N_per_m_s = 0.05 * full_N / speed_m_s;
    params->force_limit_N = 2.5 * full_N;
    params->speed_limit_m_s = 0.6 * speed_m_s;
    params->acceleration_limit_m_s2 = 2.0 * full_N / params->motor_mass_kg;
    params->stroke_max_m = stroke_m;
    params->end_stop_min_m = -0.005 * length_m;
    params->end_stop_max_m = stroke_m + 0.005 * length_m;
    params->release_latency_s = 1e-4;
    params->rated_force_N = full_N;
    params->thermal_rise_K = 80.0;
    params->dc_link_ohm = 0.1;
    params->force_per_current_N_A = full_N / 10.0;
}

void sea_preset(enum sea_preset_kind kind, const struct sea_subject *subject,
                struct sea_params *params)
{
    fill_common(subject, params);
    if (kind == SEA_IDEAL) {
        fill_ideal(subject, params);
    } else {
        fill_real(subject, params);
    }
}

void sea_params_as_built(const struct sea_config *config, struct sea_params *params)
{
    const double peak_N = sea_config_force_N(config, config->current_peak_A);
    memset(params, 0, sizeof *params);
    params->as_built = true;
    params->built = *config;
    params->spring_N_per_m = sea_config_stiffness_N_per_m(config);
    params->drive_period_s = config->drive_period_s;
    params->motor_mass_kg = sea_config_mass_kg(config);
    params->loop_bandwidth_rad_s = config->position_gain_1_s;
    params->loop_damping = 1.0;
    params->force_limit_N = peak_N;
    params->speed_limit_m_s = config->speed_limit_m_s;
    params->acceleration_limit_m_s2 = peak_N / params->motor_mass_kg;
    params->stroke_max_m = config->stroke_max_m;
    params->end_stop_min_m = -config->end_stop_m;
    params->end_stop_max_m = config->stroke_max_m + config->end_stop_m;
    params->unload_rate_m_s = config->unload_rate_m_s;
    params->counts_per_m = config->encoder_counts_per_turn * sea_config_rad_per_m(config) / TWO_PI;
    params->release_on = SEA_RELEASE_CONTACT_OR_EXTENSION;
    params->release_latency_s = config->latch_release_s;
    params->release_jitter_s = config->latch_jitter_s;
    params->extension_trigger_m = config->latch_trigger_m;
    params->reclose_m = config->latch_reclose_m;
    params->reclose_s = config->latch_reclose_s;
    params->holding_N = config->latch_holding_N;
    params->wear_per_release = config->latch_wear_per_release;
    params->slip_m_s = config->latch_slip_m_s;
    params->rated_force_N = sea_config_force_N(config, config->current_continuous_A);
    params->thermal_time_s = config->housing_thermal_time_s;
    params->ambient_degC = config->ambient_degC;
    params->dc_link_V = config->supply_V;
    params->dc_link_ohm = config->supply_ohm;
    params->force_per_current_N_A = config->torque_constant_Nm_A * sea_config_rad_per_m(config);
}

bool sea_preset_from_name(const char *name, enum sea_preset_kind *kind)
{
    if (strcmp(name, "ideal") == 0) {
        *kind = SEA_IDEAL;
    } else if (strcmp(name, "real") == 0) {
        *kind = SEA_REAL;
    } else {
        return false;
    }
    return true;
}

const char *sea_params_check(const struct sea_params *params)
{
    const struct range ranges[] = {
        {"spring_N_per_m", params->spring_N_per_m, 1e-3, 1e7},
        {"drive_period_s", params->drive_period_s, 1e-5, 1e-2},
        {"motor_mass_kg", params->motor_mass_kg, 1e-6, 1e6},
        {"viscous_N_per_m_s", params->viscous_N_per_m_s, 0.0, 1e7},
        {"coulomb_N", params->coulomb_N, 0.0, 1e6},
        {"loop_bandwidth_rad_s", params->loop_bandwidth_rad_s, 1.0, 0.2 / params->drive_period_s},
        {"loop_damping", params->loop_damping, 0.1, 10.0},
        {"loop_integral_rad_s", params->loop_integral_rad_s, 0.0, 1e4},
        {"force_limit_N", params->force_limit_N, 1e-6, 1e9},
        {"speed_limit_m_s", params->speed_limit_m_s, 1e-6, 1e9},
        {"acceleration_limit_m_s2", params->acceleration_limit_m_s2, 1e-6, 1e9},
        {"stroke_min_m", params->stroke_min_m, -10.0, 10.0},
        {"stroke_max_m", params->stroke_max_m, params->stroke_min_m, 10.0},
        {"end_stop_min_m", params->end_stop_min_m, -10.0, params->stroke_min_m},
        {"end_stop_max_m", params->end_stop_max_m, params->stroke_max_m, 10.0},
        {"unload_rate_m_s", params->unload_rate_m_s, 1e-6, 1e3},
        {"counts_per_m", params->counts_per_m, 1.0, 1e9},
        {"zero_offset_m", params->zero_offset_m, -10.0, 10.0},
        {"release_latency_s", params->release_latency_s, 0.0, 0.05},
        {"release_jitter_s", params->release_jitter_s, 0.0, 0.05},
        {"extension_trigger_m", params->extension_trigger_m, 1e-9, 1.0},
        {"reclose_m", params->reclose_m, 0.0, 1.0},
        {"reclose_s", params->reclose_s, 0.0, 0.5},
        {"holding_N", params->holding_N, 0.0, 1e9},
        {"wear_per_release", params->wear_per_release, 0.0, 1e-3},
        {"slip_m_s", params->slip_m_s, 0.0, 10.0},
        {"rated_force_N", params->rated_force_N, 1e-6, 1e9},
        {"thermal_rise_K", params->thermal_rise_K, 0.0, 1e3},
        {"thermal_time_s", params->thermal_time_s, 1.0, 1e6},
        {"ambient_degC", params->ambient_degC, -50.0, 100.0},
        {"dc_link_V", params->dc_link_V, 0.0, 1e3},
        {"dc_link_ohm", params->dc_link_ohm, 0.0, 100.0},
        {"force_per_current_N_A", params->force_per_current_N_A, 1e-6, 1e9},
    };
    const char *bad = range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
    if (bad == NULL && (params->release_on < SEA_RELEASE_CONTACT_OR_EXTENSION ||
                        params->release_on > SEA_RELEASE_COMMAND)) {
        bad = "release_on";
    }
    return bad;
}
