#include "controller/actuation/sea_reference.h"

#define STOP_SPEED_RATIO REAL(1.2)
#define STOP_ACCELERATION_RATIO REAL(1.6)
#define LEFT_BEHIND_RATIO REAL(0.01)

void sea_reference_init(struct sea_reference *sea, real position_m)
{
    *sea = (struct sea_reference){.phase = SEA_UNLOADED, .position_m = position_m};
}

void sea_reference_begin_loading(struct sea_reference *sea, real r0_m)
{
    sea->phase = SEA_LOADING;
    sea->target_m = r0_m;
    sea->stop_speed_m_s = REAL(0.0);
}

void sea_reference_set_target(struct sea_reference *sea, real r0_m)
{
    if (sea->phase == SEA_LOADING || sea->phase == SEA_TRIMMED) {
        sea->phase = SEA_TRIMMED;
        sea->target_m = r0_m;
    }
}

void sea_reference_unload(struct sea_reference *sea)
{
    if (sea->phase != SEA_UNLOADED) {
        sea->phase = SEA_UNLOADING;
    }
    sea->target_m = REAL(0.0);
}

void sea_reference_hurry_back(struct sea_reference *sea, real speed_m_s, real acceleration_m_s2)
{
    sea_reference_unload(sea);
    sea->stop_speed_m_s = speed_m_s;
    sea->stop_acceleration_m_s2 = acceleration_m_s2;
}

struct sea_stop sea_reference_stop_limits(const struct control_params *params)
{
    return (struct sea_stop){STOP_SPEED_RATIO * params->sea_speed_max_m_s,
                             STOP_ACCELERATION_RATIO * params->sea_acceleration_m_s2,
                             LEFT_BEHIND_RATIO * params->leg_length_m};
}

void sea_reference_stop(struct sea_reference *sea, const struct sea_stop *limits, real measured_m)
{
    sea_reference_unload(sea);
    sea->stop_speed_m_s = limits->speed_m_s;
    sea->stop_acceleration_m_s2 = limits->acceleration_m_s2;
    if (measured_m < sea->position_m - limits->left_behind_m) {
        sea->position_m = measured_m > REAL(0.0) ? measured_m : REAL(0.0);
        sea->speed_m_s = REAL(0.0);
    }
}

/* Trapezoidal profile in discrete time: as fast as the limits allow, but never
 * faster than can still be braked. Moving one tick at v and then braking covers
 * v T / 2 + v^2 / (2 a); solved for v at the distance left. */
static void advance(struct sea_reference *sea, real speed_max, real acceleration)
{
    const real change = acceleration * CONTROL_PERIOD_S; /* of speed, in one tick */
    const real distance = sea->target_m - sea->position_m;
    const real left = real_abs(distance);
    const real ticks_left = real_sqrt(REAL(0.25) + REAL(2.0) * left / (change * CONTROL_PERIOD_S));
    const real brake = change * (ticks_left - REAL(0.5));
    const real allowed = brake < speed_max ? brake : speed_max;
    const real wanted = distance < REAL(0.0) ? -allowed : allowed;

    sea->speed_m_s += real_clamp(wanted - sea->speed_m_s, -change, change);
    if (left <= change * CONTROL_PERIOD_S && real_abs(sea->speed_m_s) <= change) {
        sea->position_m = sea->target_m;
        sea->speed_m_s = REAL(0.0);
    } else {
        sea->position_m += sea->speed_m_s * CONTROL_PERIOD_S;
    }
}

struct sea_request sea_reference_update(struct sea_reference *sea,
                                        const struct control_params *params, real measured_m)
{
    /* A stop may use what the drive has in reserve. */
    const bool stops = sea->stop_speed_m_s > REAL(0.0);
    advance(sea, stops ? sea->stop_speed_m_s : params->sea_speed_max_m_s,
            stops ? sea->stop_acceleration_m_s2 : params->sea_acceleration_m_s2);
    const bool arrived = sea->position_m == sea->target_m &&
                         real_abs(measured_m - sea->target_m) <= params->sea_tolerance_m;
    if (sea->phase == SEA_TRIMMED && arrived) {
        sea->phase = SEA_ARMED;
    } else if (sea->phase == SEA_UNLOADING && arrived) {
        sea->phase = SEA_UNLOADED;
    }
    return (struct sea_request){sea->position_m, false, sea->phase == SEA_ARMED};
}
