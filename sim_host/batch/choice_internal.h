/* The choice as the engine asks for it. Private to sim_host/batch. */
#ifndef SIM_HOST_BATCH_CHOICE_INTERNAL_H
#define SIM_HOST_BATCH_CHOICE_INTERNAL_H

#include "sim_host/batch/block.h"
#include "sim_host/batch/choice.h"

/* Lanes in use, and the function that computes a stride of a block with them. */
int choice_lanes(void);
block_stride_fn *choice_stride(void);

/* Order and tolerance for the accuracy asked for; 0 when that is out of range. want_slopes is left alone. */
int choice_precision(const struct batch_settings *settings, struct block_precision *precision);

#endif
