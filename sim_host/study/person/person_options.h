/* Options of every study of a person who walks by reflexes: who, with what on, and how finely their muscles are stepped. */
#ifndef SIM_HOST_STUDY_PERSON_PERSON_OPTIONS_H
#define SIM_HOST_STUDY_PERSON_PERSON_OPTIONS_H

#include <argp.h>

struct person_options {          /* all zeros to begin with */
    const char *person, *device; /* person: given; device: NULL without */
    double r0_m;                 /* 0: the person file's own; given only with a device */
    double step_s; /* of the muscles: 0.25 ms if it is not given; unused with a device */
};

/* --person, --device, --r0, --step-ms; input: struct person_options. What does not fit together ends the process. */
extern const struct argp person_options_parser;

#endif
