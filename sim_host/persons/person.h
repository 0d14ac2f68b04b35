/* Whom a device is worn by: body, and what was prescribed.
 *
 *     [person]        name, torso_mass_kg, leg_mass_kg, leg_length_m, gravity_m_s2
 *     [prescription]  law, speed_rad_s, and any of the controller's parameters by name
 *     [muscles]       of a person who walks by reflexes, see person_muscles.h
 *
 * What a prescription does not say is computed from body and spring (sim_host/subjects).
 * Names and ranges of the parameters are those of controller/control_params.h.
 */
#ifndef SIM_HOST_PERSONS_PERSON_H
#define SIM_HOST_PERSONS_PERSON_H

#include <stdbool.h>
#include <stdio.h>

#include "controller/control_params.h"
#include "sim_host/persons/person_muscles.h"

enum { PERSON_NAME_MAX = 64, PERSON_MESSAGE_MAX = 768 };

/* SI units. */
struct person {
    char name[PERSON_NAME_MAX];
    double torso_mass_kg; /* at the hip */
    double leg_mass_kg;   /* in the middle of each leg */
    double leg_length_m;  /* hip to heel */
    double gravity_m_s2;
    double speed_rad_s;                           /* apex speed to walk at; 0 = not prescribed */
    double control_override[CONTROL_PARAM_COUNT]; /* the prescription, by parameter */
    bool control_overridden[CONTROL_PARAM_COUNT];
    struct person_muscles muscles;
};

/* The paper's walker: the same as sim_host/persons/paper.ini. */
void person_default(struct person *person);

/* Reads a file. Both masses and the leg length must be given. Returns 0, or -1 with file, line, key and what
 * is allowed in message (PERSON_MESSAGE_MAX bytes); *person is then not to be used. */
int person_read(struct person *person, const char *path, char *message);

/* Takes one key of the prescription. Returns 0, or -1 with the reason in message. */
int person_prescribe(struct person *person, const char *key, const char *value, char *message,
                     size_t size);

/* Sets a parameter of the prescription; the name must be one. */
void person_override(struct person *person, const char *parameter, double value);

/* Whether the prescription says the parameter at this offset in struct control_params. */
bool person_overrides(const struct person *person, size_t offset);

/* Writes the file; reading it gives the same numbers again. The stream keeps its error. */
void person_write(FILE *stream, const struct person *person);

#endif
