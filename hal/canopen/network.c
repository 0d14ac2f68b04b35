#include "hal/canopen/network.h"

#include <assert.h>

#include "hal/bus/bytes.h"

enum { START_REPEAT_TICKS = TICKS_OF_MS(50) };

#define NODE_ID(name, number, profile) number,
static const uint8_t node_ids[NETWORK_NODES] = {NODE_TABLE(NODE_ID)};
#undef NODE_ID
static_assert(NETWORK_NODES <= 8, "a bit of a byte for each node (network_update, bring_up.h)");

void network_init(struct network *network)
{
    *network = (struct network){0};
    for (int i = 0; i < NETWORK_NODES; i++) {
        network->node[i].id = node_ids[i];
        network->node[i].state = NMT_UNKNOWN;
    }
}

/* CiA 301, 7.2.7: error code, register, vendor's bytes; 0x00xx = no error (left). 0x81xx and
 * 0x82xx are monitoring and protocol: noticed by their time-outs, and often of the past. */
static bool receive_emergency(struct network *network, const struct can_msg *message)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        struct network_node *node = &network->node[i];
        if (message->id != (uint32_t)(FRAME_EMCY_DRIVE_LEFT - NODE_DRIVE_LEFT + node->id)) {
            continue;
        }
        if (message->length == 8 && message->flags == 0) {
            const uint16_t code = bytes_get_u16(message->data);
            const uint16_t group = (uint16_t)(code & 0xFF00u);
            if (group == 0) {
                node->error_code = 0;
            } else if (group != 0x8100u && group != 0x8200u) {
                node->error_code = code;
            }
        }
        return true;
    }
    return false;
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
                node->stop_pending = false;
                node->booted = true;
                node->error_code = 0;
                node->boot_count = node->boot_count < UINT8_MAX ? (uint8_t)(node->boot_count + 1)
                                                                : node->boot_count;
            }
        }
        return true;
    }
    return receive_emergency(network, message);
}

enum can_result network_command(const struct can_bus *bus, enum nmt_command command, uint8_t node)
{
    const struct can_msg message = {.id = FRAME_NMT, .length = 2, .data = {(uint8_t)command, node}};
    return can_bus_send(bus, &message);
}

enum can_result network_stop_all(struct network *network, const struct can_bus *bus)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        network->node[i].start_wait = NETWORK_STOP_TICKS;
        network->node[i].stop_pending = true;
    }
    return network_command(bus, NMT_STOP, 0);
}

unsigned network_index(uint8_t node)
{
    unsigned index = 0;
    while (index < NETWORK_NODES && node_ids[index] != node) {
        index++;
    }
    return index;
}

void network_clear_booted(struct network *network)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        network->node[i].booted = false;
    }
}

void network_update(struct network *network, const struct can_bus *bus, unsigned may_start)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        struct network_node *node = &network->node[i];
        if (node->silent_ticks <= HEARTBEAT_TIMEOUT_TICKS) {
            node->silent_ticks++;
        }
        if (node->silent_ticks > HEARTBEAT_TIMEOUT_TICKS) {
            node->state = NMT_UNKNOWN;
        }
        if (node->start_wait > 0) {
            node->start_wait--;
        }
        node->stop_pending = node->stop_pending && node->start_wait > 0;
        const bool waits = node->state != NMT_OPERATIONAL && node->state != NMT_UNKNOWN;
        if (waits && node->start_wait == 0 && (may_start & (1u << i)) != 0) {
            if (network_command(bus, NMT_START, node->id) == CAN_OK) {
                node->start_wait = START_REPEAT_TICKS;
            }
        }
    }
}

bool network_has_error(const struct network *network)
{
    bool has = false;
    for (int i = 0; i < NETWORK_NODES; i++) {
        has = has || network->node[i].error_code != 0;
    }
    return has;
}

bool network_all_operational(const struct network *network)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        if (network->node[i].state != NMT_OPERATIONAL) {
            return false;
        }
    }
    return !network_has_error(network);
}
