#include "controller/laws/law_table.h"

#include <stddef.h>

#define LAW_ENTRY(value, number, id, name) {(real)(number), &LAW_ROW(id)},
static const struct {
    real number;
    const struct law *row;
} entries[] = {LAW_TABLE(LAW_ENTRY)};
#undef LAW_ENTRY

#define LAW_IN_RANGE(value, number, id, name) \
    _Static_assert((number) <= (int)LAW_LARGEST, "LAW_LARGEST is the largest number");
LAW_TABLE(LAW_IN_RANGE)
#undef LAW_IN_RANGE

const struct law *law_of(real number)
{
    for (unsigned i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        if (number == entries[i].number) {
            return entries[i].row;
        }
    }
    return NULL;
}
