/* The spring of an actuator: a line or a table, one-way or two-way, with hysteresis, and in series with
 * the cuff once its latch is open.
 *
 * Hysteresis is rate-independent: going in the force lies above the table's, coming out below it, by
 * shares that make a full cycle lose the stated part of the energy. Between the two the force moves over
 * SEA_SPRING_TURN of the spring's range.
 *
 * Plain data; every function is O(points) and pure but for the state it is given.
 */
#ifndef SIM_HOST_PLANT_SEA_SPRING_H
#define SIM_HOST_PLANT_SEA_SPRING_H

#include "sim_host/plant/sea_config.h"

#define SEA_SPRING_TURN 0.01

struct sea_spring {
    struct sea_table curve; /* from (0, 0); rising */
    double hysteresis, limit_m;
    bool two_way;
    double wave; /* -1 coming out .. 1 going in */
    double at_m; /* compression at the last move */
};

/* The config's spring alone; with the cuff in series. */
void sea_spring_init(struct sea_spring *spring, const struct sea_config *config);
void sea_spring_init_with_cuff(struct sea_spring *spring, const struct sea_config *config);

/* The spring is compressed to compression_m: its hysteresis follows. */
void sea_spring_move(struct sea_spring *spring, double compression_m);

/* Force at compression_m, N; below 0 only two-way. */
double sea_spring_force_N(const struct sea_spring *spring, double compression_m);

/* Energy stored at compression_m, J: the table's, without hysteresis. */
double sea_spring_energy_J(const struct sea_spring *spring, double compression_m);

/* The straight line through the force near compression_m: force = stiffness (c - zero_m). */
void sea_spring_line(const struct sea_spring *spring, double compression_m,
                     double *stiffness_N_per_m, double *zero_m);

#endif
