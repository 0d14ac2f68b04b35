#include "sim_host/devices/device_frames.h"

#include <stdio.h>
#include <stdlib.h>

#include "hal/bus/frame_table.h"
#include "hal/devices/device_config.h"
#include "hal/devices/sea_drive_cansimple.h"

enum { SLOW_US = 100000, EVENT_US = 10000, TRANSFER_US = 50000 };

struct list {
    struct device_frame *frames;
    unsigned count;
};

static const char *const sides[SIDE_COUNT] = {"LEFT", "RIGHT"};

static void add(struct list *list, const char *what, const char *side, uint32_t id, unsigned bytes,
                unsigned node, char kind, bool in_ticks, uint32_t period, uint32_t deadline)
{
    struct device_frame *frame = &list->frames[list->count++];
    *frame = (struct device_frame){.id = id,
                                   .bytes = (uint8_t)bytes,
                                   .in_ticks = in_ticks,
                                   .period = period,
                                   .deadline = deadline,
                                   .node = (uint8_t)node,
                                   .kind = kind};
    snprintf(frame->name, sizeof frame->name, "%.40s%s%s", what, side[0] != '\0' ? "_" : "", side);
}

static void add_cyclic(struct list *list, const char *what, const char *side, uint32_t id,
                       unsigned bytes, unsigned node)
{
    add(list, what, side, id, bytes, node, 'S', true, 1, 1);
}

/* What CiA 301 gives every node: emergency, SDO, heartbeat. */
static void add_node(struct list *list, const char *role, const char *side, unsigned node)
{
    char name[32];
    snprintf(name, sizeof name, "EMCY_%s", role);
    add(list, name, side, 0x080 + node, 8, node, 'E', false, EVENT_US, EVENT_US);
    snprintf(name, sizeof name, "SDO_ANSWER_%s", role);
    add(list, name, side, 0x580 + node, 8, node, 'A', false, TRANSFER_US, SLOW_US);
    snprintf(name, sizeof name, "SDO_REQUEST_%s", role);
    add(list, name, side, 0x600 + node, 8, node == NODE_CONTROLLER ? 0 : NODE_CONTROLLER, 'A',
        false, TRANSFER_US, SLOW_US);
    snprintf(name, sizeof name, "HEARTBEAT_%s", role);
    add(list, name, side, 0x700 + node, 1, node, 'A', false, SLOW_US, SLOW_US);
}

static void add_command(struct list *list, const char *what, const char *side, uint32_t id,
                        unsigned bytes)
{
    add(list, what, side, id, bytes, NODE_CONTROLLER, 'E', true, 2, 5);
}

static void add_cia402(struct list *list, const struct device_description *device, int leg,
                       const struct node_setup_config *setup)
{
    const struct device_leg *own = &device->leg[leg];
    const unsigned node = (unsigned)own->drive_node;
    const unsigned slow = (device_leg_lacks(own, DEVICE_LACKS_TORQUE) ? 0u : 2u) +
                          (device_leg_lacks(own, DEVICE_LACKS_TEMPERATURE) ? 0u : 2u) +
                          (device_leg_lacks(own, DEVICE_LACKS_BUS_VOLTAGE) ? 0u : 4u);
    const bool outputs = !device_leg_lacks(own, DEVICE_LACKS_OUTPUTS);
    add_node(list, "DRIVE", sides[leg], node);
    add_cyclic(list, "DRIVE_STATE", sides[leg], FRAME_DRIVE_STATE_LEFT + (uint32_t)leg, 6, node);
    if (setup->own_target[leg]) {
        add_cyclic(list, "DRIVE_TARGET", sides[leg], FRAME_DRIVE_TARGETS + (uint32_t)leg, 4,
                   NODE_CONTROLLER);
    } else if (leg == SIDE_LEFT) {
        add_cyclic(list, "DRIVE_TARGETS", "", FRAME_DRIVE_TARGETS, 8, NODE_CONTROLLER);
    }
    add_command(list, "DRIVE_COMMAND", sides[leg], FRAME_DRIVE_COMMAND_LEFT + (uint32_t)leg,
                outputs ? 6 : 2);
    if (slow > 0) {
        add(list, "DRIVE_SLOW", sides[leg], FRAME_DRIVE_SLOW_LEFT + (uint32_t)leg, slow, node, 'N',
            false, SLOW_US, SLOW_US / 2);
    }
}

static void add_cansimple(struct list *list, const struct device_leg *own, int leg)
{
    const uint32_t base = (uint32_t)own->drive_node << 5;
    const unsigned node = (unsigned)own->drive_node;
    add_cyclic(list, "AXIS_TARGET", sides[leg], base | CANSIMPLE_SET_INPUT_POS, 8, NODE_CONTROLLER);
    add_cyclic(list, "AXIS_ESTIMATE", sides[leg], base | CANSIMPLE_ENCODER_ESTIMATES, 8, node);
    add(list, "AXIS_HEARTBEAT", sides[leg], base | CANSIMPLE_HEARTBEAT, 8, node, 'A', false,
        SLOW_US, SLOW_US);
    add(list, "AXIS_STATE", sides[leg], base | CANSIMPLE_SET_AXIS_STATE, 4, NODE_CONTROLLER, 'A',
        false, SLOW_US, SLOW_US);
}

static void add_mit(struct list *list, const struct device_leg *own, int leg)
{
    add_cyclic(list, "MOTOR_COMMAND", sides[leg], (uint32_t)own->drive_node, 8, NODE_CONTROLLER);
    add_cyclic(list, "MOTOR_ANSWER", sides[leg], (uint32_t)own->answer_id, 8,
               (unsigned)own->drive_node);
}

static void add_leg(struct list *list, const struct device_description *device, int leg,
                    const struct node_setup_config *setup)
{
    const struct device_leg *own = &device->leg[leg];
    const unsigned sensor = (unsigned)own->leg_sensor_node;
    const bool apart = device_leg_ankle_is_apart(own);
    if (own->protocol == DEVICE_CIA402) {
        add_cia402(list, device, leg, setup);
    } else if (own->protocol == DEVICE_CANSIMPLE) {
        add_cansimple(list, own, leg);
    } else if (own->protocol == DEVICE_MIT) {
        add_mit(list, own, leg);
    }
    if (device_leg_is_driven(own) && own->latch == DEVICE_LATCH_BOARD) {
        const unsigned board = (unsigned)own->latch_node;
        add_node(list, "LATCH", sides[leg], board);
        add_command(list, "LATCH_COMMAND", sides[leg], FRAME_LATCH_COMMAND_LEFT + (uint32_t)leg, 4);
        if (own->latch_object != 0) {
            add(list, "LATCH_STATE", sides[leg], FRAME_LATCH_STATE_LEFT + (uint32_t)leg, 1, board,
                'E', false, 2 * EVENT_US, EVENT_US);
        }
    }
    add_node(list, "SENSOR", sides[leg], sensor);
    add_cyclic(list, "LEG_STATE", sides[leg], FRAME_LEG_STATE_LEFT + (uint32_t)leg,
               (unsigned)(own->leg_sensor_bits + (apart ? 0 : own->ankle_sensor_bits)) / 8, sensor);
    if (apart) {
        const unsigned ankle = (unsigned)own->ankle_sensor_node;
        add_node(list, "ANKLE", sides[leg], ankle);
        add_cyclic(list, "ANKLE_STATE", sides[leg], FRAME_ANKLE_STATE_LEFT + (uint32_t)leg,
                   (unsigned)own->ankle_sensor_bits / 8, ankle);
    }
}

static int by_identifier(const void *a, const void *b)
{
    const uint32_t left = ((const struct device_frame *)a)->id;
    const uint32_t right = ((const struct device_frame *)b)->id;
    return left < right ? -1 : left > right;
}

unsigned device_frames(const struct device_description *device,
                       struct device_frame frames[DEVICE_FRAMES_MAX])
{
    struct list list = {frames, 0};
    struct node_setup_config setup;
    device_node_setup(device, 1.0f, 1.0f, &setup);
    add(&list, "NMT", "", FRAME_NMT, 2, NODE_CONTROLLER, 'A', false, SLOW_US, SLOW_US);
    add_cyclic(&list, "SYNC", "", FRAME_SYNC, 0, NODE_CONTROLLER);
    add_node(&list, "CONTROLLER", "", NODE_CONTROLLER);
    add(&list, "TELEMETRY", "", FRAME_TELEMETRY, 8, NODE_CONTROLLER, 'E', false, SLOW_US,
        SLOW_US / 2);
    add(&list, "CONTROLLER_STATE", "", FRAME_CONTROLLER_STATE, 6, NODE_CONTROLLER, 'E', false,
        EVENT_US, EVENT_US);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        add_leg(&list, device, leg, &setup);
    }
    qsort(frames, list.count, sizeof frames[0], by_identifier);
    return list.count;
}
