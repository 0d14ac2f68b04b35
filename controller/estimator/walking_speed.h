/* The walking speed: running mean of the forward apex speed, the scale of person_events.h. */
#ifndef CONTROLLER_ESTIMATOR_WALKING_SPEED_H
#define CONTROLLER_ESTIMATOR_WALKING_SPEED_H

#include "controller/control_params.h"
#include "controller/signals.h"

#define walking_speed_apex REAL_SYMBOL(walking_speed_apex)
#define walking_speed_at REAL_SYMBOL(walking_speed_at)

struct walking_speed { /* all zeros to begin with */
    uint32_t last_apex_tick;
    real mean_rad_s; /* 0 = no apex yet */
};

/* An apex with this forward speed. The mean starts anew after a rest or a jump. */
void walking_speed_apex(struct walking_speed *speed, uint32_t tick, real speed_rad_s);

/* Forward speed in rad/s at the last apexes, within limits that scale with sqrt(g/l). Before the
 * first apex and long after the last one: that of a slow first step. Pure. */
real walking_speed_at(const struct walking_speed *speed, const struct control_params *params,
                      uint32_t tick);

#endif
