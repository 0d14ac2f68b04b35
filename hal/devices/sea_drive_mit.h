/* SEA drives that speak the "MIT mode" of CubeMars / T-Motor AK actuators.
 *
 * One command frame a tick and motor, big-endian fields of 16, 12, 12, 12, 12 bits:
 * position, velocity, kp, kd, torque; each motor answers its command with id,
 * position, velocity, torque (and temperature, error). Ranges belong to the motor's
 * model and sources disagree: they are configuration, and a motor whose first
 * answer is no plausible position is refused as faulty.
 * Facts: CubeMars "AK Series Module Driver User Manual" section 5.3; Katz's mini
 * cheetah controller (mbed, T-Motor_AK80_BaseCode), where the fields come from.
 *
 * The answer's identifier must be set to something other than 0, which is NMT on a
 * CANopen bus. Zero torque is not representable: with kp = kd = 0 a command still
 * asks for half a step of torque. The drive has no reaction of its own to a dead
 * master but its own time-out, if it is set.
 */
#ifndef HAL_DEVICES_SEA_DRIVE_MIT_H
#define HAL_DEVICES_SEA_DRIVE_MIT_H

#include "hal/devices/sea_drives.h"

/* Half widths of the fields' ranges (positions run from -position to +position). */
struct mit_ranges {
    float position_rad;
    float velocity_rad_s;
    float torque_Nm;
    float kp_Nm_rad; /* from 0 */
    float kd_Nms_rad;
};

struct mit_axis_config {
    uint8_t motor_id;            /* 1..31; 0 = this leg has no such motor */
    uint16_t answer_id;          /* 1..0x7F, not a motor's */
    float rad_per_m;             /* motor angle per metre of spring, > 0 */
    float zero_rad;              /* angle at the unloaded spring */
    int8_t direction;            /* +1 or -1 */
    float kp_Nm_rad, kd_Nms_rad; /* position loop while enabled */
    float spring_N_per_m;        /* feed-forward of the spring's torque */
    float stroke_max_m;          /* a first answer beyond this is not this actuator */
    struct mit_ranges ranges;
};

struct mit_axis {
    struct mit_axis_config config;
    float position_rad;
    uint8_t error;
    uint8_t
        temperature_degC; /* read without an offset: a firmware that adds 40 seems hotter, not colder */
    bool has_temperature; /* its last answer was long enough to tell */
    uint16_t age_ticks;
    uint16_t enter_wait; /* ticks until the enter command may be repeated */
    bool entered;        /* in motor mode, as far as we know */
    bool refused;        /* first answer implausible: wrong ranges or wrong motor */
    bool clearing;       /* a reset was asked for and not sent yet */
    bool judge_again;    /* the next answer is judged like a first one */
};

struct mit_drives {
    struct mit_axis axis[SIDE_COUNT];
    uint32_t rx_malformed; /* saturates */
};

void mit_drives_init(struct mit_drives *drives, const struct mit_axis_config *config);
struct sea_drives mit_drives_interface(struct mit_drives *drives);

/* Field coding, shared with the virtual node: value in -range..range (or 0..range
 * for from_zero) to `bits` bits, saturating, and back. */
uint32_t mit_encode(float value, float range, bool from_zero, unsigned bits);
float mit_decode(uint32_t field, float range, bool from_zero, unsigned bits);

/* Last byte of the special frames FF FF FF FF FF FF FF xx. */
enum mit_special { MIT_ENTER = 0xFC, MIT_EXIT = 0xFD, MIT_ZERO = 0xFE };

#endif
