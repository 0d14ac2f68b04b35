/* A table of named values with their limits: how the plant checks its parameters. */
#ifndef SIM_HOST_PLANT_RANGE_H
#define SIM_HOST_PLANT_RANGE_H

#include <stddef.h>

struct range {
    const char *name;
    double value, low, high;
};

/* Name of the first entry that is not within low <= value <= high (so a NaN is
 * bad), or NULL. O(count). */
static inline const char *range_first_bad(const struct range *ranges, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!(ranges[i].value >= ranges[i].low && ranges[i].value <= ranges[i].high)) {
            return ranges[i].name;
        }
    }
    return NULL;
}

#endif
