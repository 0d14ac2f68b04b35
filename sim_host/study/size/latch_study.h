/* What each law bears of a latch that opens late: by a constant time, or by one that scatters.
 *
 * The paper's walker walks in closed loop, through bus, sensors and actuator. It sets off slowly and the law
 * brings it to one speed, as in any walk. A trial ends with a fall or after so many steps.
 */
#ifndef SIM_HOST_STUDY_SIZE_LATCH_STUDY_H
#define SIM_HOST_STUDY_SIZE_LATCH_STUDY_H

#include <stdint.h>

#include "controller/laws/law_table.h"

struct latch_trial {
    enum law_mode law;
    double speed_rad_s;
    double delay_s, jitter_s; /* added to each other: delay + uniform in [0, jitter) */
    double declared_s;        /* latch_delay_s of the device: what the laws allow for */
    uint32_t steps;           /* to walk */
    uint64_t seed;
};

struct latch_result {
    uint32_t walked;    /* steps before the fall, or all */
    double speed_rad_s; /* mean over the last third of what was walked */
};

/* Runs one trial. Returns 0, or -1 without memory or when the law does not serve the speed. About 8 ms of
 * processor time a step. */
int latch_trial_run(const struct latch_trial *trial, struct latch_result *result);

/* afo study latch. */
int latch_main(int argc, char **argv);

#endif
