/* Every number that tunes the controller, in one struct, validated once.
 *
 * CONTROL_PARAM_TABLE is the single list of names, units and ranges. The person file's reader,
 * the validator and the object dictionary are made from it. Its fields are `real`, those of the
 * speed table `real` or 32-bit counts: in float there is no padding, so the bytes in flash and
 * under a checksum are the same everywhere. The gait branch is only pointed to; it is stored and
 * checked by itself.
 *
 * The ranges are what laws and arithmetic can work with, from a 1 kg table-top walker to a 150 kg
 * person. A person's own limits are set inside them.
 */
#ifndef CONTROLLER_CONTROL_PARAMS_H
#define CONTROLLER_CONTROL_PARAMS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "controller/estimator/body_table.h"
#include "controller/laws/gait_branch.h"
#include "controller/laws/law_table.h"
#include "controller/laws/speed_table.h"
#include "model/real.h"

#define control_params_speeds REAL_SYMBOL(control_params_speeds)
#define control_params_validate REAL_SYMBOL(control_params_validate)
#define control_param_descriptors REAL_SYMBOL(control_param_descriptors)

/* "; 0 proportional" and so on, for a parameter's meaning. */
#define LAW_CHOICE(value, number, id, name) "; " #number " " name
#define BODY_CHOICE(value, number, id, name) "; " #number " " name

/*  X(field, unit, minimum, maximum, meaning). New rows of the first table stand behind the second's: a row is a
 * sub-index of object 0x2010, and those never change their meaning. */
#define CONTROL_PARAM_OPEN_TABLE(X)                                                              \
    X(torso_mass_kg, "kg", 0.1, 200.0, "M, the mass at the hip")                                 \
    X(leg_mass_kg, "kg", 0.0001, 30.0, "m, the mass in the middle of each leg")                  \
    X(leg_length_m, "m", 0.1, 1.5, "l, hip to heel")                                             \
    X(spring_stiffness_n_m, "N/m", 1.0, 100000.0, "k of the ankle spring")                       \
    X(gravity_m_s2, "m/s^2", 1.0, 20.0, "g")                                                     \
    X(law, "-", 0.0, LAW_LARGEST, "law of the push-off" LAW_TABLE(LAW_CHOICE))                   \
    X(kp_m_s_rad, "m/(rad/s)", 0.0, 1.0, "gain of eq. (16) on the forward apex speed")           \
    X(start_r0_m, "m", 0.0001, 0.6, "precompression that walking starts from; a person's r0*")   \
    X(speed_ramp_rad_s, "rad/s per step", 0.00001, 1.0, "largest change of the speed command")   \
    X(r0_min_m, "m", 0.0001, 0.6, "smallest precompression the law may ask for")                 \
    X(r0_max_m, "m", 0.0001, 0.6, "largest precompression the law may ask for")                  \
    X(r0_change_max_m, "m per step", 0.00001, 0.6, "largest change of r0 from step to step")     \
    X(open_loop_r0_m, "m", 0.0001, 0.6, "r0 of the open-loop law")                               \
    X(open_loop_ramp_m, "m per step", 0.000001, 0.6, "its ramp from start_r0_m")                 \
    X(apex_window_s, "s", 0.004, 0.1, "half width of the fit around the apex")                   \
    X(angle_hysteresis_rad, "rad", 0.0001, 0.2, "swing of an angle below which it is no event")  \
    X(body, "-", 0.0, BODY_LARGEST, "whose gait it is" BODY_TABLE(BODY_CHOICE))                  \
    X(sensor_latency_s, "s", 0.0, 0.02,                                                          \
      "age of a leg sample at its SYNC; event times allow for it")                               \
    X(angle_zero_left_rad, "rad", -0.2, 0.2, "what the left leg angle reads upright: zeroing.h") \
    X(angle_zero_right_rad, "rad", -0.2, 0.2, "the right one")                                   \
    X(ankle_zero_left_m, "m", -0.03, 0.03, "what the left ankle reads with the heel down")       \
    X(ankle_zero_right_m, "m", -0.03, 0.03, "the right one")                                     \
    X(sea_speed_max_m_s, "m/s", 0.001, 10.0, "speed limit of the SEA reference")                 \
    X(sea_acceleration_m_s2, "m/s^2", 0.01, 1000.0, "acceleration limit of the SEA reference")   \
    X(sea_tolerance_m, "m", 0.00001, 0.05,                                                       \
      "the spring counts as loaded, or unloaded, within this")                                   \
    X(sensor_age_max_s, "s", 0.001, 0.1, "older leg or drive values are a fault")                \
    X(step_timeout_s, "s", 0.2, 10.0, "no apex for this long: walking has ended")                \
    X(fall_angle_rad, "rad", 0.3, 1.57, "a leg beyond this angle is a fall")                     \
    X(unload_timeout_s, "s", 0.01, 2.0, "unloading longer than this ends with torque off")       \
    X(engage_steps, "-", 0.0, 50.0,                                                              \
      "steady steps before assistance; 0 = test mode: loaded at once")                           \
    X(engage_ramp_steps, "-", 1.0, 100.0, "steps over which the assist level rises to 1")        \
    X(terrain_speed_rad_s, "rad/s", 0.0, 20.0,                                                   \
      "predictive law: highest speed it may aim for on uneven ground; 0 = the command")          \
    X(foot_switches, "-", 0.0, 1.0,                                                              \
      "a person's feet: 1 = switches under both, also at the latches")                           \
    X(strike_error_s, "s", 0.0, 0.1,                                                             \
      "a person without switches: largest error of heel strikes, fitted; 0 = no assistance")     \
    X(strike_bias_left_s, "s", -0.08, 0.08, "a person's left heel strikes are found so late")    \
    X(strike_bias_right_s, "s", -0.08, 0.08, "the right ones")                                   \
    X(toe_off_bias_left_s, "s", -0.08, 0.08, "a person's left toe-offs are found so late")       \
    X(toe_off_bias_right_s, "s", -0.08, 0.08, "the right ones")

/* What a tool on the bus must not change: it limits what a tool may. Made with the settings. */
#define CONTROL_PARAM_LOCKED_TABLE(X)                                                        \
    X(kp_low_m_s_rad, "m/(rad/s)", 0.0, 1.0, "over the bus kp_m_s_rad may be set from here") \
    X(kp_high_m_s_rad, "m/(rad/s)", 0.0, 1.0,                                                \
      "to here: what this walker's gaits bear; 0 = not at all")                              \
    X(r0_ceiling_m, "m", 0.0, 0.6,                                                           \
      "over the bus r0_max_m may be set to here; 0 = it may be lowered only")                \
    X(r0_change_ceiling_m, "m per step", 0.0, 0.6, "likewise r0_change_max_m")

#define CONTROL_PARAM_TABLE(X) CONTROL_PARAM_OPEN_TABLE(X) CONTROL_PARAM_LOCKED_TABLE(X)

#define CONTROL_PARAM_FIELD(field, unit, minimum, maximum, meaning) real field;
struct control_params {
    CONTROL_PARAM_TABLE(CONTROL_PARAM_FIELD)
    struct speed_table table; /* finv of eq. (16) for this walker */
    /* What the laws beyond eq. (16) need, or NULL without. Too large to be kept twice: it stays
     * where it is, in flash on the device, and does not change while it is pointed to. */
    const struct gait_branch *branch;
};
#undef CONTROL_PARAM_FIELD

#define CONTROL_PARAM_COUNT_ONE(field, unit, minimum, maximum, meaning) +1
enum {
    CONTROL_PARAM_COUNT = 0 CONTROL_PARAM_TABLE(CONTROL_PARAM_COUNT_ONE),
    CONTROL_PARAMS_LOCKED = 0 CONTROL_PARAM_LOCKED_TABLE(CONTROL_PARAM_COUNT_ONE)
};
#undef CONTROL_PARAM_COUNT_ONE

struct control_param_descriptor {
    const char *name;
    const char *unit;
    real minimum;
    real maximum;
    const char *meaning;
    uint16_t offset; /* of the field in struct control_params, bytes */
};

extern const struct control_param_descriptor control_param_descriptors[CONTROL_PARAM_COUNT];

/* What control_params_validate found. */
enum {
    CONTROL_PARAMS_OK = -1,
    CONTROL_PARAMS_BAD_TABLE = CONTROL_PARAM_COUNT,     /* speed table unusable */
    CONTROL_PARAMS_R0_ORDER = CONTROL_PARAM_COUNT + 1,  /* not r0_min <= start_r0 <= r0_max */
    CONTROL_PARAMS_R0_STROKE = CONTROL_PARAM_COUNT + 2, /* r0_max beyond 0.4 leg lengths */
    CONTROL_PARAMS_OPEN_LOOP = CONTROL_PARAM_COUNT + 3, /* open_loop_r0 outside r0_min..r0_max */
    CONTROL_PARAMS_LAW = CONTROL_PARAM_COUNT + 4,       /* no such law */
    CONTROL_PARAMS_ENGAGE =
        CONTROL_PARAM_COUNT + 6, /* a person, and no steady step before assistance */
    CONTROL_PARAMS_BRANCH =
        CONTROL_PARAM_COUNT + 5, /* the law needs a gait branch; none, or unusable */
    CONTROL_PARAMS_GAIN_RANGE = CONTROL_PARAM_COUNT + 7,        /* kp_low above kp_high */
    CONTROL_PARAMS_GAIN = CONTROL_PARAM_COUNT + 8,              /* kp outside kp_low..kp_high */
    CONTROL_PARAMS_R0_CEILING = CONTROL_PARAM_COUNT + 9,        /* r0_max above r0_ceiling */
    CONTROL_PARAMS_R0_CHANGE_CEILING = CONTROL_PARAM_COUNT + 10 /* r0_change_max above its own */
};

/* Checks every field against its range and the fields against each other, what is locked for a person (a
 * ceiling of 0 is none) among them.
 * Returns CONTROL_PARAMS_OK, the index into control_param_descriptors of the
 * first field out of range or not finite, or one of the codes above. Bounded:
 * one pass over the fields and the table. */
int control_params_validate(const struct control_params *params);

/* Test mode (engage_steps = 0): a walker without a push-off of its own, held by a hand until the
 * first spring is loaded. Otherwise a person walks by themselves, and steady steps come first. */
static inline bool control_params_test_mode(const struct control_params *params)
{
    return params->engage_steps == REAL(0.0);
}

/* The desired forward apex speeds (rad/s) that the law in force serves this walker at, *low_rad_s to
 * *high_rad_s: gaits whose push-off leaves eq. (16) 5 % of r0_max to catch an excursion with, and for a
 * law that knows a branch of gaits only those it covers. Empty (low above high) if there are none.
 * *params must be valid. Cost: two table look-ups. */
void control_params_speeds(const struct control_params *params, real *low_rad_s, real *high_rad_s);

#endif
