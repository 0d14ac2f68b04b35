/* Vectors of doubles, one walker to a lane, and what the standard operators do not give.
 *
 * Included once per instruction set with BATCH_LANES defined (and, on x86, the instruction set switched on
 * for the functions that follow). GCC's and clang's vector extensions; only + - * /, square root,
 * comparison and bit operations, all of which IEEE 754 fixes: the same bits in any width.
 * No fused multiply-add anywhere, for SSE2 has none.
 */
#ifndef SIM_HOST_BATCH_LANES_H
#define SIM_HOST_BATCH_LANES_H

#include <stdint.h>

#ifndef __clang__
/* gcc's analyzer takes a shift of a vector for one of a mask, and lanes set one by one for never set. */
#pragma GCC diagnostic ignored "-Wanalyzer-shift-count-overflow"
#pragma GCC diagnostic ignored "-Wanalyzer-use-of-uninitialized-value"
#endif

#ifdef __x86_64__
#include <immintrin.h>
#endif
#ifdef __aarch64__
#include <arm_neon.h>
#endif

#ifndef BATCH_LANES
#error "define BATCH_LANES: 2, 4 or 8"
#endif

typedef double vd __attribute__((vector_size(8 * BATCH_LANES)));
typedef int64_t vi __attribute__((vector_size(8 * BATCH_LANES))); /* masks: 0 or -1; fault codes */
typedef uint64_t vu __attribute__((vector_size(8 * BATCH_LANES)));

#define LANE_INLINE static inline __attribute__((always_inline, unused))

/* Loads and stores of one column's lanes; the address need not be aligned. */
LANE_INLINE vd vd_load(const double *from)
{
    vd x;
    __builtin_memcpy(&x, from, sizeof x);
    return x;
}

LANE_INLINE void vd_store(double *to, vd x)
{
    __builtin_memcpy(to, &x, sizeof x);
}

/* x, held in a register: loaded once for all its uses. The compilers would fold a load into each, and loads are
 * what the power series wait for. */
LANE_INLINE vd vd_hold(vd x)
{
#if defined __x86_64__ && BATCH_LANES == 8
    __asm__("" : "+v"(x));
#elif defined __x86_64__
    __asm__("" : "+x"(x));
#elif defined __aarch64__
    __asm__("" : "+w"(x));
#endif
    return x;
}

LANE_INLINE vd vd_all(double x)
{
    return x - (vd){0.0};
}

LANE_INLINE vi vi_all(int64_t x)
{
    return x - (vi){0};
}

LANE_INLINE vd vd_pick(vi mask, vd yes, vd no)
{
    return (vd)((mask & (vi)yes) | (~mask & (vi)no));
}

LANE_INLINE vi vi_pick(vi mask, vi yes, vi no)
{
    return (mask & yes) | (~mask & no);
}

LANE_INLINE vd vd_abs(vd x)
{
    return (vd)((vi)x & vi_all(INT64_MAX));
}

LANE_INLINE vd vd_min(vd a, vd b)
{
    return vd_pick(a < b, a, b);
}

LANE_INLINE vd vd_max(vd a, vd b)
{
    return vd_pick(a > b, a, b);
}

LANE_INLINE vd vd_sqrt(vd x)
{
#if defined __x86_64__ && BATCH_LANES == 2
    return (vd)_mm_sqrt_pd((__m128d)x);
#elif defined __x86_64__ && BATCH_LANES == 4
    return (vd)_mm256_sqrt_pd((__m256d)x);
#elif defined __x86_64__ && BATCH_LANES == 8
    return (vd)_mm512_sqrt_pd((__m512d)x);
#elif defined __aarch64__
    return (vd)vsqrtq_f64((float64x2_t)x);
#else
    for (int i = 0; i < BATCH_LANES; i++) {
        x[i] = __builtin_sqrt(x[i]);
    }
    return x;
#endif
}

/* 1 when any lane of a mask is set. */
LANE_INLINE int vi_any(vi mask)
{
#if defined __x86_64__ && BATCH_LANES == 2
    return _mm_movemask_pd((__m128d)mask) != 0;
#elif defined __x86_64__ && BATCH_LANES == 4
    return _mm256_movemask_pd((__m256d)mask) != 0;
#elif defined __x86_64__ && BATCH_LANES == 8
    return _mm512_movepi64_mask((__m512i)mask) != 0;
#else
    int64_t any = 0;
    for (int i = 0; i < BATCH_LANES; i++) {
        any |= mask[i];
    }
    return any != 0;
#endif
}

/* 0 for infinities and NaN. */
LANE_INLINE vi vd_is_finite(vd x)
{
    return (x - x) == vd_all(0.0);
}

#define LANES_TWO_52 4503599627370496.0
#define LANES_TWO_32 4294967296.0

/* Binary logarithm of x >= 0 and its inverse, good to 6 %: straight lines between powers of two, read off
 * the bits. For choosing a step, where the same bits everywhere matter and closeness does not. */
LANE_INLINE vd vd_rough_log2(vd x)
{
    const vu magic = (vu)vd_all(LANES_TWO_52);
    const vu top = ((vu)x >> 20) | magic;
    return ((vd)top - LANES_TWO_52) * (1.0 / LANES_TWO_32) - 1023.0;
}

LANE_INLINE vd vd_rough_exp2(vd y)
{
    const vd inside = vd_min(vd_max(y, vd_all(-1000.0)), vd_all(1000.0));
    const vu fixed = (vu)((inside + 1023.0) * LANES_TWO_32 + LANES_TWO_52);
    return (vd)(fixed << 20);
}

#endif
