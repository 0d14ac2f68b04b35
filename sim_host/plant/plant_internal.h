/* What the files of the plant share; not for its users. */
#ifndef SIM_HOST_PLANT_PLANT_INTERNAL_H
#define SIM_HOST_PLANT_PLANT_INTERNAL_H

#include "sim_host/plant/plant.h"

/* Time of the SYNC the plant stands at. */
static inline double plant_now_s(const struct plant *plant)
{
    return (double)plant->tick * plant->config.tick_s;
}

/* Checks every field but the recording. On failure message (PLANT_ERROR_MAX bytes) names the field. */
enum plant_error plant_config_check(const struct plant_config *config, char *message);

/* One tick of a recorded person: the person moves on, the SEAs work against the
 * recorded ankles. */
void plant_advance_recorded_person(struct plant *plant);

#endif
