/* A walk in the units of gait analysis (plant/walking_units.h), over its last steps. */
#ifndef SIM_HOST_LOOP_WALKING_H
#define SIM_HOST_LOOP_WALKING_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/loop/loop.h"
#include "sim_host/loop/walk_record.h"

/* A longer stride is a pause, and no mean counts it. */
#define WALKING_STRIDE_MAX_S 3.0

/* Means over `strides` strides, each from a heel strike to the next one of the same foot. NaN: not known. */
struct walking {
    uint32_t strides;
    double speed_m_s, step_length_m, step_time_s, cadence_per_min;
    double stance_share, double_support_share; /* of the stride; double support: both of them */
    double step_time_symmetry_percent;    /* left: the step that ends with the left foot's strike */
    double push_off_J, push_off_J_per_kg; /* the device's on the walker, a step */
    double cost_of_transport;             /* of that work */
    double margin_of_stability_m;         /* just before heel strike */
    bool by_compass; /* a person's: way and speed are those of a compass of this leg length */
};

/* Over the last `over` steps that are whole. Cost O(over). */
void walking_of(const struct walk_record *record, const struct loop *loop, uint32_t over,
                struct walking *walking);

/* Time and speed of one step of the record: from the other foot's heel strike to the one that ends this row's stance;
 * NaN where either is missing. */
double walking_step_time_s(const struct walk_record *record, uint32_t row);

#endif
