/* Walkers that the tests of model/ use. Header only: compiled for the precision of the test. */
#ifndef TESTS_MODEL_WALKERS_H
#define TESTS_MODEL_WALKERS_H

#include "model/walker.h"
#include "tests/support/assert_close.h"

static inline struct walker make_walker(real M, real m, real l, real k, real g)
{
    struct walker walker;
    const struct walker_params params = {M, m, l, k, g};
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    return walker;
}

static inline struct walker paper_walker(void)
{
    return make_walker(REAL(1.0), REAL(0.01), REAL(1.0), REAL(100.0), REAL(9.80665));
}

/* Legs as heavy as a person's, and no parameter equal to 1, so that a lost factor shows. */
static inline struct walker heavy_legged_walker(void)
{
    return make_walker(REAL(40.0), REAL(8.0), REAL(0.83), REAL(6000.0), REAL(9.7));
}

/* A reproducible number in [low, high). */
static inline double draw(unsigned long long *seed, double low, double high)
{
    *seed = *seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * (double)(*seed >> 11) * 0x1p-53;
}

#endif
