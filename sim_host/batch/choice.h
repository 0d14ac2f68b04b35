/* Which vectors and which method the batch engine uses: the widest and the cheapest, unless a test chooses
 * others. */
#ifndef SIM_HOST_BATCH_CHOICE_H
#define SIM_HOST_BATCH_CHOICE_H

#include "sim_host/batch/batch_settings.h"

/* Vectors in use: "2 lanes", "4 lanes (AVX2)", "8 lanes (AVX-512)". The widest the processor has, unless
 * batch_use_lanes chose another. Static string. */
const char *batch_lanes_name(void);

/* For tests and comparisons: vectors of 2, 4 or 8 from here on, for the whole program; 0: the widest.
 * Not while a job runs. Returns BATCH_OK or BATCH_NO_SUCH_VECTORS. */
enum batch_error batch_use_lanes(int lanes);

/* For the measurement behind batch.c's table of methods: order and tolerance used from here on whatever the accuracy
 * (order 0: back to the table). Not while a job runs. order 4..28; tolerance of a step's last term. */
void batch_use_method(int order, double log2_tolerance);

/* Flops that a stride's power series take at least, for one lane and the settings' accuracy. Counted are
 * multiplications and additions of the recurrence and of two evaluations. Event landing and push-off add a fifth. */
double batch_series_flops(const struct batch_settings *settings);

/* Measured peak of one core with the vectors in use, flops per second, without fused operations. Takes 0.2 s. */
double batch_peak_flops(void);

#endif
