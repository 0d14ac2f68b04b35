/* The laws' names, as person files and command lines spell them: those of law_table.h. */
#ifndef SIM_HOST_PERSONS_LAW_NAME_H
#define SIM_HOST_PERSONS_LAW_NAME_H

#include <stddef.h>

#include "controller/laws/law_table.h"

/* All names with their law. */
struct law_name {
    const char *name;
    enum law_mode law;
};
#define LAW_NAMES_ONE(value, number, id, name) +1
enum { LAW_NAMES = 0 LAW_TABLE(LAW_NAMES_ONE) };
#undef LAW_NAMES_ONE
extern const struct law_name law_names[LAW_NAMES];

/* ", proportional, open-loop" and so on: a literal, for help texts. */
#define LAW_NAMES_TEXT_ONE(value, number, id, name) ", " name
#define LAW_NAMES_TEXT LAW_TABLE(LAW_NAMES_TEXT_ONE)

/* The law of that name: returns 0 and sets *law, or -1. */
int law_from_name(const char *name, enum law_mode *law);

/* The name of a law; "unknown" for a value that is none. A static string. */
const char *law_name_of(enum law_mode law);

/* Writes what is wrong with a name that is none: the list of those allowed, and the nearest. */
void law_name_refuse(const char *name, char *message, size_t size);

#endif
