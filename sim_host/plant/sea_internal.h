/* What the files of the SEA share; not for its users. */
#ifndef SIM_HOST_PLANT_SEA_INTERNAL_H
#define SIM_HOST_PLANT_SEA_INTERNAL_H

#include "sim_host/plant/sea.h"

/* Where the spring's end is, m: held by the latch, or at the ankle. */
double sea_output_of(const struct sea *sea, double ankle_m);

/* The spring's stiffness in shares of what was configured: a fault may have changed it. */
double sea_spring_scale(const struct sea *sea);

/* Force in the spring now, whoever holds it, N. */
double sea_spring_force_now_N(const struct sea *sea, double ankle_m);

/* A cause of a release has come: an armed, closed latch begins to open. */
void sea_schedule_release(struct sea *sea, double now_s);

/* Once every period of the drive: what a closed latch does with its spring's force. */
void sea_hold(struct sea *sea);

#endif
