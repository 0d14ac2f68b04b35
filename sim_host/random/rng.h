/* Seeded random numbers with the same bits on every machine.
 *
 * xoshiro256** (Blackman, Vigna 2018), seeded by splitmix64. A normal number is the sum of
 * twelve uniforms less six. It needs no libm, has variance 1 exactly, and never
 * exceeds 6 sigma (a true normal does once in 5e8).
 * No heap, no globals; O(1).
 */
#ifndef SIM_HOST_RANDOM_RNG_H
#define SIM_HOST_RANDOM_RNG_H

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
