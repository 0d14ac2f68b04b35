/* The step law on the ideal return map, told apex speeds with an error: what an
 * estimator's error costs the law. Plain doubles, for callers of either precision. */
#ifndef SIM_HOST_STUDY_NOISY_MAP_H
#define SIM_HOST_STUDY_NOISY_MAP_H

#include <stdint.h>

struct noisy_walk {
    double spread; /* RMS deviation of the true apex speed from its mean, as a share */
    int walked;    /* strides before a fault, at most those asked for */
    int fell;
};

/* The paper's walker under eq. (16) at the steady gait of speed_rad_s, `strides` long,
 * each measured speed multiplied by 1 + error_share times a normal number. Returns 0,
 * or -1 when there is no such gait. */
int noisy_map_walk(double speed_rad_s, double kp_m_s_rad, double error_share, int strides,
                   uint64_t seed, struct noisy_walk *walk);

#endif
