/* One walk of a person who walks by reflexes, with a dose of push-off or without the device, and what it costs them.
 *
 * The whole loop walks. Its second half is measured. Then a force at the hip pushes the walk as it is there, ever
 * anew from the same state, until the largest one is known that does not end in a fall.
 */
#ifndef SIM_HOST_STUDY_DOSE_DOSE_TRIAL_H
#define SIM_HOST_STUDY_DOSE_DOSE_TRIAL_H

#include <stdbool.h>
#include <stdint.h>

struct dose_trial {
    const char *person_path, *device_path;
    bool without_device; /* the person feels nothing of it; r0_m and late_s are then nobody's */
    double r0_m;         /* of every push, once it has risen to it */
    double late_s;       /* the latches open so late */
    uint64_t seed;
    uint32_t steps;     /* 0: it is checked whether the walk can begin */
    double push_step_N; /* the margin is known to so much; 0: it is not asked for */
};

/* X(name, unit, what): of the steps measured, both legs together. Work is the muscles' positive work at a joint. */
#define DOSE_MEASURES(X)                                             \
    X(speed_m_s, "m/s", "speed")                                     \
    X(cadence_per_min, "1/min", "steps a minute")                    \
    X(ankle_J_m, "J/m", "own ankle work a metre")                    \
    X(knee_J_m, "J/m", "own knee work a metre")                      \
    X(hip_J_m, "J/m", "own hip work a metre")                        \
    X(activation, "1", "activation, the muscles' mean")              \
    X(soleus, "1", "activation of soleus")                           \
    X(device_J_m, "J/m", "the device's work on the person, a metre") \
    X(push_margin_N, "N",                                            \
      "largest force forward at the hip for 0.2 s that is survived; 400: or more, 0: none, or not even none")

#define DOSE_FIELD(name, unit, what) double name;
struct dose_result {
    bool fell; /* before its steps were walked: nothing is measured, all measures are 0 */
    uint32_t steps;
    DOSE_MEASURES(DOSE_FIELD)
};
#undef DOSE_FIELD

enum { DOSE_MESSAGE_MAX = 1024 };

/* Returns 0, or -1 with the reason in message. Processor time: about 30 ms a step, and 0.5 s for each of some 10
 * pushes. */
int dose_trial_run(const struct dose_trial *trial, struct dose_result *result, char *message);

#endif
