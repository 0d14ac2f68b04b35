#include "sim_host/plant/sea_motor.h"

#include <string.h>

/* The data sheet's resistance is told at this temperature. */
#define RESISTANCE_DEGC 25.0

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

void sea_motor_init(struct sea_motor *motor, const struct sea_config *config)
{
    const double rad_per_m = sea_config_rad_per_m(config);
    memset(motor, 0, sizeof *motor);
    motor->rad_per_m = rad_per_m;
    motor->mass_kg = sea_config_mass_kg(config);
    motor->force_per_A = config->torque_constant_Nm_A * rad_per_m;
    motor->coulomb_N = config->motor_coulomb_Nm * rad_per_m + config->transmission_coulomb_N;
    motor->viscous_Ns_m =
        config->motor_viscous_Nms_rad * rad_per_m * rad_per_m + config->transmission_viscous_Ns_m;
    motor->load_mean = 0.5 * (1.0 / config->efficiency_forward + config->efficiency_backward);
    motor->load_half = 0.5 * (1.0 / config->efficiency_forward - config->efficiency_backward);
    motor->end_min_m = -config->end_stop_m;
    motor->end_max_m = config->stroke_max_m + config->end_stop_m;
    motor->bus_V = config->supply_V;
    motor->winding_degC = motor->housing_degC = config->ambient_degC;
}

static double resistance_ohm(const struct sea_motor *motor, const struct sea_config *config)
{
    return config->resistance_ohm *
           (1.0 + config->resistance_per_K * (motor->winding_degC - RESISTANCE_DEGC));
}

/* Current after the step; motor->voltage_V is what it took. */
static double next_current_A(struct sea_motor *motor, const struct sea_config *config,
                             double asked_A, double ohm, double step_s)
{
    const double before_A = motor->current_A;
    const double way = 0.5 * config->current_bandwidth_rad_s * step_s;
    const double back_V = motor->force_per_A * motor->speed_m_s;
    const double henry_s = config->inductance_H / step_s;
    double after_A = (before_A * (1.0 - way) + 2.0 * way * asked_A) / (1.0 + way);
    motor->voltage_V = henry_s * (after_A - before_A) + 0.5 * ohm * (after_A + before_A) + back_V;
    motor->voltage_limited = magnitude(motor->voltage_V) > motor->bus_V;
    if (motor->voltage_limited) {
        motor->voltage_V = motor->voltage_V > 0.0 ? motor->bus_V : -motor->bus_V;
        after_A =
            (before_A * (henry_s - 0.5 * ohm) + motor->voltage_V - back_V) / (henry_s + 0.5 * ohm);
    }
    return after_A;
}

/* u_bus^2 - supply_V u_bus + supply_ohm P = 0; beyond the supply's greatest power it stays at half. */
static void sag(struct sea_motor *motor, const struct sea_config *config, double power_W)
{
    const double root = config->supply_V * config->supply_V - 4.0 * config->supply_ohm * power_W;
    motor->bus_V = 0.5 * (config->supply_V + (root > 0.0 ? __builtin_sqrt(root) : 0.0));
}

/* Speed after the step; friction stops the motor, and does not turn it round. */
static double next_speed_m_s(struct sea_motor *motor, double drive_N, double load_N, double step_s)
{
    const double v = motor->speed_m_s;
    const double dry_N = motor->coulomb_N + motor->load_half * magnitude(load_N);
    const double free_N = drive_N - motor->load_mean * load_N;
    const double half = 0.5 * step_s * motor->viscous_Ns_m / motor->mass_kg;
    double way = v > 0.0 ? 1.0 : -1.0;
    if (v == 0.0) {
        if (magnitude(free_N) <= dry_N) {
            return 0.0;
        }
        way = free_N > 0.0 ? 1.0 : -1.0;
    }
    const double after =
        (v * (1.0 - half) + step_s * (free_N - way * dry_N) / motor->mass_kg) / (1.0 + half);
    return v * after < 0.0 && magnitude(free_N) <= dry_N ? 0.0 : after;
}

static void stop_at_ends(struct sea_motor *motor)
{
    const bool beyond = motor->position_m >= motor->end_max_m && motor->speed_m_s >= 0.0;
    const bool below = motor->position_m <= motor->end_min_m && motor->speed_m_s <= 0.0;
    motor->at_end_stop = beyond || below;
    if (motor->at_end_stop) {
        motor->end_stop_J += 0.5 * motor->mass_kg * motor->speed_m_s * motor->speed_m_s;
        motor->position_m = beyond ? motor->end_max_m : motor->end_min_m;
        motor->speed_m_s = 0.0;
    }
}

void sea_motor_step(struct sea_motor *motor, const struct sea_config *config, double asked_A,
                    bool powered, double load_N, double step_s)
{
    const double ohm = resistance_ohm(motor, config);
    const double before_A = motor->current_A, before_m_s = motor->speed_m_s;
    const double before_m = motor->position_m;
    double after_A = 0.0;
    if (powered) {
        after_A = next_current_A(motor, config, asked_A, ohm, step_s);
    } else {
        motor->voltage_V = 0.0;
        motor->voltage_limited = false;
    }
    const double current_A = powered ? 0.5 * (before_A + after_A) : 0.0;
    motor->current_A = after_A;
    motor->force_N = motor->force_per_A * current_A;
    motor->speed_m_s = next_speed_m_s(motor, motor->force_N, load_N, step_s);
    motor->position_m += 0.5 * step_s * (before_m_s + motor->speed_m_s);
    motor->friction_N =
        motor->force_N - load_N - motor->mass_kg * (motor->speed_m_s - before_m_s) / step_s;
    stop_at_ends(motor);
    const double way_m = motor->position_m - before_m;
    const double power_W = motor->voltage_V * current_A;
    motor->supplied_J += power_W * step_s;
    motor->copper_J += ohm * current_A * current_A * step_s;
    motor->friction_J += motor->friction_N * way_m;
    motor->load_J += load_N * way_m;
    sag(motor, config, power_W + motor->other_W);
}

void sea_motor_warm(struct sea_motor *motor, const struct sea_config *config, double copper_W,
                    double period_s)
{
    const double out_W = (motor->winding_degC - motor->housing_degC) / config->winding_thermal_K_W;
    const double lost_W =
        (motor->housing_degC - config->ambient_degC) / config->housing_thermal_K_W;
    motor->winding_degC += period_s * (copper_W - out_W) * config->winding_thermal_K_W /
                           config->winding_thermal_time_s;
    motor->housing_degC +=
        period_s * (out_W - lost_W) * config->housing_thermal_K_W / config->housing_thermal_time_s;
}

double sea_motor_energy_J(const struct sea_motor *motor, const struct sea_config *config)
{
    return 0.5 * motor->mass_kg * motor->speed_m_s * motor->speed_m_s +
           0.5 * config->inductance_H * motor->current_A * motor->current_A;
}
