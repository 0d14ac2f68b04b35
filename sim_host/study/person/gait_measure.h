/* What gait analysis says of a person who walks by reflexes: speed, step time, loads, and mean curves over the stride.
 *
 * Angles are those of gait analysis, in degrees: flexion of hip (thigh against trunk) and knee and dorsiflexion of the
 * ankle are positive. Moments are internal, N m/kg: extension (at the ankle: plantarflexion) is positive; of muscles
 * and the joints' soft ends, without the device's. Loads are the ground's upward force by body weight.
 */
#ifndef SIM_HOST_STUDY_PERSON_GAIT_MEASURE_H
#define SIM_HOST_STUDY_PERSON_GAIT_MEASURE_H

#include <stdbool.h>

#include "sim_host/reflex/reflex_person.h"

enum {
    GAIT_POINTS = 51, /* of a stride, heel strike to heel strike: every 2 % */
    GAIT_SAMPLES = 400,
    GAIT_CURVES = 2 * JOINT_COUNT + 1,
    CURVE_ANGLE = 0,            /* + enum joint */
    CURVE_MOMENT = JOINT_COUNT, /* + enum joint */
    CURVE_LOAD = 2 * JOINT_COUNT
};

struct gait_leg {
    bool stands;
    double strike_s; /* the last one, below 0: none yet */
    int samples;     /* since then, every 5 ms */
    double sample[GAIT_CURVES][GAIT_SAMPLES];
    int strides;
    double sum[GAIT_CURVES][GAIT_POINTS];
};

struct gait_measure {
    double from_s; /* what comes before is not counted */
    double now_s, start_m, start_s;
    struct gait_leg leg[SIDE_COUNT];
    double last_strike_s;
    int steps; /* counted; their times: */
    double step_sum_s, step_squares_s2;
    double peak_weights;
    double torque_before_Nm[SIDE_COUNT][JOINT_COUNT];
    double torque_rate_squares, activation_squares, trunk_rate_squares;
    long ticks;
    double distance_m, walked_s;
    bool fell;
};

struct gait_summary {
    bool fell;
    double walked_s; /* in all, until the fall or the end */
    int steps;
    double speed_m_s, step_time_s, step_time_sd_s;
    double peak_weights;
    double torque_rate_Nm_kg_s; /* RMS over the joints */
    double activation;          /* mean square over the muscles */
    double trunk_rate_rad_s;    /* RMS */
    double curve[SIDE_COUNT][GAIT_CURVES][GAIT_POINTS];
    bool has_curve[SIDE_COUNT];
};

void gait_measure_init(struct gait_measure *measure, double from_s);

/* The person as they are at now_s, every millisecond or tick. */
void gait_measure_take(struct gait_measure *measure, const struct reflex_person *person,
                       double now_s);

void gait_measure_summary(const struct gait_measure *measure, struct gait_summary *summary);

#endif
