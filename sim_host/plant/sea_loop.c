#include "sim_host/plant/sea_loop.h"

#include <string.h>

#include "model/tick.h"

static const double TICK_S = TICK_PERIOD_US / 1e6;

/* Low-pass of the differentiated encoder, per period of the drive. */
static const double SPEED_FILTER = 0.3;

#define TWO_PI 6.283185307179586

static double clamp(double x, double low, double high)
{
    return x < low ? low : (x > high ? high : x);
}

static double whole(double x)
{
    return (double)(long long)(x < 0.0 ? x - 0.5 : x + 0.5);
}

void sea_loop_init(struct sea_loop *loop, const struct sea_config *config)
{
    memset(loop, 0, sizeof *loop);
    const double rad_per_m = sea_config_rad_per_m(config);
    loop->mass_kg = sea_config_mass_kg(config);
    loop->force_per_A = config->torque_constant_Nm_A * rad_per_m;
    loop->counts_per_m = config->encoder_counts_per_turn * rad_per_m / TWO_PI;
}

void sea_loop_start(struct sea_loop *loop, double motor_m, double motor_m_s)
{
    loop->measured_m = whole(motor_m * loop->counts_per_m) / loop->counts_per_m;
    loop->measured_speed_m_s = motor_m_s;
    for (int i = 0; i < 3; i++) {
        loop->target_m[i] = loop->measured_m;
    }
    loop->since_tick_s = 0.0;
    loop->unload_m = loop->measured_m;
    loop->integral_m_s2 = 0.0;
}

void sea_loop_target(struct sea_loop *loop, double target_m)
{
    loop->target_m[0] = loop->target_m[1];
    loop->target_m[1] = loop->target_m[2];
    loop->target_m[2] = target_m;
    loop->since_tick_s = 0.0;
}

static void measure(struct sea_loop *loop, double motor_m, double period_s)
{
    const double now_m = whole(motor_m * loop->counts_per_m) / loop->counts_per_m;
    const double raw_m_s = (now_m - loop->measured_m) / period_s;
    loop->measured_speed_m_s += SPEED_FILTER * (raw_m_s - loop->measured_speed_m_s);
    loop->measured_m = now_m;
}

/* Where the reference is in the middle of the coming period. */
static void follow(struct sea_loop *loop, double period_s)
{
    if (loop->since_tick_s > TICK_S - 0.5 * period_s) {
        sea_loop_target(loop, loop->target_m[2]); /* none came */
    }
    const double from_m_s = (loop->target_m[1] - loop->target_m[0]) / TICK_S;
    const double to_m_s = (loop->target_m[2] - loop->target_m[1]) / TICK_S;
    const double s = loop->since_tick_s;
    loop->reference_acceleration_m_s2 = (to_m_s - from_m_s) / TICK_S;
    loop->reference_speed_m_s = from_m_s + loop->reference_acceleration_m_s2 * s;
    loop->reference_m = 0.5 * (loop->target_m[0] + loop->target_m[1]) +
                        s * (from_m_s + 0.5 * s * loop->reference_acceleration_m_s2);
    loop->since_tick_s += period_s;
    loop->unload_m = loop->reference_m;
}

static void unload(struct sea_loop *loop, const struct sea_config *config)
{
    const double step_m = config->unload_rate_m_s * config->drive_period_s;
    const double next_m = clamp(0.0, loop->unload_m - step_m, loop->unload_m + step_m);
    loop->reference_speed_m_s = (next_m - loop->unload_m) / config->drive_period_s;
    loop->reference_acceleration_m_s2 = 0.0;
    loop->reference_m = loop->unload_m = next_m;
    for (int i = 0; i < 3; i++) {
        loop->target_m[i] = next_m;
    }
}

/* The current limit of this moment, and what it costs of the I^2 t budget. */
static double limit_A(struct sea_loop *loop, const struct sea_config *config)
{
    const double steady2 = config->current_continuous_A * config->current_continuous_A;
    const double budget =
        SEA_LOOP_PEAK_S * (config->current_peak_A * config->current_peak_A - steady2);
    loop->heat_A2s += config->drive_period_s * (loop->asked_A * loop->asked_A - steady2);
    loop->heat_A2s = loop->heat_A2s > 0.0 ? loop->heat_A2s : 0.0;
    if (loop->heat_A2s > budget) {
        loop->folded_back = true;
    } else if (loop->heat_A2s < 0.5 * budget) {
        loop->folded_back = false;
    }
    return loop->folded_back ? config->current_continuous_A : config->current_peak_A;
}

double sea_loop_period(struct sea_loop *loop, const struct sea_config *config,
                       enum sea_loop_mode mode, double motor_m)
{
    const double h = config->drive_period_s;
    measure(loop, motor_m, h);
    if (mode == SEA_LOOP_OFF) {
        loop->asked_A = 0.0;
        (void)limit_A(loop, config);
        loop->current_limited = loop->speed_limited = false;
        return 0.0;
    }
    if (mode == SEA_LOOP_UNLOAD) {
        unload(loop, config);
    } else {
        follow(loop, h);
    }
    const double limit_m_s = config->speed_limit_m_s;
    const double wanted_m_s = config->feed_forward_speed * loop->reference_speed_m_s +
                              config->position_gain_1_s * (loop->reference_m - loop->measured_m);
    const double asked_m_s = clamp(wanted_m_s, -limit_m_s, limit_m_s);
    const double off_m_s = asked_m_s - loop->measured_speed_m_s;
    const double wanted_m_s2 =
        config->feed_forward_acceleration * loop->reference_acceleration_m_s2 +
        config->speed_bandwidth_rad_s * off_m_s + loop->integral_m_s2;
    const double most_A = limit_A(loop, config);
    const double wanted_A = loop->mass_kg * wanted_m_s2 / loop->force_per_A;
    loop->speed_limited = asked_m_s != wanted_m_s;
    loop->asked_A = clamp(wanted_A, -most_A, most_A);
    loop->current_limited = loop->asked_A != wanted_A;
    if (!loop->current_limited || wanted_A * off_m_s < 0.0) {
        loop->integral_m_s2 +=
            config->speed_bandwidth_rad_s * config->speed_integral_rad_s * off_m_s * h;
    }
    return loop->asked_A;
}
