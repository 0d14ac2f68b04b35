#include "hal/devices/device_drives.h"

#include <stddef.h>

/* Half widths of the MIT fields for the gains, the same for all of these motors. */
#define MIT_KP_RANGE 500.0f
#define MIT_KD_RANGE 5.0f

static struct cia402_axis_config cia402_of(const struct device_description *device, int leg)
{
    const struct device_leg *own = &device->leg[leg];
    const struct device_leg *other = &device->leg[SIDE_COUNT - 1 - leg];
    const bool shared = own->protocol == DEVICE_CIA402 && other->protocol == DEVICE_CIA402 &&
                        !device_leg_lacks(own, DEVICE_LACKS_DUMMY) &&
                        !device_leg_lacks(other, DEVICE_LACKS_DUMMY);
    return (struct cia402_axis_config){
        .counts_per_m = own->counts_per_m,
        .zero_counts = own->zero_counts,
        .direction = (int8_t)own->direction,
        .rated_force_N = own->rated_force_N,
        .absent = own->protocol != DEVICE_CIA402,
        .own_target = !shared,
        .no_outputs = device_leg_lacks(own, DEVICE_LACKS_OUTPUTS),
        .no_torque = device_leg_lacks(own, DEVICE_LACKS_TORQUE),
        .no_temperature = device_leg_lacks(own, DEVICE_LACKS_TEMPERATURE),
        .no_voltage = device_leg_lacks(own, DEVICE_LACKS_BUS_VOLTAGE),
        .no_follows_bit = device_leg_lacks(own, DEVICE_LACKS_FOLLOWS_BIT),
        .interpolated = own->mode == DEVICE_MODE_INTERPOLATED,
        .no_latch_bit = own->latch != DEVICE_LATCH_DRIVE,
        .latch_bit = (uint8_t)own->latch_bit,
        .contact_bit = (uint8_t)own->contact_bit,
    };
}

static struct cansimple_axis_config cansimple_of(const struct device_leg *own)
{
    return (struct cansimple_axis_config){
        .node = own->protocol == DEVICE_CANSIMPLE ? (uint8_t)own->drive_node : 0,
        .turns_per_m = own->turns_per_m,
        .zero_turns = own->zero_turns,
        .direction = (int8_t)own->direction,
    };
}

static struct mit_axis_config mit_of(const struct device_leg *own)
{
    return (struct mit_axis_config){
        .motor_id = own->protocol == DEVICE_MIT ? (uint8_t)own->drive_node : 0,
        .answer_id = (uint16_t)own->answer_id,
        .rad_per_m = own->rad_per_m,
        .zero_rad = own->zero_rad,
        .direction = (int8_t)own->direction,
        .kp_Nm_rad = own->kp_Nm_rad,
        .kd_Nms_rad = own->kd_Nms_rad,
        .spring_N_per_m = own->spring_N_per_m,
        .stroke_max_m = own->stroke_max_m,
        .ranges = {own->position_range_rad, own->velocity_range_rad_s, own->torque_range_Nm,
                   MIT_KP_RANGE, MIT_KD_RANGE},
    };
}

void device_drives_init(struct device_drives *drives, const struct device_description *device)
{
    struct cia402_axis_config cia402[SIDE_COUNT];
    struct cansimple_axis_config cansimple[SIDE_COUNT];
    struct mit_axis_config mit[SIDE_COUNT];
    bool boards[SIDE_COUNT];
    *drives = (struct device_drives){0};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &device->leg[leg];
        cia402[leg] = cia402_of(device, leg);
        cansimple[leg] = cansimple_of(own);
        mit[leg] = mit_of(own);
        boards[leg] = device_leg_is_driven(own) && own->latch == DEVICE_LATCH_BOARD;
        drives->state.protocol[leg] = (uint8_t)own->protocol;
    }
    cia402_drives_init(&drives->state.cia402, cia402);
    cansimple_drives_init(&drives->state.cansimple, cansimple);
    mit_drives_init(&drives->state.mit, mit);
    latch_boards_init(&drives->state.latches, boards);
    drives->own[DEVICE_CIA402] = cia402_drives_interface(&drives->state.cia402);
    drives->own[DEVICE_CANSIMPLE] = cansimple_drives_interface(&drives->state.cansimple);
    drives->own[DEVICE_MIT] = mit_drives_interface(&drives->state.mit);
}

static bool has_protocol(const struct device_drives *drives, unsigned protocol)
{
    return drives->state.protocol[SIDE_LEFT] == protocol ||
           drives->state.protocol[SIDE_RIGHT] == protocol;
}

size_t device_drives_state_bytes(const struct device_drives *drives)
{
    const bool makers = has_protocol(drives, DEVICE_CANSIMPLE) || has_protocol(drives, DEVICE_MIT);
    return makers ? sizeof drives->state : offsetof(struct device_drives_state, cansimple);
}

static void sum_malformed(struct device_drives *drives)
{
    const uint64_t sum = (uint64_t)drives->state.cia402.rx_malformed +
                         drives->state.cansimple.rx_malformed + drives->state.mit.rx_malformed +
                         drives->state.latches.rx_malformed;
    drives->rx_malformed = sum < UINT32_MAX ? (uint32_t)sum : UINT32_MAX;
}

static bool receive(void *context, const struct can_msg *message)
{
    struct device_drives *drives = (struct device_drives *)context;
    bool taken = latch_boards_receive(&drives->state.latches, message);
    for (unsigned protocol = DEVICE_CIA402; protocol <= DEVICE_MIT && !taken; protocol++) {
        if (has_protocol(drives, protocol)) {
            const struct sea_drives *own = &drives->own[protocol];
            taken = own->ops->receive(own->context, message);
        }
    }
    return taken;
}

static void read_axis(const void *context, enum side leg, struct sea_drive_reading *reading)
{
    const struct device_drives *drives = (const struct device_drives *)context;
    if (drives->state.protocol[leg] == DEVICE_NO_DRIVE_PROTOCOL) {
        reading->age_ticks = 0;
        reading->absent = true;
        reading->state = drives->state.enabled[leg] ? DRIVE_ENABLED : DRIVE_DISABLED;
        return;
    }
    const struct sea_drives own = drives->own[drives->state.protocol[leg]];
    own.ops->read(own.context, leg, reading);
    if (drives->state.latches.board[leg].present) {
        reading->latch = latch_boards_state(&drives->state.latches, leg);
    }
}

static void age(void *context)
{
    struct device_drives *drives = (struct device_drives *)context;
    for (unsigned protocol = DEVICE_CIA402; protocol <= DEVICE_MIT; protocol++) {
        if (has_protocol(drives, protocol)) {
            const struct sea_drives own = drives->own[protocol];
            own.ops->age(own.context);
        }
    }
    latch_boards_age(&drives->state.latches);
    sum_malformed(drives);
}

static bool is_enabled(const struct device_drives *drives, enum side leg)
{
    struct sea_drive_reading reading = {.age_ticks = UINT16_MAX};
    read_axis(drives, leg, &reading);
    return reading.state == DRIVE_ENABLED;
}

/* A board is armed only beside a drive that follows its target. */
static enum can_result arm_latches(struct device_drives *drives,
                                   const struct sea_drive_command *command,
                                   const struct can_bus *bus)
{
    enum can_result first_failure = CAN_OK;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (!drives->state.latches.board[leg].present) {
            continue;
        }
        const bool armed = command[leg].latch_armed && is_enabled(drives, (enum side)leg);
        const enum can_result result =
            latch_boards_arm(&drives->state.latches, (enum side)leg, armed, bus);
        first_failure = first_failure == CAN_OK ? result : first_failure;
    }
    return first_failure;
}

static enum can_result send_commands(void *context, const struct sea_drive_command *command,
                                     const struct can_bus *bus)
{
    struct device_drives *drives = (struct device_drives *)context;
    enum can_result first_failure = CAN_OK;
    for (unsigned protocol = DEVICE_CIA402; protocol <= DEVICE_MIT; protocol++) {
        if (has_protocol(drives, protocol)) {
            const struct sea_drives own = drives->own[protocol];
            const enum can_result result = own.ops->command(own.context, command, bus);
            first_failure = first_failure == CAN_OK ? result : first_failure;
        }
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        drives->state.enabled[leg] = command[leg].enable;
    }
    const enum can_result result = arm_latches(drives, command, bus);
    return first_failure == CAN_OK ? result : first_failure;
}

static const struct sea_drives_ops device_ops = {receive, read_axis, age, send_commands};

struct sea_drives device_drives_interface(struct device_drives *drives)
{
    return (struct sea_drives){&device_ops, drives, &drives->rx_malformed};
}
