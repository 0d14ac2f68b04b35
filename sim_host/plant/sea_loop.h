/* The loops of a drive: its reference between two targets, the position loop around the speed loop, and
 * their command to the current loop (sea_motor.h).
 *
 * Cyclic synchronous position: a target comes every tick. The reference between them is the quadratic
 * B-spline of the last three targets. So its speed is continuous, its acceleration is constant over a
 * tick, and a motor that accelerates evenly gets an even force. It costs half a tick of delay. A tick
 * without a target repeats the last one.
 *   speed asked   = ff_speed * v_ref + position_gain * (x_ref - x), within +- the speed limit
 *   current asked = mass (ff_acceleration * a_ref + bandwidth (v_asked - v) + integral) / force_per_A,
 *                   within +- the peak current; above the continuous current it has the energy of
 *                   SEA_LOOP_PEAK_S seconds at the peak (I^2 t), then the limit is the continuous one
 * x and v are the motor encoder's: v is the filtered difference of its counts.
 *
 * Plain data, O(1).
 */
#ifndef SIM_HOST_PLANT_SEA_LOOP_H
#define SIM_HOST_PLANT_SEA_LOOP_H

#include <stdbool.h>

#include "sim_host/plant/sea_config.h"

#define SEA_LOOP_PEAK_S 1.0

struct sea_loop {
    double mass_kg, force_per_A, counts_per_m;
    double target_m[3];  /* of the last three ticks, the newest last */
    double since_tick_s; /* since the newest target */
    double unload_m;     /* the drive's own reference while it unloads */
    double reference_m, reference_speed_m_s, reference_acceleration_m_s2;
    double measured_m, measured_speed_m_s;
    double integral_m_s2;
    double heat_A2s; /* above the continuous current; the budget's use */
    double asked_A;
    bool current_limited; /* asked for more than the limit in the last period */
    bool speed_limited;
    bool folded_back; /* the I^2 t budget is used up */
};

void sea_loop_init(struct sea_loop *loop, const struct sea_config *config);

/* The drive begins to follow: everything from where the motor is. */
void sea_loop_start(struct sea_loop *loop, double motor_m, double motor_m_s);

/* A SYNC: the next target, m of spring. */
void sea_loop_target(struct sea_loop *loop, double target_m);

enum sea_loop_mode { SEA_LOOP_OFF = 0, SEA_LOOP_FOLLOW = 1, SEA_LOOP_UNLOAD = 2 };

/* One period of the drive: reads the encoder (motor_m, true), moves the reference, and returns the
 * current that is asked for (0 when off). */
double sea_loop_period(struct sea_loop *loop, const struct sea_config *config,
                       enum sea_loop_mode mode, double motor_m);

#endif
