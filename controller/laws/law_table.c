#include "controller/laws/law_table.h"

#include <stddef.h>

#define LAW_ENTRY(value, number, id, name) [value] = &LAW_ROW(id),
static const struct law *const rows[] = {LAW_TABLE(LAW_ENTRY)}; /* NULL between the numbers */
#undef LAW_ENTRY
_Static_assert(sizeof rows / sizeof rows[0] == (int)LAW_LARGEST + 1,
               "LAW_LARGEST is the largest number");

const struct law *law_of(real number)
{
    if (!(number >= REAL(0.0) && number <= (real)LAW_LARGEST)) {
        return NULL;
    }
    const unsigned i = (unsigned)number;
    return number == (real)i ? rows[i] : NULL;
}
