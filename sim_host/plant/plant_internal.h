/* What the files of the plant share; not for its users. */
#ifndef SIM_HOST_PLANT_PLANT_INTERNAL_H
#define SIM_HOST_PLANT_PLANT_INTERNAL_H

#include "sim_host/plant/plant.h"

/* Time of the SYNC the plant stands at. */
static inline double plant_now_s(const struct plant *plant)
{
    return (double)plant->tick * plant->config.tick_s;
}

/* One tick of a recorded person: the person moves on, the SEAs work against the
 * recorded ankles. */
void plant_advance_recorded_person(struct plant *plant);

#endif
