/* The step law on the ideal return map, with errors in the apex speed that it sees.
 *
 * This shows what an estimator's error costs the law. Many walkers run on the batch engine. Plain doubles, for
 * callers of either precision.
 */
#ifndef SIM_HOST_STUDY_NOISY_MAP_H
#define SIM_HOST_STUDY_NOISY_MAP_H

#include <stddef.h>
#include <stdint.h>

struct noisy_walk {
    double spread; /* RMS deviation of the true apex speed from its mean, as a share */
    int walked;    /* strides before a fault, at most those asked for */
    int fell;
};

/* A law in its gait: r0[k] = r0 + kp (v[k] - v*), not below a fifth of a percent of the leg. */
struct noisy_law {
    double hip_mass_kg, leg_mass_kg, leg_length_m, ankle_stiffness_N_m, gravity_m_s2;
    double gait
        [3]; /* stance rate, swing angle, swing rate: where each walk starts; v* = -stance rate */
    double r0_m, kp_m_s_rad;
};

/* Makes `count` walks from the gait, `strides` long. Each measured speed is multiplied by 1 + error_share times a
 * normal number. Walk i draws from stream i of the seed. On `threads` threads (0: all cores); no result depends on it.
 * Returns 0, or -1 without memory or with a walker out of range. Cost: about a microsecond a stride. */
int noisy_map_walks(const struct noisy_law *law, double error_share, int strides, uint64_t seed,
                    int threads, struct noisy_walk *walks, size_t count);

/* One walk of the paper's walker under eq. (16) at the steady gait of speed_rad_s. Returns 0,
 * or -1 when there is no such gait. */
int noisy_map_walk(double speed_rad_s, double kp_m_s_rad, double error_share, int strides,
                   uint64_t seed, struct noisy_walk *walk);

#endif
