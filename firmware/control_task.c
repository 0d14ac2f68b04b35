#include "firmware/control_task.h"

#include <assert.h>

#include "firmware/telemetry.h"
#include "hal/frame_table.h"

static_assert((int)SIDE_LEFT == (int)LEG_LEFT && (int)SIDE_RIGHT == (int)LEG_RIGHT,
              "controller and HAL index legs alike");
static_assert((int)DRIVE_ENABLED == (int)SEA_DRIVE_ENABLED &&
                  (int)DRIVE_FAULT == (int)SEA_DRIVE_FAULT &&
                  (int)DRIVE_STOPPING == (int)SEA_DRIVE_STOPPING &&
                  (int)DRIVE_STARTING == (int)SEA_DRIVE_STARTING &&
                  (int)DRIVE_DISABLED == (int)SEA_DRIVE_DISABLED,
              "drive states mean the same in controller and HAL");
static_assert(sizeof(real) == sizeof(float), "the flown controller is float32");

static void count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

int control_task_init(struct control_task *task, const struct control_task_config *config)
{
    *task = (struct control_task){0};
    task->config = *config;
    task->walk_requested = config->walk_requested;
    task->desired_speed_rad_s = config->desired_speed_rad_s;
    task->emergency_stop = true; /* unknown until read */
    network_init(&task->network);
    leg_sensors_init(&task->sensors, config->leg_sensor);
    return controller_init(&task->controller, config->params);
}

enum can_result control_task_start_cycle(struct control_task *task)
{
    const struct can_msg sync = {.id = FRAME_SYNC, .length = FRAME_BYTES_SYNC};
    const enum can_result result = can_bus_send(&task->config.bus, &sync);
    count(result == CAN_OK ? &task->counters.syncs_sent : &task->counters.syncs_refused);
    return result;
}

static void collect_input(struct control_task *task, struct controller_input *input)
{
    *input = (struct controller_input){.tick = task->tick,
                                       .desired_speed_rad_s = task->desired_speed_rad_s,
                                       .nodes_operational =
                                           network_all_operational(&task->network),
                                       .emergency_stop = task->emergency_stop,
                                       .walk_requested = task->walk_requested,
                                       .reset_requested = task->reset_requested};
    for (int leg = 0; leg < LEG_COUNT; leg++) {
        const struct leg_sensor_reading *reading = &task->sensors.reading[leg];
        struct sea_drive_reading drive;
        sea_drives_read(&task->config.drives, (enum leg)leg, &drive);
        input->leg[leg] = (struct leg_measurement){reading->leg_angle_rad,
                                                   reading->ankle_extension_m, reading->age_ticks};
        input->sea[leg] = (struct sea_measurement){
            drive.precompression_m, (enum drive_state)drive.state, drive.age_ticks};
        if (reading->age_ticks != 0 || drive.age_ticks != 0) {
            count(&task->counters.late_answers);
        }
    }
}

static void send(struct control_task *task, const struct can_msg *message)
{
    if (can_bus_send(&task->config.bus, message) != CAN_OK) {
        count(&task->counters.send_failures);
    }
}

/* What moves the controller besides the bus, the emergency stop, goes onto the
 * bus when it changes, so that a log holds it. */
static void send_state(struct control_task *task)
{
    uint8_t now[2];
    telemetry_pack_state(now, &task->output, task->emergency_stop);
    const bool changed = now[0] != task->sent_state[0] || now[1] != task->sent_state[1];
    if (!changed && task->state_wait > 0) {
        task->state_wait--;
        return;
    }
    const struct can_msg message = {.id = FRAME_CONTROLLER_STATE,
                                    .length = FRAME_BYTES_CONTROLLER_STATE,
                                    .data = {now[0], now[1]}};
    if (can_bus_send(&task->config.bus, &message) != CAN_OK) {
        count(&task->counters.send_failures);
        return; /* tried again at the next tick */
    }
    task->sent_state[0] = now[0];
    task->sent_state[1] = now[1];
    task->state_wait = SLOW_PDO_TICKS - 1;
}

static void send_commands(struct control_task *task)
{
    struct sea_drive_wish wish[LEG_COUNT];
    for (int leg = 0; leg < LEG_COUNT; leg++) {
        const struct sea_request *command = &task->output.sea[leg];
        wish[leg] = (struct sea_drive_wish){command->precompression_m, command->enable,
                                            command->latch_armed, task->reset_requested};
    }
    if (sea_drives_command(&task->config.drives, wish, &task->config.bus) != CAN_OK) {
        count(&task->counters.send_failures);
    }
}

static unsigned run_tick(struct control_task *task)
{
    struct controller_input input;
    task->tick++;
    task->emergency_stop = emergency_stop_is_pressed(&task->config.stop);
    collect_input(task, &input);
    controller_update(&task->controller, &input, &task->output);
    send_commands(task);
    task->reset_requested = false;
    network_update(&task->network, &task->config.bus, (1u << NETWORK_NODES) - 1u);
    send_state(task);
    if (task->output.new_step) {
        struct can_msg message = {.id = FRAME_TELEMETRY, .length = FRAME_BYTES_TELEMETRY};
        telemetry_pack_step(message.data, &task->controller.last_step, task->output.fault);
        send(task, &message);
    }
    sea_drives_age(&task->config.drives);
    leg_sensors_age(&task->sensors);
    return CONTROL_TASK_TICKED | CONTROL_TASK_BUS_ALIVE | CONTROL_TASK_SUPERVISED |
           (task->output.new_step ? (unsigned)CONTROL_TASK_NEW_STEP : 0u);
}

unsigned control_task_poll(struct control_task *task)
{
    unsigned progress = 0;
    struct can_msg message;

    for (int i = 0; i < CONTROL_TASK_POLL_FRAMES; i++) {
        if (can_bus_receive(&task->config.bus, &message, NULL) != CAN_OK) {
            break;
        }
        if (message.flags & CAN_FRAME_ERROR) {
            count(&task->counters.error_frames);
        } else if ((message.flags & CAN_FRAME_OWN) != 0) {
            if (message.id == FRAME_SYNC) {
                progress |= run_tick(task);
            }
        } else if (!leg_sensors_receive(&task->sensors, &message) &&
                   !sea_drives_receive(&task->config.drives, &message) &&
                   !network_receive(&task->network, &message)) {
            count(&task->counters.foreign_frames);
        }
    }
    return progress;
}

bool control_task_cycle_complete(const struct control_task *task)
{
    for (int leg = 0; leg < LEG_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(&task->config.drives, (enum leg)leg, &drive);
        if (task->sensors.reading[leg].age_ticks != 0 || drive.age_ticks != 0) {
            return false;
        }
    }
    return true;
}
