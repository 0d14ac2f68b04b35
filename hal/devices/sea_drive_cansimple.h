/* SEA drives that speak ODrive's CANSimple (firmware 0.5.x).
 *
 * Identifier = node << 5 | command, little-endian. Position in turns; the drive
 * sends its encoder estimates cyclically (set encoder_rate_ms to the tick, whole ms) and its
 * heartbeat every 100 ms. Node ids must keep clear of CANopen: node 4 owns 0x080.
 * From firmware 0.5.4 on the heartbeat has 8 bytes; the last three carry flags of errors in motor,
 * encoder and controller (bit 0 of each; bit 7 of the last is "trajectory done").
 * Facts: ODrive firmware 0.5.4, can_simple.cpp, send_heartbeat; ODrive documentation "CAN Protocol" (0.5.4); the crate odrive-cansimple
 * (command and state numbers); Open FFBoard ODriveCAN.h (mode numbers).
 *
 * What this drive cannot do: unload a spring by itself. When its watchdog expires it
 * goes idle and the spring drives the motor back; a brake or a worm must hold that.
 */
#ifndef HAL_DEVICES_SEA_DRIVE_CANSIMPLE_H
#define HAL_DEVICES_SEA_DRIVE_CANSIMPLE_H

#include "hal/devices/sea_drives.h"

struct cansimple_axis_config {
    uint8_t node;      /* 1..63, not 4; 0 = this leg has no such drive */
    float turns_per_m; /* motor turns per metre of spring, > 0 */
    float zero_turns;  /* estimate at the unloaded spring */
    int8_t direction;  /* +1 or -1 */
};

struct cansimple_axis {
    struct cansimple_axis_config config;
    float position_turns;
    uint32_t axis_error;
    bool part_error;  /* motor, encoder or controller has an error; axis_error may be 0 then */
    bool disarmed;    /* left closed loop by itself while enabled; until the command is withdrawn */
    bool was_enabled; /* in closed loop since the command to enable */
    uint16_t clear_wait; /* until a further reset is taken */
    bool leaving;        /* was told to leave closed loop, and its heartbeat has not said so yet */
    bool clearing;       /* a reset was asked for and Clear Errors is not sent yet */
    bool mode_is_told;   /* the controller mode went out, closed loop did not yet */
    uint8_t axis_state;
    uint16_t age_ticks;           /* of the position */
    uint16_t heartbeat_age_ticks; /* of error and state */
    uint16_t repeat_wait;         /* until mode or state request is sent again */
};

struct cansimple_drives {
    struct cansimple_axis axis[SIDE_COUNT];
    uint32_t rx_malformed; /* wrong length, or a position that is not finite; saturates */
};

/* Starts with nothing received. config: SIDE_COUNT entries, copied. */
void cansimple_drives_init(struct cansimple_drives *drives,
                           const struct cansimple_axis_config *config);

/* The drives behind the common interface; *drives stays the caller's. */
struct sea_drives cansimple_drives_interface(struct cansimple_drives *drives);

/* Command numbers, shared with the virtual node. */
enum cansimple_command {
    CANSIMPLE_HEARTBEAT = 0x01,
    CANSIMPLE_ESTOP = 0x02,
    CANSIMPLE_SET_AXIS_STATE = 0x07,
    CANSIMPLE_ENCODER_ESTIMATES = 0x09,
    CANSIMPLE_SET_CONTROLLER_MODE = 0x0B,
    CANSIMPLE_SET_INPUT_POS = 0x0C,
    CANSIMPLE_CLEAR_ERRORS = 0x18
};

enum cansimple_axis_state { CANSIMPLE_STATE_IDLE = 1, CANSIMPLE_STATE_CLOSED_LOOP = 8 };

enum { CANSIMPLE_MODE_POSITION = 3, CANSIMPLE_INPUT_PASSTHROUGH = 1 };

#endif
