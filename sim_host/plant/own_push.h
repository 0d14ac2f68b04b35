/* The wearer's own push-off, and how a person shares it with the device.
 *
 * Until a device helps, the wearer pushes off like a spring of the device's stiffness and
 * regulates the step's precompression themselves, by the same law as the controller's
 * (model/README.md, eq. (16) in forward speed) on the true apex speed. What the device has
 * already loaded and armed behind the trailing foot the wearer feels, and leaves that
 * share of the energy, (motor / wanted)^2, to it; what is not armed they do
 * themselves. So the push-off is handed over while the device engages and taken back
 * at the next step when it withdraws.
 * Plain doubles; plain data; O(1).
 */
#ifndef SIM_HOST_PLANT_OWN_PUSH_H
#define SIM_HOST_PLANT_OWN_PUSH_H

#include <stdbool.h>

#include "sim_host/plant/plant.h"

enum { OWN_PUSH_GAITS_MAX = 128 };

struct own_push_params {
    bool present;                     /* false: no push-off of their own, like the paper's walker */
    double start_rad_s;               /* forward apex speed they begin at, */
    double target_rad_s;              /* come to, */
    double ramp_rad_s;                /* by so much a step */
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
    double share;       /* of the push-off that is the wearer's, 0..1 */
};

/* Begins with the whole push-off the wearer's. */
void own_push_init(struct own_push *push, const struct own_push_params *params);

/* Once a tick, before plant_advance(). Nothing without params.present. */
void own_push_tick(struct own_push *push, struct plant *plant);

#endif
