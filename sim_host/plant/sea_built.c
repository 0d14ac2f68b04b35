#include "sim_host/plant/sea_built.h"

#include <string.h>

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

static void raise(double *most, double value)
{
    *most = value > *most ? value : *most;
}

static void lower(double *least, double value)
{
    *least = value < *least ? value : *least;
}

void sea_built_clear_load(struct sea_built *built)
{
    built->load = (struct sea_load){.lowest_bus_V = built->motor.bus_V,
                                    .least_voltage_V = built->motor.bus_V,
                                    .hottest_degC = built->motor.winding_degC};
}

void sea_built_init(struct sea_built *built, const struct sea_config *config)
{
    memset(built, 0, sizeof *built);
    built->config = *config;
    built->spring_scale = 1.0;
    built->spring_N_per_m = sea_config_stiffness_N_per_m(config);
    sea_motor_init(&built->motor, config);
    built->next = built->motor;
    sea_loop_init(&built->loop, config);
    sea_spring_init(&built->held, config);
    sea_spring_init_with_cuff(&built->pushing, config);
    sea_built_clear_load(built);
}

double sea_built_compression_m(const struct sea_built *built, double motor_m, double output_m)
{
    const double way_m = motor_m - output_m;
    const double play_m = built->config.backlash_m;
    if (way_m > play_m) {
        return way_m - play_m;
    }
    return way_m < 0.0 ? way_m : 0.0; /* the play lies on the pushing side */
}

static const struct sea_spring *spring_of(const struct sea_built *built, bool latched)
{
    return latched ? &built->held : &built->pushing;
}

double sea_built_force_N(const struct sea_built *built, bool latched, double compression_m)
{
    return sea_spring_force_N(spring_of(built, latched), compression_m);
}

double sea_built_energy_J(const struct sea_built *built, bool latched, double compression_m)
{
    return sea_spring_energy_J(spring_of(built, latched), compression_m);
}

/* What the period adds to the load. */
static void account(struct sea_built *built, double period_s, double current_A, double spring_N)
{
    struct sea_load *load = &built->load;
    const struct sea_motor *motor = &built->next;
    const double supply_A = (motor->voltage_V * current_A + motor->other_W) / motor->bus_V;
    load->time_s += period_s;
    load->current_squares_A2s += current_A * current_A * period_s;
    raise(&load->peak_current_A, magnitude(current_A));
    raise(&load->peak_speed_m_s, magnitude(motor->speed_m_s));
    raise(&load->peak_spring_N, spring_N);
    raise(&load->peak_supply_A, supply_A);
    raise(&load->hottest_degC, motor->winding_degC);
    lower(&load->lowest_bus_V, motor->bus_V);
    lower(&load->least_voltage_V, motor->bus_V - magnitude(motor->voltage_V));
    load->current_limited_s += built->loop.current_limited ? period_s : 0.0;
    load->voltage_limited_s += motor->voltage_limited ? period_s : 0.0;
    load->end_stop_s += motor->at_end_stop ? period_s : 0.0;
}

void sea_built_period(struct sea_built *built, enum sea_loop_mode mode, bool latched,
                      double output_m)
{
    const struct sea_config *config = &built->config;
    const double period_s = config->drive_period_s;
    struct sea_spring *spring = latched ? &built->held : &built->pushing;
    struct sea_motor *next = &built->next;
    const double asked_A = sea_loop_period(&built->loop, config, mode, built->motor.position_m);
    const int steps = (int)(period_s / config->substep_s + 0.999999);
    const double step_s = period_s / (double)steps;
    *next = built->motor;
    for (int i = 0; i < steps; i++) {
        const double middle_m = next->position_m + 0.5 * step_s * next->speed_m_s;
        const double compression_m = sea_built_compression_m(built, middle_m, output_m);
        sea_spring_move(spring, compression_m);
        sea_motor_step(next, config, asked_A, mode != SEA_LOOP_OFF,
                       built->spring_scale * sea_spring_force_N(spring, compression_m), step_s);
    }
    sea_motor_warm(next, config, (next->copper_J - built->motor.copper_J) / period_s, period_s);
    account(built, period_s, 0.5 * (built->motor.current_A + next->current_A),
            built->spring_scale * sea_spring_force_N(spring, spring->at_m));
}

void sea_built_finish(struct sea_built *built)
{
    built->motor = built->next;
}

void sea_built_release(struct sea_built *built, double output_m)
{
    const double compression_m = sea_built_compression_m(built, built->motor.position_m, output_m);
    built->pushing.wave = built->held.wave;
    built->pushing.at_m = compression_m;
    built->snap_J += sea_built_energy_J(built, true, compression_m) -
                     sea_built_energy_J(built, false, compression_m);
}

static double drawn_W(struct sea_built *built, double period_s)
{
    const double drawn_J = built->motor.supplied_J - built->shared_from_J;
    built->shared_from_J = built->motor.supplied_J;
    return drawn_J / period_s;
}

void sea_built_share(struct sea_built *left, struct sea_built *right, double period_s)
{
    if (left->config.supply_shared < 0.5 || right->config.supply_shared < 0.5) {
        return;
    }
    const double left_W = drawn_W(left, period_s), right_W = drawn_W(right, period_s);
    left->motor.other_W = right_W;
    right->motor.other_W = left_W;
}

double sea_built_rms_A(const struct sea_built *built)
{
    return built->load.time_s > 0.0
               ? __builtin_sqrt(built->load.current_squares_A2s / built->load.time_s)
               : 0.0;
}
