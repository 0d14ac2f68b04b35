#include "hal/devices/sea_drive_cia402.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/devices/duplicate_id.h"

/* Controlwords, object 0x6040 (CiA 402-2, table of device control commands). */
enum {
    CONTROLWORD_DISABLE_VOLTAGE = 0x00,
    CONTROLWORD_QUICK_STOP = 0x02,
    CONTROLWORD_SHUTDOWN = 0x06,
    CONTROLWORD_SWITCH_ON = 0x07,
    CONTROLWORD_ENABLE_OPERATION = 0x0F,
    CONTROLWORD_FAULT_RESET = 0x80
};

enum { FAULT_RESET_TICKS = TICKS_OF_MS(50), FAULT_RESET_LOW_TICKS = TICKS_OF_MS(50) };

/* Bit 12 in cyclic synchronous position: the drive follows its target (CiA 402-2); bit 14
 * is the manufacturer's; bit 7 is a warning in every mode. */
enum { STATUSWORD_WARNING = 1 << 7, STATUSWORD_FOLLOWS = 1 << 12 };
enum { LATCH_CLOSED_BIT = 14, CONTROLWORD_RUN_INTERPOLATION = 1 << 4 };

/* States as the statusword 0x6041 spells them under its masks. */
enum cia402_state {
    CIA402_NOT_READY,
    CIA402_SWITCH_ON_DISABLED,
    CIA402_READY,
    CIA402_SWITCHED_ON,
    CIA402_ENABLED,
    CIA402_QUICK_STOP,
    CIA402_FAULT_REACTION,
    CIA402_FAULT
};

/* By bits 0-3, 5 and 6, as CiA 402 masks them: bit 5 (quick stop) counts in some states
 * only. What is not listed is not ready. */
static const uint8_t state_by_bits[0x70] = {
    [0x40] = CIA402_SWITCH_ON_DISABLED,
    [0x60] = CIA402_SWITCH_ON_DISABLED,
    [0x0F] = CIA402_FAULT_REACTION,
    [0x2F] = CIA402_FAULT_REACTION,
    [0x08] = CIA402_FAULT,
    [0x28] = CIA402_FAULT,
    [0x21] = CIA402_READY,
    [0x23] = CIA402_SWITCHED_ON,
    [0x27] = CIA402_ENABLED,
    [0x07] = CIA402_QUICK_STOP,
};

static enum cia402_state state_of(uint16_t statusword)
{
    return (enum cia402_state)state_by_bits[statusword & 0x6Fu];
}

void cia402_drives_init(struct cia402_drives *drives, const struct cia402_axis_config *config)
{
    *drives = (struct cia402_drives){0};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        drives->axis[leg].config = config[leg];
        drives->axis[leg].age_ticks = UINT16_MAX;
        sea_latch_sender_init(&drives->axis[leg].sender);
        drives->axis[leg].slow_age_ticks = UINT16_MAX - 1; /* missing, not without any */
    }
}

static void count_malformed(struct cia402_drives *drives)
{
    if (drives->rx_malformed < UINT32_MAX) {
        drives->rx_malformed++;
    }
}

static uint8_t slow_bytes(const struct cia402_axis_config *config)
{
    return (uint8_t)((config->no_torque ? 0 : 2) + (config->no_temperature ? 0 : 2) +
                     (config->no_voltage ? 0 : 4));
}

/* The slow PDO: torque, temperature, voltage, as far as the drive has them. */
static bool receive_slow(struct cia402_drives *drives, const struct can_msg *message)
{
    if (message->id != FRAME_DRIVE_SLOW_LEFT && message->id != FRAME_DRIVE_SLOW_RIGHT) {
        return false;
    }
    struct cia402_axis *axis =
        &drives->axis[message->id == FRAME_DRIVE_SLOW_RIGHT ? SIDE_RIGHT : SIDE_LEFT];
    const struct cia402_axis_config *config = &axis->config;
    if (config->absent) {
        return false;
    }
    if (message->length != slow_bytes(config) || message->flags != 0) {
        count_malformed(drives);
        return true;
    }
    const uint8_t *next = message->data;
    axis->slow_age_ticks = 0;
    if (!config->no_torque) {
        axis->torque_per_mille = bytes_get_i16(next);
        next += sizeof(int16_t);
    }
    if (!config->no_temperature) {
        axis->temperature_0_1_degC = bytes_get_i16(next);
        next += sizeof(int16_t);
    }
    if (!config->no_voltage) {
        axis->supply_mV = bytes_get_u32(next);
    }
    return true;
}

static bool receive(void *context, const struct can_msg *message)
{
    struct cia402_drives *drives = (struct cia402_drives *)context;
    if (message->id != FRAME_DRIVE_STATE_LEFT && message->id != FRAME_DRIVE_STATE_RIGHT) {
        return receive_slow(drives, message);
    }
    struct cia402_axis *axis =
        &drives->axis[message->id == FRAME_DRIVE_STATE_RIGHT ? SIDE_RIGHT : SIDE_LEFT];
    if (axis->config.absent) {
        return false;
    }
    if (message->length != FRAME_BYTES_DRIVE_STATE_LEFT || message->flags != 0) {
        count_malformed(drives);
        return true;
    }
    const uint16_t statusword = bytes_get_u16(message->data);
    const int32_t counts = bytes_get_i32(message->data + 2);
    if (axis->age_ticks == 0 &&
        (axis->statusword != statusword || axis->position_counts != counts)) {
        duplicate_id_seen(&axis->duplicate_id_count);
    }
    axis->statusword = statusword;
    axis->position_counts = counts;
    axis->age_ticks = 0;
    return true;
}

static float metres_from_counts(const struct cia402_axis_config *config, int32_t counts)
{
    int64_t travel = ((int64_t)counts - config->zero_counts) * config->direction;
    /* Beyond 32 bits it is far out of any stroke either way, and there is no conversion of 64. */
    travel = travel > INT32_MAX ? INT32_MAX : travel;
    travel = travel < INT32_MIN ? INT32_MIN : travel;
    return (float)(int32_t)travel / config->counts_per_m;
}

static int32_t counts_from_metres(const struct cia402_axis_config *config, float metres)
{
    const int32_t travel =
        bytes_saturate_i32(metres * config->counts_per_m, -(INT32_MAX / 2), INT32_MAX / 2);
    return config->zero_counts + travel * config->direction;
}

static void read_axis(const void *context, enum side leg, struct sea_drive_reading *reading)
{
    const struct cia402_axis *axis = &((const struct cia402_drives *)context)->axis[leg];
    static const enum drive_state meaning[] = {
        [CIA402_NOT_READY] = DRIVE_DISABLED,      [CIA402_SWITCH_ON_DISABLED] = DRIVE_DISABLED,
        [CIA402_READY] = DRIVE_DISABLED,          [CIA402_SWITCHED_ON] = DRIVE_STARTING,
        [CIA402_ENABLED] = DRIVE_ENABLED,         [CIA402_QUICK_STOP] = DRIVE_STOPPING,
        [CIA402_FAULT_REACTION] = DRIVE_STOPPING, [CIA402_FAULT] = DRIVE_FAULT,
    };
    const struct cia402_axis_config *config = &axis->config;
    const unsigned latch_bit = config->latch_bit != 0 ? config->latch_bit : LATCH_CLOSED_BIT;
    const bool has_force = config->rated_force_N > 0.0f && !config->no_torque;
    reading->age_ticks = axis->age_ticks;
    reading->foreign = axis->duplicate_id_count >= DUPLICATE_ID_LIMIT;
    reading->force_age_ticks = has_force ? axis->slow_age_ticks : UINT16_MAX;
    reading->force_N = (float)axis->torque_per_mille * (float)axis->config.direction *
                       axis->config.rated_force_N / 1000.0f;
    reading->latch = axis->age_ticks == UINT16_MAX || config->no_latch_bit ? LATCH_UNKNOWN
                     : (axis->statusword >> latch_bit & 1u) != 0           ? LATCH_CLOSED
                                                                           : LATCH_OPEN;
    if (config->contact_bit != 0 && axis->age_ticks != UINT16_MAX) {
        reading->contact =
            (axis->statusword >> config->contact_bit & 1u) != 0 ? FOOT_DOWN : FOOT_UP;
    }
    reading->warning =
        axis->age_ticks != UINT16_MAX && (axis->statusword & STATUSWORD_WARNING) != 0;
    const bool told = axis->slow_age_ticks <= SEA_DRIVE_SLOW_TICKS;
    reading->has_temperature = told && !config->no_temperature;
    reading->has_supply = told && !config->no_voltage;
    reading->temperature_degC = (float)axis->temperature_0_1_degC * 0.1f;
    reading->supply_V = (float)axis->supply_mV * 0.001f;
    reading->precompression_m = metres_from_counts(&axis->config, axis->position_counts);
    const bool ignores = state_of(axis->statusword) == CIA402_ENABLED && !config->no_follows_bit &&
                         (axis->statusword & STATUSWORD_FOLLOWS) == 0;
    reading->state = axis->age_ticks == UINT16_MAX ? DRIVE_UNKNOWN
                     : ignores                     ? DRIVE_STOPPING
                                                   : meaning[state_of(axis->statusword)];
}

static void age(void *context)
{
    struct cia402_drives *drives = (struct cia402_drives *)context;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct cia402_axis *axis = &drives->axis[leg];
        if (axis->age_ticks > 0) {
            duplicate_id_missed(&axis->duplicate_id_count, axis->age_ticks);
        }
        if (axis->age_ticks < UINT16_MAX) {
            axis->age_ticks++;
        }
        if (axis->slow_age_ticks < UINT16_MAX - 1) { /* once received it is never "never" */
            axis->slow_age_ticks++;
        }
    }
}

/* A reset is asked for in one tick. The bit stays long enough for a drive that looks at its
 * controlword every ten milliseconds, and is low as long before it may rise again. */
static uint16_t controlword_in_fault(struct cia402_axis *axis, bool clear_fault)
{
    if (axis->reset_ticks == 0 && clear_fault) {
        axis->reset_ticks = FAULT_RESET_TICKS + FAULT_RESET_LOW_TICKS;
    }
    if (axis->reset_ticks == 0) {
        return CONTROLWORD_DISABLE_VOLTAGE;
    }
    axis->reset_ticks--;
    return axis->reset_ticks >= FAULT_RESET_LOW_TICKS ? CONTROLWORD_FAULT_RESET
                                                      : CONTROLWORD_DISABLE_VOLTAGE;
}

/* A drive that is off stays where it is. Its answers are of some ticks before: a word chosen by
 * each of them anew would undo the last one for ever, so the one that was sent stands. */
static uint16_t controlword_while_off(const struct cia402_axis *axis, enum cia402_state state)
{
    const uint16_t sent = axis->sender.sent_controlword;
    if (sent == CONTROLWORD_SHUTDOWN || sent == CONTROLWORD_DISABLE_VOLTAGE) {
        return sent;
    }
    return state == CIA402_READY ? CONTROLWORD_SHUTDOWN : CONTROLWORD_DISABLE_VOLTAGE;
}

/* The next controlword on the way from the reported state to the command. */
static uint16_t next_controlword(struct cia402_axis *axis, const struct sea_drive_command *command)
{
    const enum cia402_state state = state_of(axis->statusword);
    if (state == CIA402_FAULT) {
        return controlword_in_fault(axis, command->clear_fault);
    }
    axis->reset_ticks = 0;
    if (state == CIA402_QUICK_STOP) {
        /* It unloads and then leaves this state by itself; to disable the voltage
         * before would let a loaded spring drive the motor. */
        return CONTROLWORD_QUICK_STOP;
    }
    const bool is_off =
        state == CIA402_NOT_READY || state == CIA402_SWITCH_ON_DISABLED || state == CIA402_READY;
    if (!command->enable) {
        return is_off ? controlword_while_off(axis, state) : CONTROLWORD_SHUTDOWN;
    }
    switch (state) {
    case CIA402_READY:
        return CONTROLWORD_SWITCH_ON;
    case CIA402_SWITCHED_ON:
        return CONTROLWORD_ENABLE_OPERATION;
    case CIA402_ENABLED:
        return axis->config.interpolated
                   ? CONTROLWORD_ENABLE_OPERATION | CONTROLWORD_RUN_INTERPOLATION
                   : CONTROLWORD_ENABLE_OPERATION;
    default:
        return CONTROLWORD_SHUTDOWN;
    }
}

static enum can_result send_axis_command(struct cia402_axis *axis, enum side leg,
                                         const struct sea_drive_command *command,
                                         const struct can_bus *bus)
{
    if (axis->age_ticks == UINT16_MAX || command->unconfigured) {
        return CAN_OK; /* whatever it is doing, it knows better than we */
    }
    const uint16_t controlword = next_controlword(axis, command);
    const bool armed = command->latch_armed && state_of(axis->statusword) == CIA402_ENABLED;
    if (command->repeat) {
        axis->sender.ticks_since_sent = SLOW_PDO_TICKS;
    }
    return axis->config.no_outputs
               ? sea_latch_send_controlword(&axis->sender, leg, controlword, bus)
               : sea_latch_send(&axis->sender, leg, controlword, armed, bus);
}

/* What the drive is told of its target; false while that would be a guess: it was never heard, or
 * is not set up. */
static bool find_target(const struct cia402_axis *axis, const struct sea_drive_command *command,
                        int32_t *target)
{
    const bool follows = command->enable && state_of(axis->statusword) == CIA402_ENABLED;
    *target = follows ? counts_from_metres(&axis->config, command->precompression_m)
                      : axis->position_counts;
    return axis->age_ticks != UINT16_MAX && !(command->unconfigured && command->operational);
}

static enum can_result send_shared_targets(const struct cia402_drives *drives,
                                           const struct sea_drive_command *command,
                                           const struct can_bus *bus)
{
    struct can_msg targets = {.id = FRAME_DRIVE_TARGETS, .length = FRAME_BYTES_DRIVE_TARGETS};
    bool known = true;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        int32_t target;
        known = find_target(&drives->axis[leg], &command[leg], &target) && known;
        bytes_put_u32(targets.data + 4 * leg, (uint32_t)target);
    }
    return known ? can_bus_send(bus, &targets) : CAN_OK;
}

static enum can_result send_own_target(const struct cia402_axis *axis, enum side leg,
                                       const struct sea_drive_command *command,
                                       const struct can_bus *bus)
{
    struct can_msg message = {.id =
                                  leg == SIDE_LEFT ? FRAME_DRIVE_TARGETS : FRAME_DRIVE_TARGET_RIGHT,
                              .length = FRAME_BYTES_DRIVE_TARGET_RIGHT};
    int32_t target;
    if (!find_target(axis, command, &target)) {
        return CAN_OK;
    }
    bytes_put_u32(message.data, (uint32_t)target);
    return can_bus_send(bus, &message);
}

static enum can_result send_targets(const struct cia402_drives *drives,
                                    const struct sea_drive_command *command,
                                    const struct can_bus *bus)
{
    const struct cia402_axis *axis = drives->axis;
    enum can_result first_failure = CAN_OK;
    if (!axis[SIDE_LEFT].config.own_target && !axis[SIDE_RIGHT].config.own_target) {
        return send_shared_targets(drives, command, bus);
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (!axis[leg].config.absent) {
            const enum can_result result =
                send_own_target(&axis[leg], (enum side)leg, &command[leg], bus);
            first_failure = first_failure == CAN_OK ? result : first_failure;
        }
    }
    return first_failure;
}

static enum can_result send_commands(void *context, const struct sea_drive_command *command,
                                     const struct can_bus *bus)
{
    struct cia402_drives *drives = (struct cia402_drives *)context;
    enum can_result first_failure = send_targets(drives, command, bus);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (drives->axis[leg].config.absent) {
            continue;
        }
        const enum can_result result =
            send_axis_command(&drives->axis[leg], (enum side)leg, &command[leg], bus);
        if (first_failure == CAN_OK) {
            first_failure = result;
        }
    }
    return first_failure;
}

static const struct sea_drives_ops cia402_ops = {receive, read_axis, age, send_commands};

struct sea_drives cia402_drives_interface(struct cia402_drives *drives)
{
    return (struct sea_drives){&cia402_ops, drives, &drives->rx_malformed};
}
