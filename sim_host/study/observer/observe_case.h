/* A closed-loop walk of the paper's walker, as the studies of the observer set it up. */
#ifndef SIM_HOST_STUDY_OBSERVER_OBSERVE_CASE_H
#define SIM_HOST_STUDY_OBSERVER_OBSERVE_CASE_H

#include "sim_host/loop/loop.h"

struct observe_case {
    double speed_rad_s;
    enum sensor_preset_kind sensors;
    double noise_counts, latency_s;
    uint64_t seed;
    enum law_mode law;
};

/* Fills *config for the case. Returns 0, or -1 with the reason in message (LOOP_MESSAGE_MAX). */
int observe_case_configure(const struct observe_case *want, struct loop_config *config,
                           char *message);

#endif
