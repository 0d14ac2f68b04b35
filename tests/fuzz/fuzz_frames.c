/* Fuzzer: every node under any sequence of frames. Records of 12 bytes: identifier (2),
 * length and flags (1), time step (1), data (8). What must hold whatever comes: the drive
 * is armed and powered only where its state allows it, its demand stays in its limits,
 * and the control task's commands are finite numbers within the stroke. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/nodes/drive_node.h"
#include "sim_host/nodes/leg_sensor_node.h"
#include "sim_host/subjects/host_task.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *argc, char ***argv);

enum { RECORD = 12 };

/* A bus with one frame to fetch, that checks what is sent. */
struct inbox {
    bool full;
    struct can_msg message;
};

static struct subject subject;
static struct control_params params;

static enum can_result check_sent(void *context, const struct can_msg *message)
{
    (void)context;
    if (message->length > CAN_FRAME_DATA_MAX || message->id > CAN_ID_STANDARD_MAX ||
        message->flags != 0) {
        abort();
    }
    return CAN_OK;
}

static enum can_result fetch(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct inbox *inbox = context;
    if (!inbox->full) {
        return CAN_EMPTY;
    }
    *message = inbox->message;
    inbox->full = false;
    if (time_ns != NULL) {
        *time_ns = 0;
    }
    return CAN_OK;
}

static void get_status(void *context, struct can_bus_status *status)
{
    (void)context;
    memset(status, 0, sizeof *status);
}

static void recover(void *context)
{
    (void)context;
}

static const struct can_bus_ops ops = {
    .send = check_sent, .receive = fetch, .get_status = get_status, .recover = recover};

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    char message[SUBJECT_MESSAGE_MAX];
    (void)argc;
    (void)argv;
    subject_default(&subject);
    if (subject_control_params(&subject, &params, message) != 0) {
        abort();
    }
    return 0;
}

static void take_record(const uint8_t *record, struct can_msg *message, uint64_t *now_ns)
{
    static const uint16_t known[] = {0x000, 0x080, 0x081, 0x181, 0x182, 0x201, 0x283,
                                     0x284, 0x301, 0x302, 0x581, 0x601, 0x603, 0x610,
                                     0x701, 0x702, 0x703, 0x704, 0x710, 0x381};
    const unsigned raw = (unsigned)record[0] | (unsigned)record[1] << 8;
    *message = (struct can_msg){.length = (uint8_t)((record[2] & 0x0FU) % 9U)};
    message->id = (raw & 0x8000U) != 0 ? raw & CAN_ID_STANDARD_MAX
                                       : known[raw % (sizeof known / sizeof known[0])];
    message->flags = (uint8_t)(record[2] >> 4);
    memcpy(message->data, record + 4, message->length);
    *now_ns += (uint64_t)record[3] * 100000;
}

static void check_drive(struct drive_node *node)
{
    struct drive_axis_command command;
    drive_node_command(node, 1000000, &command);
    const bool may_move = node->state == DRIVE_OPERATION_ENABLED ||
                          node->state == DRIVE_QUICK_STOP_ACTIVE ||
                          node->state == DRIVE_FAULT_REACTION;
    if ((command.powered && !may_move) ||
        (command.latch_armed && (node->state != DRIVE_OPERATION_ENABLED || node->unloading)) ||
        !(command.target_m >= -1e7 && command.target_m <= 1e7)) {
        abort();
    }
}

static void check_task(const struct control_task *task)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_request *request = &task->output.sea[side];
        if (!(request->precompression_m >= 0.0f && request->precompression_m <= 10.0f)) {
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct drive_node_config drive_config = {.side = SIDE_LEFT,
                                                   .node_id = 1,
                                                   .counts_per_m = 1000,
                                                   .stroke_m = 0.3,
                                                   .rated_force_N = 1.0,
                                                   .following_error_m = 0.1,
                                                   .unload_rate_m_per_s = 0.5};
    const struct leg_sensor_node_config sensor_config = {.side = SIDE_LEFT, .node_id = 3};
    static struct drive_node drive;
    static struct leg_sensor_node sensor;
    static struct host_task rig;
    struct inbox inbox = {.full = false};
    const struct can_bus bus = {.ops = &ops, .context = &inbox};
    uint64_t now_ns = 0;
    if (drive_node_init(&drive, &drive_config, bus, 0) != 0 ||
        leg_sensor_node_init(&sensor, &sensor_config, bus, 0) != 0 ||
        host_task_init(&rig, &subject, &params, bus, 0.5, true) != CONTROL_PARAMS_OK) {
        abort();
    }
    for (; size >= RECORD; data += RECORD, size -= RECORD) {
        struct can_msg message;
        take_record(data, &message, &now_ns);
        (void)drive_node_receive(&drive, &message, now_ns);
        (void)leg_sensor_node_receive(&sensor, &message, now_ns);
        inbox.message = message;
        inbox.full = true;
        (void)control_task_poll(&rig.task);
        check_drive(&drive);
        check_task(&rig.task);
    }
    return 0;
}
