#include "hal/devices/sea_drive_cansimple.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"

enum { REPEAT_TICKS = TICKS_OF_MS(100), HEARTBEAT_BYTES_MIN = 5, PART_ERROR = 1 };

void cansimple_drives_init(struct cansimple_drives *drives,
                           const struct cansimple_axis_config *config)
{
    *drives = (struct cansimple_drives){0};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct cansimple_axis *axis = &drives->axis[leg];
        axis->config = config[leg];
        axis->age_ticks = UINT16_MAX;
        axis->heartbeat_age_ticks = UINT16_MAX;
    }
}

static void count_malformed(struct cansimple_drives *drives)
{
    if (drives->rx_malformed < UINT32_MAX) {
        drives->rx_malformed++;
    }
}

static void read_answer(struct cansimple_drives *drives, struct cansimple_axis *axis,
                        const struct can_msg *message)
{
    const uint32_t kind = message->id & 0x1Fu;
    if (message->flags != 0) {
        return; /* a remote request, not an answer */
    }
    if (kind == CANSIMPLE_HEARTBEAT) {
        if (message->length < HEARTBEAT_BYTES_MIN) {
            count_malformed(drives);
            return;
        }
        axis->axis_error = bytes_get_u32(message->data);
        axis->axis_state = message->data[4];
        axis->part_error =
            message->length == 8 &&
            ((message->data[5] | message->data[6] | message->data[7]) & PART_ERROR) != 0;
        axis->heartbeat_age_ticks = 0;
    } else if (kind == CANSIMPLE_ENCODER_ESTIMATES) {
        const float turns = bytes_get_f32(message->data);
        if (message->length != 8 || !(turns - turns == 0.0f)) {
            count_malformed(drives);
            return;
        }
        axis->position_turns = turns;
        axis->age_ticks = 0;
    }
}

static bool receive(void *context, const struct can_msg *message)
{
    struct cansimple_drives *drives = (struct cansimple_drives *)context;
    if ((message->flags & CAN_FRAME_EXTENDED) != 0) {
        return false;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (drives->axis[leg].config.node != 0 &&
            message->id >> 5 == drives->axis[leg].config.node) {
            read_answer(drives, &drives->axis[leg], message);
            return true;
        }
    }
    return false;
}

static enum drive_state state_of(const struct cansimple_axis *axis)
{
    if (axis->heartbeat_age_ticks > HEARTBEAT_TIMEOUT_TICKS) {
        return DRIVE_UNKNOWN;
    }
    if (axis->axis_error != 0 || axis->part_error || axis->disarmed) {
        return DRIVE_FAULT;
    }
    if (axis->axis_state == CANSIMPLE_STATE_CLOSED_LOOP) {
        return axis->leaving ? DRIVE_STARTING : DRIVE_ENABLED;
    }
    return axis->axis_state == CANSIMPLE_STATE_IDLE ? DRIVE_DISABLED : DRIVE_STARTING;
}

static void read_axis(const void *context, enum side leg, struct sea_drive_reading *reading)
{
    const struct cansimple_axis *axis = &((const struct cansimple_drives *)context)->axis[leg];
    reading->age_ticks = axis->age_ticks;
    reading->state = state_of(axis);
    reading->precompression_m = (axis->position_turns - axis->config.zero_turns) *
                                (float)axis->config.direction / axis->config.turns_per_m;
}

static void grow_older(uint16_t *age)
{
    if (*age < UINT16_MAX) {
        (*age)++;
    }
}

static void age(void *context)
{
    struct cansimple_drives *drives = (struct cansimple_drives *)context;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        grow_older(&drives->axis[leg].age_ticks);
        grow_older(&drives->axis[leg].heartbeat_age_ticks);
    }
}

static enum can_result send(const struct cansimple_axis *axis, enum cansimple_command command,
                            uint8_t length, uint32_t low, uint32_t high, const struct can_bus *bus)
{
    struct can_msg message = {.id = (uint32_t)axis->config.node << 5 | (uint32_t)command,
                              .length = length};
    bytes_put_u32(message.data, low);
    bytes_put_u32(message.data + 4, high);
    return can_bus_send(bus, &message);
}

/* A drive that leaves closed loop while it is to stay there has disarmed itself, whatever the
 * reason: it must not be enabled again before the command was withdrawn. */
static void watch_arming(struct cansimple_axis *axis, const struct sea_drive_command *command)
{
    const bool closed_loop = axis->axis_state == CANSIMPLE_STATE_CLOSED_LOOP;
    axis->leaving = closed_loop && (axis->leaving || !command->enable);
    if (!command->enable) {
        axis->was_enabled = false;
        axis->disarmed = false;
    } else if (axis->leaving) {
        axis->was_enabled = false; /* what its last heartbeat says is of before */
    } else if (closed_loop) {
        axis->was_enabled = true;
    } else if (axis->was_enabled) {
        axis->disarmed = true;
    }
    if (axis->clear_wait > 0) {
        axis->clear_wait--;
    } else if (command->clear_fault && state_of(axis) == DRIVE_FAULT) {
        axis->clearing = true;
    }
}

/* Repeated after REPEAT_TICKS, and in the next tick where the bus did not take it. */
static enum can_result send_state(struct cansimple_axis *axis, enum cansimple_axis_state state,
                                  const struct can_bus *bus)
{
    const enum can_result result = send(axis, CANSIMPLE_SET_AXIS_STATE, 4, (uint32_t)state, 0, bus);
    axis->repeat_wait = result == CAN_OK ? REPEAT_TICKS : 0;
    return result;
}

/* The way to closed loop: the mode, then the state, a request a tick. */
static enum can_result send_start(struct cansimple_axis *axis, const struct can_bus *bus)
{
    if (!axis->mode_is_told) {
        const enum can_result result =
            send(axis, CANSIMPLE_SET_CONTROLLER_MODE, 8, CANSIMPLE_MODE_POSITION,
                 CANSIMPLE_INPUT_PASSTHROUGH, bus);
        axis->mode_is_told = result == CAN_OK;
        return result;
    }
    const enum can_result result = send_state(axis, CANSIMPLE_STATE_CLOSED_LOOP, bus);
    axis->mode_is_told = result != CAN_OK;
    return result;
}

/* Requests that change the drive's state: sent, then given time, then repeated. Those to start are
 * sent only while may_start, and end it for this tick: an estimate and a target a tick of either
 * drive leave a bus of 1 Mbit/s no room for more than one. */
static enum can_result send_requests(struct cansimple_axis *axis,
                                     const struct sea_drive_command *command, bool *may_start,
                                     const struct can_bus *bus)
{
    const enum drive_state state = state_of(axis);
    axis->mode_is_told = axis->mode_is_told && command->enable && state == DRIVE_DISABLED;
    if (axis->clearing) { /* waits for no other request: it was asked for in one tick only */
        const enum can_result result = send(axis, CANSIMPLE_CLEAR_ERRORS, 0, 0, 0, bus);
        axis->clearing = result != CAN_OK;
        axis->clear_wait = REPEAT_TICKS;
        return result;
    }
    if (axis->repeat_wait > 0) {
        axis->repeat_wait--;
        return CAN_OK;
    }
    if (command->enable && state == DRIVE_DISABLED && axis->age_ticks == 0 && *may_start) {
        *may_start = false;
        return send_start(axis, bus);
    }
    if ((!command->enable || axis->leaving) &&
        (state == DRIVE_ENABLED || state == DRIVE_STARTING)) {
        return send_state(axis, CANSIMPLE_STATE_IDLE, bus);
    }
    return CAN_OK;
}

static enum can_result send_axis_command(struct cansimple_axis *axis,
                                         const struct sea_drive_command *command, bool *may_start,
                                         const struct can_bus *bus)
{
    watch_arming(axis, command);
    const bool follows = command->enable && state_of(axis) == DRIVE_ENABLED;
    const float target_turns =
        follows
            ? axis->config.zero_turns + command->precompression_m * (float)axis->config.direction *
                                            axis->config.turns_per_m
            : axis->position_turns; /* no kick: where it is, until it is enabled */
    enum can_result first_failure = CAN_OK;
    if (axis->age_ticks != UINT16_MAX) {
        first_failure = send(axis, CANSIMPLE_SET_INPUT_POS, 8, bytes_of_f32(target_turns), 0, bus);
    }
    const enum can_result result = send_requests(axis, command, may_start, bus);
    return first_failure == CAN_OK ? result : first_failure;
}

static enum can_result send_commands(void *context, const struct sea_drive_command *command,
                                     const struct can_bus *bus)
{
    struct cansimple_drives *drives = (struct cansimple_drives *)context;
    enum can_result first_failure = CAN_OK;
    bool may_start = true;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (drives->axis[leg].config.node == 0) {
            continue;
        }
        const enum can_result result =
            send_axis_command(&drives->axis[leg], &command[leg], &may_start, bus);
        first_failure = first_failure == CAN_OK ? result : first_failure;
    }
    return first_failure;
}

static const struct sea_drives_ops cansimple_ops = {receive, read_axis, age, send_commands};

struct sea_drives cansimple_drives_interface(struct cansimple_drives *drives)
{
    return (struct sea_drives){&cansimple_ops, drives, &drives->rx_malformed};
}
