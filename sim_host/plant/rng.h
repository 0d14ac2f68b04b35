/* Seeded random numbers with the same bits on every machine.
 *
 * xoshiro256** (Blackman, Vigna 2018), seeded by splitmix64. Normal numbers are
 * the sum of twelve uniforms less six: no libm, exact variance 1, tails cut
 * at 6 sigma (the true normal's are beyond that once in 5e8).
 * No heap, no globals; O(1).
 */
#ifndef SIM_HOST_PLANT_RNG_H
#define SIM_HOST_PLANT_RNG_H

#include <stdint.h>

struct rng {
    uint64_t s[4];
};

/* stream separates generators of one seed (sensor left, sensor right, ...). */
void rng_init(struct rng *rng, uint64_t seed, uint64_t stream);
uint64_t rng_next(struct rng *rng);
/* Uniform in [0, 1), 53 bits. */
double rng_uniform(struct rng *rng);
/* Mean 0, variance 1, |x| <= 6. */
double rng_normal(struct rng *rng);

#endif
