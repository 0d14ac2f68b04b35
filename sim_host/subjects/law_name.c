#include "sim_host/subjects/law_name.h"

#include <stddef.h>
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

const char *law_names_allowed(void)
{
    static const char list[] = LAW_NAMES;
    return list + 2; /* behind the first comma */
}
