/* Fuzzer: a whole walk with a stranger on its bus. The controller, both drives, both
 * sensors and the walker run on the in-process bus; the first byte chooses where they are
 * (setting each other up, walking, just stopped), then come records of 12 bytes: identifier (2),
 * length and flags (1), ticks until the next (1), data (8). What must hold whatever the
 * stranger says: a drive has torque and an armed latch only where its state allows it, and
 * what the controller asks for is a number within the stroke. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/loop/loop.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerInitialize(int *argc, char ***argv);

enum { RECORD = 12, IMAGES = 3, RECORDS_MAX = 80 };

/* Ticks at which the walk is taken up. */
static const unsigned begin_at[IMAGES] = {40, 2600, 3000};

static struct loop loop;
static struct loop image[IMAGES];
static int stranger;

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    char message[LOOP_MESSAGE_MAX];
    struct subject subject;
    struct control_params params;
    struct loop_config config;
    (void)argc;
    (void)argv;
    subject_default(&subject);
    if (subject_control_params(&subject, &params, message) != 0 ||
        loop_configure(&config, &subject, &params, 0.45, SENSORS_17BIT, 1, message) != 0 ||
        loop_init(&loop, &config, NULL, message) != 0) {
        abort();
    }
    stranger = sim_bus_attach(&loop.bus, "stranger", NULL, NULL);
    for (unsigned i = 0; i < IMAGES; i++) {
        while (loop.tick < begin_at[i]) {
            loop_tick(&loop);
            if (loop.tick == 2650) {
                loop.rig.task.node.objects.walk_requested = 0;
            }
        }
        image[i] = loop; /* all its pointers lead into itself, and it comes back to its place */
    }
    if (image[1].rig.task.controller.last_step.number < 2) {
        abort(); /* it does not walk: nothing would be shown */
    }
    return 0;
}

static void check_drive(const struct drive_node *node)
{
    struct drive_axis_command command;
    struct drive_node copy = *node; /* the command moves the demand on */
    drive_node_command(&copy, 1000000, &command);
    const bool may_move = node->state == DRIVE_OPERATION_ENABLED ||
                          node->state == DRIVE_QUICK_STOP_ACTIVE ||
                          node->state == DRIVE_FAULT_REACTION;
    if ((command.powered && !may_move) ||
        (command.latch_armed && (node->state != DRIVE_OPERATION_ENABLED || node->unloading)) ||
        !(command.target_m >= -1e7 && command.target_m <= 1e7)) {
        abort();
    }
}

static void check(void)
{
    const struct control_task *task = &loop.rig.task;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const struct sea_request *request = &task->output.sea[side];
        if (!(request->precompression_m >= -1.0f && request->precompression_m <= 1.0f) ||
            (request->latch_armed && !request->enable)) {
            abort();
        }
        check_drive(&loop.nodes.drive[side]);
    }
    if ((unsigned)task->output.state >= SUPERVISOR_STATES) {
        abort();
    }
}

static void say(const uint8_t *record)
{
    static const uint16_t known[] = {0x000, 0x080, 0x081, 0x082, 0x083, 0x090, 0x181, 0x182, 0x201,
                                     0x283, 0x284, 0x290, 0x301, 0x302, 0x381, 0x390, 0x581, 0x583,
                                     0x590, 0x601, 0x602, 0x603, 0x610, 0x701, 0x703, 0x710};
    const unsigned raw = (unsigned)record[0] | (unsigned)record[1] << 8;
    struct can_msg message = {.length = (uint8_t)((record[2] & 0x0FU) % 9U)};
    message.flags = (uint8_t)(record[2] >> 4 & (CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE));
    message.id = (raw & 0x8000U) != 0 ? raw & CAN_ID_STANDARD_MAX
                                      : known[raw % (sizeof known / sizeof known[0])];
    if ((message.flags & CAN_FRAME_REMOTE) == 0) {
        memcpy(message.data, record + 4, message.length);
    }
    /* Whoever collides again and again is thrown off a real bus: this one comes back. */
    sim_bus_reset_port(&loop.bus, stranger);
    const struct can_bus port = sim_bus_port(&loop.bus, stranger);
    (void)can_bus_send(&port, &message);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 1 + RECORD || size > 1 + RECORD * RECORDS_MAX) {
        return 0;
    }
    loop = image[data[0] % IMAGES];
    for (data++, size--; size >= RECORD; data += RECORD, size -= RECORD) {
        say(data);
        for (unsigned ticks = data[3] % 4U; ticks > 0; ticks--) {
            loop_tick(&loop);
            check();
        }
    }
    for (int i = 0; i < 3; i++) { /* what the last record began */
        loop_tick(&loop);
        check();
    }
    return 0;
}
