/* A walk in closed loop, with the errors of what its controller knew about the gait. */
#ifndef SIM_HOST_STUDY_OBSERVER_OBSERVED_WALK_H
#define SIM_HOST_STUDY_OBSERVER_OBSERVED_WALK_H

#include <stdbool.h>

#include "sim_host/loop/loop.h"

/* Errors of an apex speed as shares of the true one. */
struct speed_errors {
    double rms, worst, mean;
    int count;
};

struct event_errors {
    double rms_s, worst_s; /* of the estimated time */
    double delay_s;        /* mean, from the true event until it is known */
    int count, missed;
};

struct observed_walk {
    int steps;
    bool fell;
    char fault[64];
    struct speed_errors observer, plain, filtered;
    double swing_angle_rms_rad, swing_rate_rms_rad_s;
    double confidence; /* mean */
    struct event_errors event[GAIT_EVENT_KINDS];
    int false_apexes;
    double mean_speed_rad_s, speed_spread; /* of the true apex speed; RMS as a share */
};

/* Walks `steps` steps (fewer if it falls); the first `settle` do not count. Returns 0,
 * or -1 with the reason in message (LOOP_MESSAGE_MAX bytes). Not reentrant. */
int observed_walk_run(const struct loop_config *config, int steps, int settle,
                      struct observed_walk *walk, char *message);

#endif
