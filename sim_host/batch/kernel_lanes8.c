/* The engine's code for vectors of eight: AVX-512. Empty on other processors. */
#include <stdint.h>
#ifdef __x86_64__
#include <immintrin.h>

#if defined __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq")
#endif
#define BATCH_LANES 8
#define BATCH_STRIDE batch_stride_lanes8
#define BATCH_PEAK batch_peak_lanes8
#include "sim_host/batch/kernel.h"
#if defined __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
