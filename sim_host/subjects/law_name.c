#include "sim_host/subjects/law_name.h"

#include <string.h>

const struct law_name law_names[] = {
    {"proportional", LAW_PROPORTIONAL}, {"open-loop", LAW_OPEN_LOOP},   {"dlqr", LAW_DLQR},
    {"deadbeat", LAW_DEADBEAT},         {"predictive", LAW_PREDICTIVE}, {"recording", LAW_PERSON},
    {NULL, LAW_PROPORTIONAL},
};

int law_from_name(const char *name, enum law_mode *law)
{
    for (const struct law_name *l = law_names; l->name != NULL; l++) {
        if (strcmp(l->name, name) == 0) {
            *law = l->law;
            return 0;
        }
    }
    return -1;
}

const char *law_name_of(enum law_mode law)
{
    for (const struct law_name *l = law_names; l->name != NULL; l++) {
        if (l->law == law) {
            return l->name;
        }
    }
    return "unknown";
}

const char *law_names_allowed(void)
{
    return "proportional, open-loop, dlqr, deadbeat, predictive or person";
}
