/* The laws' names, as subject files and command lines spell them. */
#ifndef SIM_HOST_SUBJECTS_LAW_NAME_H
#define SIM_HOST_SUBJECTS_LAW_NAME_H

#include "controller/control_params.h"

/* All names with their law, ended by a NULL name. */
struct law_name {
    const char *name;
    enum law_mode law;
};
extern const struct law_name law_names[];

/* The law of that name: returns 0 and sets *law, or -1. */
int law_from_name(const char *name, enum law_mode *law);

/* The name of a law; "unknown" for a value that is none. A static string. */
const char *law_name_of(enum law_mode law);

/* "proportional, open-loop, ...", for messages. A static string. */
const char *law_names_allowed(void);

#endif
