/* A person made by computation: for a machine that has no recording, and for people nobody has recorded.
 *
 * Thigh, knee and ankle follow curves through the positions that textbooks give for the ends of the phases
 * of an adult's gait on level ground (Perry, Burnfield: Gait Analysis, Normal and Pathological Function,
 * 2nd ed. 2010, chapters 3 to 5: initial contact, loading response to 12 % of the stride, mid stance to
 * 31 %, terminal stance to 50 %, pre-swing to 62 %, initial swing to 75 %, mid swing to 87 %), in whole
 * degrees. Between them lies a smooth curve. The foot is on the ground up to toe-off.
 * Stride time, size of the steps, asymmetry and double support are parameters, and each stride scatters.
 * Heel strike and toe-off are known exactly, to the sample.
 *
 * Uses the heap (the samples). Not for the control loop. Same parameters, same bits.
 */
#ifndef SIM_HOST_PLANT_MADE_PERSON_H
#define SIM_HOST_PLANT_MADE_PERSON_H

#include <stdint.h>

#include "sim_host/plant/recording.h"

struct made_person_params {
    double seconds;   /* 1 .. 1000 */
    double stride_s;  /* 0.6 .. 3: mean time of a stride, two steps */
    double size;      /* 0.2 .. 1.5: of the angles around standing, so of the steps */
    double asymmetry; /* 0 .. 0.4: the left leg's angles are smaller by this share, and the right
                              * foot lands early by a quarter of it */
    double toe_off;   /* 0.52 .. 0.75: share of the stride on the ground; 0.62 usual */
    double stride_scatter; /* 0 .. 0.1: standard deviation of the stride times, share of the mean */
    uint64_t seed;         /* of the scatter */
};

/* An adult at their own pace: stride of 1.12 s, size 1, about 1.3 m/s on a leg of 0.9 m. */
void made_person_usual(struct made_person_params *params);

/* About so fast on a leg of leg_m, m/s: two steps of 2 leg sin(strike angle) a stride. */
double made_person_speed_m_s(const struct made_person_params *params, double leg_m);

/* NULL if every field is in range, else the name of the first that is not. */
const char *made_person_check(const struct made_person_params *params);

/* Angles at a share of the stride since the own heel strike (0 <= share < 1), degrees: thigh and shank
 * from the vertical, positive with the knee or ankle ahead; dorsiflexion. */
void made_person_angles(double share, double toe_off, double *thigh_deg, double *shank_deg,
                        double *ankle_deg);

/* 200 samples a second of params->seconds; the ankle's extension by *format. The params have passed the
 * check. RECORDING_OK, or RECORDING_NO_MEMORY with *recording empty. The caller frees it. */
enum recording_error made_person_record(struct recording *recording,
                                        const struct made_person_params *params,
                                        const struct recording_format *format);

#endif
