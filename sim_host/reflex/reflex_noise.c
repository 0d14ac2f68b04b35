#include "sim_host/reflex/reflex_noise.h"

#include <math.h>

#include "sim_host/reflex/exponential.h"

enum { STREAM = 71 }; /* of the run's seed */
#define PERIOD_S 0.001
#define MEMORY_S 0.05

void reflex_noise_init(struct reflex_noise *noise, uint64_t seed)
{
    rng_init(&noise->rng, seed, STREAM);
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            noise->n[side][i] = rng_normal(&noise->rng);
        }
    }
}

void reflex_noise_add(struct reflex_noise *noise, double share, enum side side,
                      double stimulation[MUSCLE_COUNT])
{
    const double keeps = exponential(-PERIOD_S / MEMORY_S), adds = sqrt(1.0 - keeps * keeps);
    for (int i = 0; i < MUSCLE_COUNT; i++) {
        double *n = &noise->n[side][i];
        *n = keeps * *n + adds * rng_normal(&noise->rng);
        stimulation[i] *= 1.0 + share * *n;
    }
}
