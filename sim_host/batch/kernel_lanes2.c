/* The engine's code for vectors of two: SSE2 on x86-64, NEON on 64-bit ARM. */
#define BATCH_LANES 2
#define BATCH_STRIDE batch_stride_lanes2
#define BATCH_PEAK batch_peak_lanes2
#include "sim_host/batch/kernel.h"
