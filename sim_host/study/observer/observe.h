/* `afo study observe`: how well the controller knows the gait, and what it costs the law. */
#ifndef SIM_HOST_STUDY_OBSERVER_OBSERVE_H
#define SIM_HOST_STUDY_OBSERVER_OBSERVE_H

#include "sim_host/study/observer/observed_walk.h"

/* A closed-loop walk of the paper's walker to be watched. */
struct observe_case {
    double speed_rad_s;
    enum sensor_preset_kind sensors;
    double noise_counts, latency_s;
    uint64_t seed;
    enum law_mode law;
};

/* Fills *config for the case. Returns 0, or -1 with the reason in message. */
int observe_configure(const struct observe_case *want, struct loop_config *config, char *message);

/* Rows of walkers and grounds that are not what the controller's parameters say. */
int observe_mismatch(int steps, int settle);

#endif
