/* What nerves and muscles add to every stimulation by chance.
 *
 * Each of the fourteen muscles is stimulated by  S (1 + p n(t))  for S asked: noise grows with the command (Harris &
 * Wolpert 1998, Nature 394, 780-784), so that a muscle that is asked for nothing gets nothing. p is the share, and n
 * has mean 0 and variance 1, each muscle its own:
 *     n(t + 1 ms) = a n(t) + sqrt(1 - a^2) g,   a = exp(-1 ms / 50 ms),   g normal (random/rng.h)
 * So its power lies below 1 / (2 pi 50 ms) = 3.2 Hz, where the force of a steady muscle varies, by 1 to 5 %
 * (Enoka et al. 2003, J. Electromyogr. Kinesiol. 13, 1-12).
 *
 * The state is plain data; the same seed gives the same bits on every machine.
 */
#ifndef SIM_HOST_REFLEX_REFLEX_NOISE_H
#define SIM_HOST_REFLEX_REFLEX_NOISE_H

#include "sim_host/random/rng.h"
#include "sim_host/reflex/muscles.h"

#define REFLEX_NOISE_NONE 0.0 /* the named preset: what is asked for is what comes */
#define REFLEX_NOISE_MOST 0.2

struct reflex_noise {
    struct rng rng;
    double n[SIDE_COUNT][MUSCLE_COUNT];
};

/* n begins as if it had gone on for ever. */
void reflex_noise_init(struct reflex_noise *noise, uint64_t seed);

/* One millisecond later on a side: puts the noise of this share (0 .. REFLEX_NOISE_MOST) on its stimulations. */
void reflex_noise_add(struct reflex_noise *noise, double share, enum side side,
                      double stimulation[MUSCLE_COUNT]);

#endif
