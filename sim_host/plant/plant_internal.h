/* What the parts of plant.c share; nobody else includes this. */
#ifndef SIM_HOST_PLANT_PLANT_INTERNAL_H
#define SIM_HOST_PLANT_PLANT_INTERNAL_H

#include "sim_host/plant/plant.h"

/* Time of the SYNC the plant stands at. */
double plant_now_s(const struct plant *plant);

/* One tick of a recorded wearer: the person moves on, the SEAs work against the
 * recorded ankles. */
void plant_advance_recorded_person(struct plant *plant);

#endif
