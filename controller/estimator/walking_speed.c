#include "controller/estimator/walking_speed.h"

/* The speed of a slow first step, and the limits, all in sqrt(g/l). */
#define FIRST_SPEED_RATIO REAL(0.3)
#define LEAST_SPEED_RATIO REAL(0.1)
#define MOST_SPEED_RATIO REAL(0.8)
#define SPEED_FORGOTTEN_S REAL(3.0)
#define SPEED_MEAN_GAIN REAL(0.3)
#define SPEED_JUMP_RATIO REAL(0.3)

void walking_speed_apex(struct walking_speed *speed, uint32_t tick, real speed_rad_s)
{
    const real mean = speed->mean_rad_s;
    const bool anew = seconds_since(tick, speed->last_apex_tick) > SPEED_FORGOTTEN_S ||
                      real_abs(speed_rad_s - mean) > SPEED_JUMP_RATIO * mean;
    speed->mean_rad_s = anew ? speed_rad_s : mean + SPEED_MEAN_GAIN * (speed_rad_s - mean);
    speed->last_apex_tick = tick;
}

real walking_speed_at(const struct walking_speed *speed, const struct control_params *params,
                      uint32_t tick)
{
    const real unit = real_sqrt(params->gravity_m_s2 / params->leg_length_m);
    const real mean = speed->mean_rad_s;
    if (!(mean > REAL(0.0)) || seconds_since(tick, speed->last_apex_tick) > SPEED_FORGOTTEN_S) {
        return FIRST_SPEED_RATIO * unit;
    }
    return real_clamp(mean, LEAST_SPEED_RATIO * unit, MOST_SPEED_RATIO * unit);
}
