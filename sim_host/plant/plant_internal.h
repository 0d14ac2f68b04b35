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

/* The switches of a person's feet, wired to the other leg's latch. */
void plant_run_switches(struct plant *plant, bool has_contact);
/* A person's latch at a moment, s: opens it, closes it, breaks it. */
void plant_run_latch(struct plant *plant, enum side side, double ankle_m, double now_s);

/* One tick of a person who walks by reflexes: body and SEAs drive period by drive period. */
void plant_init_reflex_person(struct plant *plant);
void plant_advance_reflex_person(struct plant *plant);
/* Slope, stair and footholds below them; once a tick. */
void plant_lay_reflex_ground(struct plant *plant);
void plant_lay_reflex_stair(struct plant *plant, double rise_m);
/* Draws the next foothold's height. */
void plant_lay_foothold(struct plant *plant);
/* A foothold has been taken: the next one is drawn. */
void plant_pass_foothold(struct plant *plant);
/* Where a spring's end would stand, were its latch open: the ankle's way less the strut's (plant_reflex_person.c). */
double plant_reflex_spring_end_m(const struct plant *plant, enum side side);
void plant_reflex_truth(const struct plant *plant, struct plant_truth *truth);

#endif
