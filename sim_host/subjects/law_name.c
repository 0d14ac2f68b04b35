#include "sim_host/subjects/law_name.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define ENTRY(value, number, id, name) {name, value},
static const struct {
    const char *name;
    enum law_mode law;
} names[] = {LAW_TABLE(ENTRY)};
#undef ENTRY
#define LAWS (sizeof names / sizeof names[0])

int law_from_name(const char *name, enum law_mode *law)
{
    for (size_t i = 0; i < LAWS; i++) {
        if (strcmp(names[i].name, name) == 0) {
            *law = names[i].law;
            return 0;
        }
    }
    return -1;
}

const char *law_name_of(enum law_mode law)
{
    for (size_t i = 0; i < LAWS; i++) {
        if (names[i].law == law) {
            return names[i].name;
        }
    }
    return "unknown";
}

void law_names_but(enum law_mode left_out, char *text)
{
    size_t length = 0;
    text[0] = '\0';
    for (size_t i = 0; i < LAWS; i++) {
        if (names[i].law != left_out) {
            length += (size_t)snprintf(text + length, LAW_NAMES_TEXT_MAX - length, "%s%s",
                                       length > 0 ? ", " : "", names[i].name);
        }
    }
}
