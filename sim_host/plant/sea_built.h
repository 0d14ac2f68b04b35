/* An actuator as it is built, in the place of a SEA's idealised motor and spring (sea.h): the parts of
 * sea_config.h put together, and what they were asked to do.
 *
 * sea.h owns one, and says when a period begins; nobody else calls the functions here but tests and
 * sizing. Plain data: a copy is a snapshot. Cost of a period: drive_period_s / substep_s steps.
 */
#ifndef SIM_HOST_PLANT_SEA_BUILT_H
#define SIM_HOST_PLANT_SEA_BUILT_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/plant/sea_config.h"
#include "sim_host/plant/sea_loop.h"
#include "sim_host/plant/sea_motor.h"
#include "sim_host/plant/sea_spring.h"

/* What a duty came to, since it was last cleared; sizing and reports are made of it. */
struct sea_load {
    double time_s;
    double current_squares_A2s; /* integral of the current's square */
    double peak_current_A, peak_speed_m_s, peak_spring_N;
    double lowest_bus_V, peak_supply_A;
    double least_voltage_V; /* smallest reserve of bus voltage over what the motor took */
    double hottest_degC;
    double current_limited_s, voltage_limited_s, end_stop_s;
};

struct sea_built {
    struct sea_config config;
    struct sea_motor motor; /* at the start of the current period */
    struct sea_motor next;  /* at its end */
    struct sea_loop loop;
    struct sea_spring held;    /* behind a closed latch */
    struct sea_spring pushing; /* behind an open one: with the cuff in series */
    double spring_N_per_m;     /* secant over the stroke, as others see it */
    double spring_scale;       /* of a fault: 1 = as configured */
    double snap_J;             /* lost at releases, where the cuff takes up its load */
    double shared_from_J;      /* what was supplied when the battery's other leg was last told */
    struct sea_load load;
};

void sea_built_init(struct sea_built *built, const struct sea_config *config);

/* Compression that a motor at motor_m and a spring's end at output_m leave, after the backlash, m. */
double sea_built_compression_m(const struct sea_built *built, double motor_m, double output_m);

/* Force at this compression, behind a closed or an open latch, N; as configured, without the scale. */
double sea_built_force_N(const struct sea_built *built, bool latched, double compression_m);

/* Energy in the spring, and in the cuff when not latched, J; as configured. */
double sea_built_energy_J(const struct sea_built *built, bool latched, double compression_m);

/* One period of the drive: its loop once, then the motor in substeps against the spring whose end
 * stands at output_m. Afterwards next is the motor at the period's end, and load has the period. */
void sea_built_period(struct sea_built *built, enum sea_loop_mode mode, bool latched,
                      double output_m);

/* The period is over: motor becomes next. */
void sea_built_finish(struct sea_built *built);

/* The latch opens with the motor and the output where they are. */
void sea_built_release(struct sea_built *built, double output_m);

/* Two legs on one battery: tells each what the other drew on average in the last period_s seconds. Call once
 * so often; does nothing unless both configs say supply_shared. */
void sea_built_share(struct sea_built *left, struct sea_built *right, double period_s);

/* Begins to count the load anew. */
void sea_built_clear_load(struct sea_built *built);

/* Root mean square of the current since then, A. */
double sea_built_rms_A(const struct sea_built *built);

#endif
