/* Whether an actuator can be built for what it is to do: each refusal names the values that do not go
 * together, in units, and what would. */
#include <stdio.h>

#include "sim_host/plant/sea_config.h"
#include "sim_host/plant/sea_spring.h"

/* An ankle does not plantarflex beyond this, rad (60 degrees). */
#define ANKLE_RANGE_RAD 1.05

/* A trapezium of speed with a third of the time each for starting, running and braking is 3/2 of the
 * mean at its fastest. */
#define PEAK_OVER_MEAN 1.5

struct refusal {
    char *text;
    size_t size;
};

#define REFUSE(refusal, ...) ((void)snprintf((refusal)->text, (refusal)->size, __VA_ARGS__), -1)

static int check_stroke(const struct sea_config *config, const struct sea_duty *duty,
                        const struct refusal *refusal)
{
    const double way_m = sea_config_way_at_m(config, ANKLE_RANGE_RAD);
    if (config->stroke_max_m > way_m) {
        return REFUSE(refusal,
                      "stroke over lever: stroke_max_m is %g m, and a lever of %g m moves the "
                      "spring's end by %.3g m at most, at 60 degrees of plantarflexion",
                      config->stroke_max_m, config->lever_m, way_m);
    }
    if (config->stroke_max_m > config->spring_limit_m) {
        return REFUSE(refusal,
                      "stroke over spring: stroke_max_m is %g m, and the spring is solid at "
                      "spring_limit_m, %g m",
                      config->stroke_max_m, config->spring_limit_m);
    }
    if (duty->precompression_m > config->stroke_max_m) {
        return REFUSE(refusal,
                      "precompression over stroke: %g m is prescribed, and stroke_max_m is %g m",
                      duty->precompression_m, config->stroke_max_m);
    }
    return 0;
}

static int check_force(const struct sea_config *config, double force_N, const struct sea_duty *duty,
                       const struct refusal *refusal)
{
    const double most_N = sea_config_force_N(config, config->current_peak_A);
    if (force_N > most_N) {
        return REFUSE(refusal,
                      "spring over motor: the spring needs %.4g N at %g m of precompression, and "
                      "the motor gives %.4g N at current_peak_A, %g A",
                      force_N, duty->precompression_m, most_N, config->current_peak_A);
    }
    if (force_N > config->latch_holding_N) {
        return REFUSE(refusal,
                      "spring over latch: the spring pushes with %.4g N at %g m of "
                      "precompression, and latch_holding_N is %g N",
                      force_N, duty->precompression_m, config->latch_holding_N);
    }
    return 0;
}

static int check_speed(const struct sea_config *config, double middle_N,
                       const struct sea_duty *duty, const struct refusal *refusal)
{
    const double needed_m_s = PEAK_OVER_MEAN * duty->precompression_m / duty->load_s;
    const double permitted_m_s = config->motor_speed_max_rad_s / sea_config_rad_per_m(config);
    const double able_m_s = sea_config_speed_at_m_s(config, middle_N);
    if (needed_m_s > permitted_m_s) {
        return REFUSE(refusal,
                      "speed over motor: %g m in %.3g s needs %.3g m/s of spring, and "
                      "motor_speed_max_rad_s permits %.3g m/s",
                      duty->precompression_m, duty->load_s, needed_m_s, permitted_m_s);
    }
    if (needed_m_s > able_m_s) {
        return REFUSE(refusal,
                      "speed over supply: %g m in %.3g s needs %.3g m/s of spring, and at the "
                      "spring's %.4g N the supply's %g V drive the motor at %.3g m/s",
                      duty->precompression_m, duty->load_s, needed_m_s, middle_N, config->supply_V,
                      able_m_s);
    }
    if (needed_m_s > config->speed_limit_m_s) {
        return REFUSE(refusal,
                      "speed over drive: %g m in %.3g s needs %.3g m/s of spring, and "
                      "speed_limit_m_s is %.3g m/s",
                      duty->precompression_m, duty->load_s, needed_m_s, config->speed_limit_m_s);
    }
    return 0;
}

/* Where the motor runs at its fastest against half the way's force. */
static int check_power(const struct sea_config *config, double middle_N,
                       const struct sea_duty *duty, const struct refusal *refusal)
{
    const double speed_m_s = PEAK_OVER_MEAN * duty->precompression_m / duty->load_s;
    const double current_A = sea_config_current_A(config, middle_N);
    const double torque_Nm = config->torque_constant_Nm_A * current_A;
    const double power_W = torque_Nm * speed_m_s * sea_config_rad_per_m(config) +
                           current_A * current_A * config->resistance_ohm;
    const double most_W = config->supply_current_max_A *
                          (config->supply_V - config->supply_ohm * config->supply_current_max_A);
    if (power_W > most_W) {
        return REFUSE(refusal,
                      "energy over supply: loading %g m in %.3g s takes %.3g W, and the supply "
                      "gives %.3g W at supply_current_max_A, %g A",
                      duty->precompression_m, duty->load_s, power_W, most_W,
                      config->supply_current_max_A);
    }
    return 0;
}

/* A third of the time for starting: 9/2 way / time^2. */
static int check_rotor(const struct sea_config *config, const struct sea_duty *duty,
                       const struct refusal *refusal)
{
    const double needed_m_s2 =
        3.0 * PEAK_OVER_MEAN * duty->precompression_m / (duty->load_s * duty->load_s);
    const double able_m_s2 = sea_config_acceleration_m_s2(config, 0.0);
    if (needed_m_s2 > able_m_s2) {
        return REFUSE(
            refusal,
            "rotor over motor: %g m in %.3g s needs %.3g m/s^2, and at current_peak_A, %g A, rotor "
            "and screw, worth %.4g kg at the spring, start with %.3g m/s^2",
            duty->precompression_m, duty->load_s, needed_m_s2, config->current_peak_A,
            sea_config_mass_kg(config), able_m_s2);
    }
    return 0;
}

/* A cuff in series with a stiffer spring takes more than half of the push. */
static int check_cuff(const struct sea_config *config, const struct refusal *refusal)
{
    const double stiffness_N_per_m = sea_config_stiffness_N_per_m(config);
    if (config->cuff_N_per_m > 0.0 && config->cuff_N_per_m < stiffness_N_per_m) {
        return REFUSE(
            refusal,
            "spring over cuff: cuff_N_per_m is %g N/m, softer than the spring's %.4g N/m: less than "
            "half of the push would arrive",
            config->cuff_N_per_m, stiffness_N_per_m);
    }
    return 0;
}

/* The battery lasts for some minutes of pushes at least: a stride takes 2.5 times the time to load. */
#define LEAST_S 600.0
#define STRIDE_OVER_LOAD 2.5

static int check_energy(const struct sea_config *config, double force_N,
                        const struct sea_duty *duty, const struct refusal *refusal)
{
    const double push_J = 0.5 * force_N * duty->precompression_m / config->efficiency_forward;
    const double needed_Wh = push_J * LEAST_S / (STRIDE_OVER_LOAD * duty->load_s) / 3600.0;
    if (config->supply_energy_Wh > 0.0 && config->supply_energy_Wh < needed_Wh) {
        return REFUSE(
            refusal,
            "energy over supply: ten minutes of pushes of %.3g J take %.3g W h a leg, and "
            "supply_energy_Wh is %g W h",
            push_J, needed_Wh, config->supply_energy_Wh);
    }
    return 0;
}

double sea_config_stiffness_N_per_m(const struct sea_config *config)
{
    struct sea_spring spring;
    sea_spring_init(&spring, config);
    return sea_spring_force_N(&spring, config->stroke_max_m) / config->stroke_max_m;
}

int sea_config_can_be_built(const struct sea_config *config, const struct sea_duty *duty,
                            char *message, size_t size)
{
    const struct refusal refusal = {message, size};
    struct sea_spring spring;
    sea_spring_init(&spring, config);
    sea_spring_move(&spring, duty->precompression_m); /* going in: with its hysteresis */
    const double force_N = sea_spring_force_N(&spring, duty->precompression_m);
    const double middle_N = sea_spring_force_N(&spring, 0.5 * duty->precompression_m);
    return check_stroke(config, duty, &refusal) == 0 &&
                   check_force(config, force_N, duty, &refusal) == 0 &&
                   check_speed(config, middle_N, duty, &refusal) == 0 &&
                   check_rotor(config, duty, &refusal) == 0 && check_cuff(config, &refusal) == 0 &&
                   check_power(config, middle_N, duty, &refusal) == 0 &&
                   check_energy(config, force_N, duty, &refusal) == 0
               ? 0
               : -1;
}
