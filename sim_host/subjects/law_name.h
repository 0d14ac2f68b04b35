/* The laws' names, as subject files and command lines spell them: those of law_table.h. */
#ifndef SIM_HOST_SUBJECTS_LAW_NAME_H
#define SIM_HOST_SUBJECTS_LAW_NAME_H

#include "controller/laws/law_table.h"

/* ", proportional, open-loop" and so on: a literal, for help texts. */
#define LAW_NAMES_ONE(value, number, id, name) ", " name
#define LAW_NAMES LAW_TABLE(LAW_NAMES_ONE)

/* The law of that name: returns 0 and sets *law, or -1. */
int law_from_name(const char *name, enum law_mode *law);

/* The name of a law; "unknown" for a value that is none. A static string. */
const char *law_name_of(enum law_mode law);

enum { LAW_NAMES_TEXT_MAX = sizeof(LAW_NAMES) };

/* "proportional, dlqr, ...", for messages: all laws but one. text: LAW_NAMES_TEXT_MAX bytes. */
void law_names_but(enum law_mode left_out, char *text);

#endif
