#include "sim_host/persons/law_name.h"

#include <string.h>

#include "sim_host/text/nearest.h"

#define ENTRY(value, number, id, name) {name, value},
const struct law_name law_names[LAW_NAMES] = {LAW_TABLE(ENTRY)};
#undef ENTRY

int law_from_name(const char *name, enum law_mode *law)
{
    for (int i = 0; i < LAW_NAMES; i++) {
        if (strcmp(law_names[i].name, name) == 0) {
            *law = law_names[i].law;
            return 0;
        }
    }
    return -1;
}

const char *law_name_of(enum law_mode law)
{
    for (int i = 0; i < LAW_NAMES; i++) {
        if (law_names[i].law == law) {
            return law_names[i].name;
        }
    }
    return "unknown";
}

void law_name_refuse(const char *name, char *message, size_t size)
{
    nearest_refuse(name, law_names, LAW_NAMES, sizeof law_names[0], message, size);
}
