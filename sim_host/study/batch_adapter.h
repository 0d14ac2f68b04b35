/* Converts between the studies' problems and the batch engine: walker, law and accuracy. */
#ifndef SIM_HOST_STUDY_BATCH_ADAPTER_H
#define SIM_HOST_STUDY_BATCH_ADAPTER_H

#include "sim_host/batch/batch.h"
#include "sim_host/gait/orbit.h"

#define BATCH_ADAPTER_ACCURACY 1e-11 /* of an apex, as that of the scalar map's accurate settings */
#define BATCH_ADAPTER_SKIP (-1) /* an item's fault before it starts: the engine passes it over */

/* The same walker for the engine. */
struct batch_walker batch_adapter_walker(const struct walker_params *params);

/* Writes the push-off of the problem's law at the item's apex into the item. */
void batch_adapter_push(const struct problem *problem, struct batch_item *item);

/* The derivative of the next apex by the apex with the problem's law, from the engine's by apex and push-off. */
void batch_adapter_by_apex(const struct problem *problem, const struct batch_slopes *slopes,
                           double by_x[3][3]);

#endif
