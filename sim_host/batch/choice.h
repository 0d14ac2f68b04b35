/* Which vectors and which method the engine uses. Private to sim_host/batch. */
#ifndef SIM_HOST_BATCH_CHOICE_H
#define SIM_HOST_BATCH_CHOICE_H

#include "sim_host/batch/batch.h"
#include "sim_host/batch/block.h"

/* Lanes in use, and the function that takes a block through a stride with them. */
int choice_lanes(void);
block_stride_fn *choice_stride(void);

/* Order and tolerance for the accuracy asked for; 0 when that is out of range. want_slopes is left alone. */
int choice_precision(const struct batch_settings *settings, struct block_precision *precision);

#endif
