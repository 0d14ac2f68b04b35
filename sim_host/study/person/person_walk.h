/* One walk of a person who walks by reflexes, alone or with a device on, and what gait analysis says of it. */
#ifndef SIM_HOST_STUDY_PERSON_PERSON_WALK_H
#define SIM_HOST_STUDY_PERSON_PERSON_WALK_H

#include "sim_host/study/person/gait_measure.h"
#include "sim_host/subjects/subject.h"

struct person_walk {
    const struct subject *subject;          /* whose person has the muscles */
    const struct reflex_gains *gains;       /* NULL: the person's own */
    double start_speed_m_s, start_lean_rad; /* with gains */
    bool worn;                              /* with the subject's device, else without any */
    double r0_m;                            /* prescribed precompression; worn only */
    double until_s, from_s;                 /* counted from from_s on */
    uint32_t steps;                         /* ends after so many counted steps, too; 0: never */
    double noise_share;
    uint64_t seed;
    double
        push_m_s; /* pushes at the hip, to and fro, every 3 s from 5 s on: impulse by the body's mass; 0: none */
    double step_s; /* of the muscles; worn: that of the drives */
};

/* Returns 0, or -1 with the reason in message (LOOP_MESSAGE_MAX bytes). Costs about 1 % of the time walked, with a
 * device 3 %. Safe in threads. */
int person_walk_run(const struct person_walk *walk, struct gait_summary *summary, char *message);

/* Mass of a person, kg: the hip's and both legs'. */
double person_walk_mass_kg(const struct person *person);

#endif
