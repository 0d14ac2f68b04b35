/* A law of the caller's in the controller: one more row of law_table.h, for the thread that has one.
 *
 * The row is called by step_law_update() as the others are, so its answer has the same limits behind it. It has a
 * number that no law of the table has.
 */
#ifndef SIM_HOST_PYTHON_OWN_LAW_H
#define SIM_HOST_PYTHON_OWN_LAW_H

#include "sim_host/python/library.h"

#define OWN_LAW_NUMBER 7.0

struct own_law {
    afo_law_fn *call; /* NULL: none */
    void *context;
    int failed; /* its answer was not finite */
};

/* From here on law_of(OWN_LAW_NUMBER) is this one in the calling thread; NULL: none. It must outlive that. */
void own_law_use(struct own_law *law);

#endif
