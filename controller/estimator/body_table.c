#include "controller/estimator/body_table.h"

#define BODY_ENTRY(value, number, id, name) [value] = &BODY_ROW(id),
static const struct body *const rows[] = {BODY_TABLE(BODY_ENTRY)}; /* without a gap */
#undef BODY_ENTRY
enum { ROWS = sizeof rows / sizeof rows[0] };
_Static_assert((int)ROWS == (int)BODY_LARGEST + 1, "BODY_LARGEST is the largest number");

const struct body *body_of(real number)
{
    unsigned i = 0;
    while (i < ROWS && number != (real)i) {
        i++;
    }
    return rows[i < ROWS ? i : (unsigned)BODY_COMPASS];
}
