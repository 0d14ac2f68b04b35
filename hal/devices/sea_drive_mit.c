#include "hal/devices/sea_drive_mit.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"

enum {
    ENTER_REPEAT_TICKS = TICKS_OF_MS(100),
    POSITION_BITS = 16,
    FIELD_BITS = 12,
    ANSWER_BYTES_MIN = 6
};

uint32_t mit_encode(float value, float range, bool from_zero, unsigned bits)
{
    const float low = from_zero ? 0.0f : -range;
    const float steps = (float)((1u << bits) - 1u);
    return (uint32_t)bytes_saturate_i32((value - low) / (range - low) * steps, 0,
                                        (int32_t)((1u << bits) - 1u));
}

float mit_decode(uint32_t field, float range, bool from_zero, unsigned bits)
{
    const float low = from_zero ? 0.0f : -range;
    return low + (float)field * (range - low) / (float)((1u << bits) - 1u);
}

void mit_drives_init(struct mit_drives *drives, const struct mit_axis_config *config)
{
    *drives = (struct mit_drives){0};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        drives->axis[leg].config = config[leg];
        drives->axis[leg].age_ticks = UINT16_MAX;
    }
}

static float metres_of(const struct mit_axis *axis)
{
    return (axis->position_rad - axis->config.zero_rad) * (float)axis->config.direction /
           axis->config.rad_per_m;
}

static bool is_plausible(const struct mit_axis *axis)
{
    const float metres = metres_of(axis);
    const float margin = 0.1f * axis->config.stroke_max_m;
    return metres >= -margin && metres <= axis->config.stroke_max_m + margin;
}

static void read_answer(struct mit_drives *drives, struct mit_axis *axis,
                        const struct can_msg *message)
{
    if (message->length < ANSWER_BYTES_MIN || message->data[0] != axis->config.motor_id) {
        if (drives->rx_malformed < UINT32_MAX) {
            drives->rx_malformed++;
        }
        return;
    }
    const uint32_t field = (uint32_t)message->data[1] << 8 | message->data[2];
    const bool first = axis->age_ticks == UINT16_MAX || axis->judge_again;
    axis->position_rad = mit_decode(field, axis->config.ranges.position_rad, false, POSITION_BITS);
    axis->error = message->length >= 8 ? message->data[7] : 0;
    axis->has_temperature = message->length >= 8;
    axis->temperature_degC = axis->has_temperature ? message->data[6] : 0;
    axis->age_ticks = 0;
    if (first) {
        axis->judge_again = false;
        axis->refused = !is_plausible(axis);
    }
}

static bool receive(void *context, const struct can_msg *message)
{
    struct mit_drives *drives = (struct mit_drives *)context;
    if (message->flags != 0) {
        return false;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (drives->axis[leg].config.motor_id != 0 &&
            message->id == drives->axis[leg].config.answer_id) {
            read_answer(drives, &drives->axis[leg], message);
            return true;
        }
    }
    return false;
}

static enum drive_state state_of(const struct mit_axis *axis)
{
    if (axis->age_ticks > HEARTBEAT_TIMEOUT_TICKS) {
        return DRIVE_UNKNOWN;
    }
    if (axis->error != 0 || axis->refused) {
        return DRIVE_FAULT;
    }
    return axis->entered ? DRIVE_ENABLED : DRIVE_DISABLED;
}

static void read_axis(const void *context, enum side leg, struct sea_drive_reading *reading)
{
    const struct mit_axis *axis = &((const struct mit_drives *)context)->axis[leg];
    reading->age_ticks = axis->age_ticks;
    reading->state = state_of(axis);
    reading->precompression_m = metres_of(axis);
    reading->has_temperature = axis->has_temperature && axis->age_ticks <= SEA_DRIVE_SLOW_TICKS;
    reading->temperature_degC = (float)axis->temperature_degC;
}

static void age(void *context)
{
    struct mit_drives *drives = (struct mit_drives *)context;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (drives->axis[leg].age_ticks < UINT16_MAX) {
            drives->axis[leg].age_ticks++;
        }
    }
}

static enum can_result send_special(const struct mit_axis *axis, enum mit_special what,
                                    const struct can_bus *bus)
{
    const struct can_msg message = {
        .id = axis->config.motor_id,
        .length = 8,
        .data = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, (uint8_t)what}};
    return can_bus_send(bus, &message);
}

static enum can_result send_motion(const struct mit_axis *axis, float position_rad, float kp,
                                   float kd, float torque_Nm, const struct can_bus *bus)
{
    const struct mit_ranges *ranges = &axis->config.ranges;
    uint32_t position = mit_encode(position_rad, ranges->position_rad, false, POSITION_BITS);
    const uint32_t velocity = mit_encode(0.0f, ranges->velocity_rad_s, false, FIELD_BITS);
    const uint32_t kp_field = mit_encode(kp, ranges->kp_Nm_rad, true, FIELD_BITS);
    const uint32_t kd_field = mit_encode(kd, ranges->kd_Nms_rad, true, FIELD_BITS);
    const uint32_t torque = mit_encode(torque_Nm, ranges->torque_Nm, false, FIELD_BITS);
    if (position == 0xFFFFu) {
        position--; /* all ones would begin a special frame */
    }
    const struct can_msg message = {
        .id = axis->config.motor_id,
        .length = 8,
        .data = {(uint8_t)(position >> 8), (uint8_t)(position & 0xFFu), (uint8_t)(velocity >> 4),
                 (uint8_t)((velocity & 0xFu) << 4 | kp_field >> 8), (uint8_t)(kp_field & 0xFFu),
                 (uint8_t)(kd_field >> 4), (uint8_t)((kd_field & 0xFu) << 4 | torque >> 8),
                 (uint8_t)(torque & 0xFFu)}};
    return can_bus_send(bus, &message);
}

/* One frame a motor and tick: it answers each, so two would only crowd the bus. */
static enum can_result send_axis_command(struct mit_axis *axis,
                                         const struct sea_drive_command *command,
                                         const struct can_bus *bus)
{
    const struct mit_axis_config *config = &axis->config;
    const bool may_enter =
        command->enable && axis->age_ticks == 0 && axis->error == 0 && !axis->refused;
    if (axis->enter_wait > 0) {
        axis->enter_wait--;
    }
    if (command->clear_fault && state_of(axis) == DRIVE_FAULT) {
        axis->clearing = true;
    }
    if (axis->clearing) { /* leaving motor mode clears its error; what it then answers is judged anew */
        const enum can_result result = send_special(axis, MIT_EXIT, bus);
        axis->clearing = result != CAN_OK;
        axis->entered = axis->entered && result != CAN_OK;
        axis->judge_again = true;
        return result;
    }
    if (may_enter && !axis->entered && axis->enter_wait == 0) {
        const enum can_result result = send_special(axis, MIT_ENTER, bus);
        axis->entered = result == CAN_OK;
        axis->enter_wait = axis->entered ? ENTER_REPEAT_TICKS : 0; /* refused: in the next tick */
        return result;
    }
    if (axis->entered && (!command->enable || axis->error != 0)) {
        const enum can_result result = send_special(axis, MIT_EXIT, bus);
        axis->entered = result != CAN_OK;
        return result;
    }
    if (!axis->entered || axis->age_ticks == UINT16_MAX) {
        return send_motion(axis, axis->position_rad, 0.0f, 0.0f, 0.0f,
                           bus); /* asks for an answer */
    }
    const float target_rad =
        config->zero_rad + command->precompression_m * (float)config->direction * config->rad_per_m;
    const float spring_Nm = config->spring_N_per_m * command->precompression_m *
                            (float)config->direction / config->rad_per_m;
    return send_motion(axis, target_rad, config->kp_Nm_rad, config->kd_Nms_rad, spring_Nm, bus);
}

static enum can_result send_commands(void *context, const struct sea_drive_command *command,
                                     const struct can_bus *bus)
{
    struct mit_drives *drives = (struct mit_drives *)context;
    enum can_result first_failure = CAN_OK;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (drives->axis[leg].config.motor_id == 0) {
            continue;
        }
        const enum can_result result = send_axis_command(&drives->axis[leg], &command[leg], bus);
        first_failure = first_failure == CAN_OK ? result : first_failure;
    }
    return first_failure;
}

static const struct sea_drives_ops mit_ops = {receive, read_axis, age, send_commands};

struct sea_drives mit_drives_interface(struct mit_drives *drives)
{
    return (struct sea_drives){&mit_ops, drives, &drives->rx_malformed};
}
