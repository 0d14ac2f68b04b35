/* A fitting run: what the first steps of a person with foot switches teach about their detection.
 *
 * Heel strikes and toe-offs are found from the legs' angles. Each leg of a person is found late or early
 * by its own bias. Switches show it: the mean difference of found event and switch edge over a leg's
 * first PERSON_FIT_EDGES edges. What is learned is kept with the person, in the section [prescription]
 * of their file. A switch's own bias goes into it, which nobody here knows.
 */
#ifndef SIM_HOST_CLI_PERSON_FIT_H
#define SIM_HOST_CLI_PERSON_FIT_H

#include <stdbool.h>
#include <stdio.h>

#include "controller/control_params.h"
#include "sim_host/loop/gait_record.h"
#include "sim_host/persons/person.h"

enum { PERSON_FIT_EDGES = 10, PERSON_FIT_LEAST = 5 }; /* of each kind and leg: 20 steps */

struct person_fit {
    double strike_bias_s[SIDE_COUNT], toe_off_bias_s[SIDE_COUNT];
    double strike_error_s; /* the largest difference from its leg's mean, and PERSON_FIT_MARGIN_S */
    unsigned edges;        /* the fewest that one of the means has */
};

#define PERSON_FIT_MARGIN_S 0.01

/* From a walk's record; params: those that it was walked with. False where an event of a leg has
 * fewer than PERSON_FIT_LEAST edges, or a bias is beyond what the parameters take. Pure. */
bool person_fit_make(const struct gait_record *record, const struct control_params *params,
                     struct person_fit *fit);

/* The person's file with what was learned as part of the prescription. The stream keeps its error. */
void person_fit_write(FILE *stream, const struct person_fit *fit, const struct person *person);

#endif
