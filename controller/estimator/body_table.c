#include "controller/estimator/body_table.h"

#define BODY_ENTRY(value, number, id, name) [value] = &BODY_ROW(id),
static const struct body *const rows[] = {BODY_TABLE(BODY_ENTRY)};
#undef BODY_ENTRY

#define BODY_IN_RANGE(value, number, id, name) \
    _Static_assert((number) <= (int)BODY_LARGEST, "BODY_LARGEST is the largest number");
BODY_TABLE(BODY_IN_RANGE)
#undef BODY_IN_RANGE

const struct body *body_of(real number)
{
    for (unsigned i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if (number == (real)i) {
            return rows[i];
        }
    }
    return rows[BODY_COMPASS];
}
