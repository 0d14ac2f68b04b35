/* What an actuator has to bear in walking: one leg, stride after stride at a cadence, with the
 * controller's own reference; and how far that is from its limits.
 *
 * The ankle moves as ankle_curve.h says. The spring is loaded from the own heel strike on, behind a closed
 * latch; it is armed when it is loaded, released when the other heel strikes, unloaded when the push is
 * over. A spring that is not loaded when the other heel strikes is not released: no push. Where both legs
 * share a battery, the other leg draws what this one drew half a stride ago.
 */
#ifndef SIM_HOST_STUDY_SIZE_SIZE_H
#define SIM_HOST_STUDY_SIZE_SIZE_H

#include <stdbool.h>

#include "controller/control_params.h"
#include "sim_host/plant/sea_config.h"

enum { SIZE_STRIDES = 12, SIZE_SETTLE = 2 }; /* strides that count, and before them */

struct size_setup {
    struct sea_config config;
    struct control_params params; /* reference's limits; start_r0_m is the push-off */
    unsigned long long seed;
};

#define SIZE_HOTTEST_DEGC 1000.0

/* One cadence. Shares of limits: 0 = unused, 1 = at the limit, above 1 = beyond. */
struct size_row {
    double cadence_1_min;                        /* steps a minute */
    int pushes;                                  /* given, of SIZE_STRIDES */
    double peak_torque_Nm, work_J, peak_power_W; /* at the ankle, mean of the pushes */
    double release_share;                        /* of the stride */
    double spare_s; /* between loaded and the other's heel strike; below 0: too late */
    double rms_A, peak_A;
    double push_V;    /* of the bus at the release */
    double reserve_V; /* least reserve of the bus' voltage over what the motor takes */
    double lowest_bus_V, peak_supply_A, mean_supply_W;
    double hour_degC; /* winding after an hour; above SIZE_HOTTEST_DEGC it ran away */
    double swing_Nm;  /* largest torque from 50 ms after toe-off to 50 % of the next stance */
    double peak_speed_m_s, peak_spring_N;
    double current_limited_s, voltage_limited_s; /* a stride */
};

/* What may limit, by the part of it that is used. */
enum size_limit {
    SIZE_PEAK_CURRENT = 0,
    SIZE_RMS_CURRENT = 1,
    SIZE_WINDING = 2,
    SIZE_VOLTAGE = 3,
    SIZE_SPEED = 4,
    SIZE_SUPPLY = 5,
    SIZE_LATCH = 6,
    SIZE_TIME = 7,
    SIZE_LIMITS = 8
};

/* In the words of a report; never NULL. */
const char *size_limit_name(enum size_limit limit);

/* Walks one leg at the cadence. Some ten milliseconds of processor time. */
void size_walk(const struct size_setup *setup, double cadence_1_min, struct size_row *row);

/* Whether every push-off was given, and no limit is used beyond 1. */
bool size_holds(const struct size_setup *setup, const struct size_row *row);

/* Used part of each limit. */
void size_shares(const struct size_setup *setup, const struct size_row *row,
                 double share[SIZE_LIMITS]);

/* The answer of the drive's position to a sine of amplitude_m at frequency_hz around half the push-off, as
 * gain and lag (rad, > 0). Some ten milliseconds of processor time. */
void size_answer(const struct size_setup *setup, double frequency_hz, double amplitude_m,
                 double *gain, double *lag_rad);

/* Torque per angle that the ankle feels behind an open latch, the drive holding its position, when it is
 * shaken by 0.02 rad at frequency_hz, N m/rad. */
double size_impedance_Nm_rad(const struct size_setup *setup, double frequency_hz);

#endif
