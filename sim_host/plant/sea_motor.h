/* The motor of an actuator with its transmission, supply and heat; and the current loop of its drive.
 *
 * All motion counts in metres of spring (sea_keys.h), so the rotor's inertia is a mass.
 *   current:  L di/dt + R i + kt w = u, |u| <= supply. The loop cancels the winding's pole, so that
 *             below that limit i follows its command with current_bandwidth_rad_s. The torque-speed
 *             curve and the stall current follow from this equation, and are nowhere put in.
 *   motion:   m x'' = kt i rad_per_m - load - friction
 *   friction: of motor and transmission without load, and of the load by the efficiencies: moving
 *             against the load takes load / forward, holding back a moving load takes load * backward,
 *             and between the two the motor stands.
 *   supply:   u_bus = supply_V - supply_ohm * P / u_bus, of the power P drawn; what is fed back raises it.
 *             P has the other leg's power in it where both share a battery.
 *   heat:     winding -> housing -> ambient; the winding's resistance rises with its temperature.
 * Integrated by steps of the caller, with the trapezium rule in current and position: the work of every
 * term over a step closes its balance (test: 0.1 %).
 *
 * Plain data, no heap, no I/O; only + - * / and sqrt, so the bits are the same on every machine. O(1).
 */
#ifndef SIM_HOST_PLANT_SEA_MOTOR_H
#define SIM_HOST_PLANT_SEA_MOTOR_H

#include <stdbool.h>

#include "sim_host/plant/sea_config.h"

struct sea_motor {
    /* what follows from the config */
    double rad_per_m, mass_kg, force_per_A, coulomb_N, viscous_Ns_m;
    double load_mean,
        load_half; /* per newton of load: holding force, and half the gap between ways */
    double end_min_m, end_max_m;
    /* state */
    double position_m, speed_m_s, current_A;
    double bus_V;
    double other_W; /* that the other leg draws from the same battery now; 0: none does */
    double winding_degC, housing_degC;
    /* of the last step */
    double voltage_V, force_N, friction_N;
    bool voltage_limited, at_end_stop;
    /* since init: their sum is what the supply gave */
    double supplied_J, copper_J, friction_J, load_J, end_stop_J;
};

/* At rest at 0, without current, at ambient temperature. */
void sea_motor_init(struct sea_motor *motor, const struct sea_config *config);

/* One step of step_s seconds: asked_A is the current loop's command, already within its limits;
 * powered false opens the bridge: no current. load_N is the spring's force against the motor, in the
 * middle of the step. */
void sea_motor_step(struct sea_motor *motor, const struct sea_config *config, double asked_A,
                    bool powered, double load_N, double step_s);

/* The heat of period_s seconds in which copper_W went into the winding. */
void sea_motor_warm(struct sea_motor *motor, const struct sea_config *config, double copper_W,
                    double period_s);

/* Kinetic and magnetic energy now, J. */
double sea_motor_energy_J(const struct sea_motor *motor, const struct sea_config *config);

#endif
