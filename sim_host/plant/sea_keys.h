/* Every value of an actuator as it is built: name, unit, range, fallback, meaning.
 *
 * The one list that the struct, the reader of a device file's sections [left.plant] and
 * [right.plant], the checks and the help are made from (sea_config.h).
 *   X(field, unit, minimum, maximum, fallback, meaning)
 * fallback SEA_ASKED: there is none, a file has to say it. "m of spring" counts along the spring:
 * with a latched output the spring's compression is the motor's way. A value at the motor's shaft
 * has rad in its unit.
 */
#ifndef SIM_HOST_PLANT_SEA_KEYS_H
#define SIM_HOST_PLANT_SEA_KEYS_H

/* Not a number: below and above every range, so that an unsaid key is found by its range. */
#define SEA_ASKED (__builtin_nan(""))

#define SEA_MOTOR_KEYS(X)                                                                         \
    X(motor_inertia_kg_m2, "kg m^2", 1e-9, 1.0, SEA_ASKED, "of the rotor")                        \
    X(torque_constant_Nm_A, "N m/A", 1e-4, 10.0, SEA_ASKED,                                       \
      "torque per ampere, and volts per rad/s")                                                   \
    X(resistance_ohm, "ohm", 1e-4, 1e3, SEA_ASKED, "terminal to terminal, winding at 25 degC")    \
    X(resistance_per_K, "1/K", 0.0, 0.02, 0.00393, "its rise with the winding's temperature")     \
    X(inductance_H, "H", 1e-7, 1.0, SEA_ASKED, "terminal to terminal")                            \
    X(current_continuous_A, "A", 1e-3, 1e3, SEA_ASKED, "the data sheet's for ever")               \
    X(current_peak_A, "A", 1e-3, 1e4, SEA_ASKED, "limit that is set in the drive")                \
    X(motor_speed_max_rad_s, "rad/s", 1.0, 1e5, SEA_ASKED, "permitted by bearings and gear")      \
    X(motor_coulomb_Nm, "N m", 0.0, 10.0, 0.0, "friction at the shaft (no-load current)")         \
    X(motor_viscous_Nms_rad, "N m s/rad", 0.0, 1.0, 0.0, "speed-dependent friction at the shaft") \
    X(winding_thermal_K_W, "K/W", 1e-3, 1e3, SEA_ASKED, "winding to housing")                     \
    X(winding_thermal_time_s, "s", 0.1, 1e5, SEA_ASKED, "time constant of the winding")           \
    X(housing_thermal_K_W, "K/W", 1e-3, 1e3, SEA_ASKED, "housing to ambient, as mounted")         \
    X(housing_thermal_time_s, "s", 1.0, 1e6, SEA_ASKED, "time constant of the housing")           \
    X(winding_max_degC, "degC", 30.0, 300.0, 155.0, "the data sheet's limit")                     \
    X(ambient_degC, "degC", -40.0, 60.0, 25.0, "of the air")                                      \
    X(motor_mass_kg, "kg", 0.0, 50.0, 0.0, "with encoder; 0: not told")

#define SEA_TRANSMISSION_KEYS(X)                                                                   \
    X(gear_ratio, "", 1e-3, 1e4, 1.0, "motor turns per turn of screw or drum")                     \
    X(travel_per_turn_m, "m", 1e-5, 10.0, SEA_ASKED, "lead of the screw, or way per turn of drum") \
    X(efficiency_forward, "", 0.01, 1.0, SEA_ASKED,                                                \
      "share of power that arrives, motor to spring")                                              \
    X(efficiency_backward, "", -5.0, 1.0, SEA_ASKED,                                               \
      "the same, spring to motor; 0 and below: the screw holds by itself")                         \
    X(transmission_inertia_kg_m2, "kg m^2", 0.0, 1.0, 0.0,                                         \
      "of gear and screw, at the motor's shaft")                                                   \
    X(transmission_coulomb_N, "N", 0.0, 1e5, 0.0, "friction without load, at the spring")          \
    X(transmission_viscous_Ns_m, "N s/m", 0.0, 1e7, 0.0,                                           \
      "speed-dependent friction, at the spring")                                                   \
    X(backlash_m, "m", 0.0, 0.01, 0.0, "free way between motor and spring")                        \
    X(transmission_mass_kg, "kg", 0.0, 50.0, 0.0, "0: not told")

#define SEA_SPRING_KEYS(X)                                                                        \
    X(spring_N_per_m, "N/m", 0.0, 1e7, 0.0, "linear spring; 0: by spring_Nm_rad or spring_table") \
    X(spring_Nm_rad, "N m/rad", 0.0, 1e6, 0.0, "torsion spring; 0: none")                         \
    X(spring_arm_m, "m", 0.0, 1.0, 0.0, "of the torsion spring: it gives spring_Nm_rad / arm^2")  \
    X(spring_limit_m, "m", 1e-4, 1.0, SEA_ASKED, "compression at which it is solid")              \
    X(spring_hysteresis, "", 0.0, 0.5, 0.0, "share of the stored energy that a cycle loses")      \
    X(two_way, "", 0.0, 1.0, 0.0, "1: the spring pulls, too; 0: a cable or a stop, pushes only")  \
    X(cuff_N_per_m, "N/m", 0.0, 1e7, 0.0, "cuff and leg, at the lever's end; 0: stiff")           \
    X(spring_mass_kg, "kg", 0.0, 50.0, 0.0, "0: not told")                                        \
    X(lever_m, "m", 0.01, 0.5, SEA_ASKED, "of the spring at the ankle, at the neutral angle")     \
    X(structure_mass_kg, "kg", 0.0, 50.0, 0.0, "frame, shoe, cuff, drive and latch; 0: not told")

#define SEA_SUPPLY_KEYS(X)                                                                   \
    X(supply_V, "V", 1.0, 1e3, SEA_ASKED, "without load")                                    \
    X(supply_ohm, "ohm", 0.0, 100.0, SEA_ASKED, "of battery and cables")                     \
    X(supply_current_max_A, "A", 0.01, 1e4, SEA_ASKED, "that the battery or its fuse bears") \
    X(supply_shared, "", 0.0, 1.0, 0.0,                                                      \
      "1: one battery for both legs: it sags by what both draw; 0: one each")                \
    X(supply_energy_Wh, "W h", 0.0, 1e5, 0.0, "of the battery for this leg; 0: not told")    \
    X(supply_mass_kg, "kg", 0.0, 50.0, 0.0, "of the battery for this leg; 0: not told")

#define SEA_DRIVE_KEYS(X)                                                                       \
    X(drive_period_s, "s", 1e-5, 1e-3, 1e-4, "of the position and speed loops; divides 1 ms")   \
    X(position_gain_1_s, "1/s", 0.1, 1e4, SEA_ASKED, "speed per error of position")             \
    X(speed_bandwidth_rad_s, "rad/s", 1.0, 1e5, SEA_ASKED, "of the speed loop")                 \
    X(speed_integral_rad_s, "rad/s", 0.0, 1e4, 0.0, "corner of its integral part")              \
    X(current_bandwidth_rad_s, "rad/s", 10.0, 1e6, 6283.0, "of the current loop")               \
    X(feed_forward_speed, "", 0.0, 1.0, 1.0, "share of the target's speed that is fed forward") \
    X(feed_forward_acceleration, "", 0.0, 1.0, 1.0, "share of the target's acceleration")       \
    X(encoder_counts_per_turn, "counts", 4.0, 1e9, SEA_ASKED, "of the motor")                   \
    X(speed_limit_m_s, "m/s", 1e-4, 100.0, SEA_ASKED, "set in the drive, m/s of spring")        \
    X(stroke_max_m, "m", 1e-4, 1.0, SEA_ASKED, "largest compression that is obeyed")            \
    X(end_stop_m, "m", 0.0, 0.1, 0.002, "the hard stops lie so far outside the stroke")         \
    X(unload_rate_m_s, "m/s", 1e-4, 100.0, SEA_ASKED, "at which the drive unloads by itself")   \
    X(substep_s, "s", 1e-6, 1e-4, 1e-5, "of the plant's integrator; not longer than the period")

#define SEA_LATCH_KEYS(X)                                                                   \
    X(latch_holding_N, "N", 0.0, 1e6, SEA_ASKED, "more than this it does not hold; new")    \
    X(latch_wear_per_release, "", 0.0, 1e-3, 0.0,                                           \
      "share of the holding force that each release takes")                                 \
    X(latch_slip_m_s, "m/s", 0.0, 10.0, 0.0, "overloaded it creeps so fast; 0: it opens")   \
    X(latch_release_s, "s", 0.0, 0.05, SEA_ASKED, "from the cause until it is open")        \
    X(latch_jitter_s, "s", 0.0, 0.05, SEA_ASKED, "up to this is added, uniformly")          \
    X(latch_reclose_s, "s", 0.0, 0.5, SEA_ASKED, "from home until it holds again")          \
    X(latch_reclose_m, "m", 0.0, 0.01, SEA_ASKED, "it can close from here on, m of spring") \
    X(latch_trigger_m, "m", 1e-6, 0.1, 2e-4, "ankle extension that releases it, armed")

#define SEA_CONFIG_KEYS(X)   \
    SEA_MOTOR_KEYS(X)        \
    SEA_TRANSMISSION_KEYS(X) \
    SEA_SPRING_KEYS(X)       \
    SEA_SUPPLY_KEYS(X)       \
    SEA_DRIVE_KEYS(X)        \
    SEA_LATCH_KEYS(X)

#endif
