#include "hal/network.h"

#include "hal/frame_table.h"

enum { NMT_COMMAND_START = 1, START_REPEAT_TICKS = 50 };

static const uint8_t node_ids[NETWORK_NODES] = {NODE_DRIVE_LEFT, NODE_DRIVE_RIGHT,
                                                NODE_SENSOR_LEFT, NODE_SENSOR_RIGHT};

void network_init(struct network *network)
{
    *network = (struct network){0};
    network->own_state = NMT_OPERATIONAL;
    for (int i = 0; i < NETWORK_NODES; i++) {
        network->node[i].id = node_ids[i];
        network->node[i].state = NMT_UNKNOWN;
    }
}

bool network_receive(struct network *network, const struct can_msg *message)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        struct network_node *node = &network->node[i];
        if (message->id != (uint32_t)(FRAME_HEARTBEAT_DRIVE_LEFT - NODE_DRIVE_LEFT + node->id)) {
            continue;
        }
        if (message->length == 1 && message->flags == 0) {
            node->state = message->data[0] & 0x7Fu;
            node->silent_ticks = 0;
            if (node->state == NMT_BOOT_UP) {
                node->state = NMT_PRE_OPERATIONAL; /* entered right after boot-up */
                node->start_wait = 0;
                node->boot_count = node->boot_count < UINT8_MAX ? (uint8_t)(node->boot_count + 1)
                                                                : node->boot_count;
            }
        }
        return true;
    }
    return false;
}

static void start_node(struct network_node *node, const struct can_bus *bus)
{
    const struct can_msg start = {
        .id = FRAME_NMT, .length = 2, .data = {NMT_COMMAND_START, node->id}};
    if (can_bus_send(bus, &start) == CAN_OK) {
        node->start_wait = START_REPEAT_TICKS;
    }
}

void network_update(struct network *network, const struct can_bus *bus, unsigned may_start)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        struct network_node *node = &network->node[i];
        if (node->silent_ticks >= HEARTBEAT_TIMEOUT_MS) {
            node->state = NMT_UNKNOWN;
        } else {
            node->silent_ticks++;
        }
        if (node->start_wait > 0) {
            node->start_wait--;
        }
        if (node->state == NMT_PRE_OPERATIONAL && node->start_wait == 0 &&
            (may_start & (1u << i)) != 0) {
            start_node(node, bus);
        }
    }
    if (network->heartbeat_wait > 0) {
        network->heartbeat_wait--;
        return;
    }
    const struct can_msg heartbeat = {
        .id = FRAME_HEARTBEAT_CONTROLLER, .length = 1, .data = {network->own_state}};
    if (can_bus_send(bus, &heartbeat) == CAN_OK) {
        network->heartbeat_wait = HEARTBEAT_PERIOD_MS - 1;
    }
}

bool network_all_operational(const struct network *network)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        if (network->node[i].state != NMT_OPERATIONAL) {
            return false;
        }
    }
    return true;
}
