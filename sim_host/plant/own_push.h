/* The person's own push-off, and how the person shares it with the device.
 *
 * Without the device's help the person pushes off like a spring of the device's stiffness. The
 * person chooses each step's precompression by the law of the controller, eq. (16) in model/README.md,
 * from the true apex speed. The person feels what the device has loaded and armed behind
 * the trailing foot, and leaves that share of the energy, (motor / wanted)^2, to the device. So
 * the person hands the push-off over while the device engages, and takes it back at the next step
 * when the device withdraws.
 * Plain doubles; plain data; O(1).
 */
#ifndef SIM_HOST_PLANT_OWN_PUSH_H
#define SIM_HOST_PLANT_OWN_PUSH_H

#include <stdbool.h>

#include "sim_host/plant/plant.h"

enum { OWN_PUSH_GAITS_MAX = 128 };

struct own_push_params {
    bool present;                     /* false: no own push-off, like the paper's walker */
    double start_rad_s;               /* forward apex speed at the start */
    double target_rad_s;              /* and at the end of the ramp */
    double ramp_rad_s;                /* change of speed a step */
    int count;                        /* steady gaits of this body: speed at a precompression of */
    double rest_first_m, rest_step_m; /* rest_first_m + i * rest_step_m */
    double speed_rad_s[OWN_PUSH_GAITS_MAX]; /* rising */
    double gain_m_s_rad;                    /* of the law, > 0 stabilises */
    double rest_max_m;
    double spring_N_per_m;
};

struct own_push {
    struct own_push_params params;
    double speed_rad_s; /* walked at now */
    double wanted_m;    /* of this step */
    double apex_time_s; /* of the apex that wanted_m follows from */
    double share;       /* of the push-off that is the person's, 0..1 */
};

/* Starts with the whole push-off done by the person. */
void own_push_init(struct own_push *push, const struct own_push_params *params);

/* Sets the plant's own push-off. Call once a tick, before plant_advance(). Does nothing without
 * params.present. */
void own_push_tick(struct own_push *push, struct plant *plant);

#endif
