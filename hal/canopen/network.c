#include "hal/canopen/network.h"

#include <assert.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"

enum { START_REPEAT_TICKS = TICKS_OF_MS(50) };

#define NODE_ID(name, number, profile) [NETWORK_##name] = number,
static const uint8_t node_ids[NETWORK_NODES] = {NODE_TABLE(NODE_ID)};
#undef NODE_ID
static_assert(NETWORK_NODES <= 8, "a bit of a byte for each node (network_update, bring_up.h)");

void network_init(struct network *network)
{
    *network = (struct network){0};
    network_set_nodes(network, node_ids);
}

void network_set_nodes(struct network *network, const uint8_t id[NETWORK_NODES])
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        network->node[i].id = id[i];
        network->node[i].state = NMT_UNKNOWN;
    }
}

/* What is left in the error register, object 0x1001, of the device's own errors. Communication is
 * left to its time-outs; the generic bit comes with every other, and counts where it stands alone. */
static bool has_own_error(uint8_t error_register)
{
    const unsigned others = error_register & ~(unsigned)CO_ERROR_GENERIC;
    return others == 0 ? error_register != 0 : (others & ~(unsigned)CO_ERROR_COMMUNICATION) != 0;
}

/* CiA 301, 7.2.7: error code, register, vendor's bytes. Code 0x00xx says that an error is over, the
 * register whether others are left. 0x81xx and 0x82xx are monitoring and protocol: noticed by
 * their time-outs, and often of the past. */
static bool receive_emergency(struct network *network, const struct can_msg *message)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        struct network_node *node = &network->node[i];
        if (node->id == 0 ||
            message->id != (uint32_t)(FRAME_EMCY_DRIVE_LEFT - NODE_DRIVE_LEFT + node->id)) {
            continue;
        }
        if (message->length == 8 && message->flags == 0) {
            const uint16_t code = bytes_get_u16(message->data);
            const uint16_t group = (uint16_t)(code & 0xFF00u);
            if (group == 0 && !has_own_error(message->data[2])) {
                node->error_code = 0;
            } else if (group == 0) {
                node->error_code = node->error_code != 0 ? node->error_code : CO_EMCY_GENERIC;
            } else if (group != 0x8100u && group != 0x8200u) {
                node->error_code = code;
            }
        }
        return true;
    }
    return false;
}

static void note_boot(struct network_node *node)
{
    node->booted = true;
    node->started = false;
    node->error_code = 0;
    node->boot_count =
        node->boot_count < UINT8_MAX ? (uint8_t)(node->boot_count + 1) : node->boot_count;
}

/* A boot-up frame can get lost. The node tells nevertheless: it fell back without having been asked,
 * or waits still though it was started long ago. */
static bool fell_back(const struct network_node *node)
{
    const bool fell = node->state == NMT_OPERATIONAL || node->state == NMT_STOPPED;
    return (fell && !node->asked_to_wait) || (node->started && node->start_wait == 0);
}

static void receive_state(struct network_node *node, uint8_t state)
{
    if (state == NMT_BOOT_UP) {
        state = NMT_PRE_OPERATIONAL; /* entered right after boot-up */
        node->start_wait = 0;
        node->stop_pending = false;
        note_boot(node);
    } else if (state == NMT_PRE_OPERATIONAL) {
        if (fell_back(node)) {
            note_boot(node);
        }
        node->asked_to_wait = false;
    } else {
        node->started = false;
    }
    node->state = state;
    node->silent_ticks = 0;
}

bool network_receive(struct network *network, const struct can_msg *message)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        struct network_node *node = &network->node[i];
        if (node->id == 0 ||
            message->id != (uint32_t)(FRAME_HEARTBEAT_DRIVE_LEFT - NODE_DRIVE_LEFT + node->id)) {
            continue;
        }
        if (message->length == 1 && message->flags == 0) {
            receive_state(node, message->data[0] & 0x7Fu);
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

enum can_result network_enter_pre_operational(struct network *network, const struct can_bus *bus,
                                              uint8_t node)
{
    const unsigned index = network_index(network, node);
    if (index < NETWORK_NODES) {
        network->node[index].asked_to_wait = true;
        network->node[index].started = false;
    }
    return network_command(bus, NMT_ENTER_PRE_OPERATIONAL, node);
}

enum can_result network_stop_all(struct network *network, const struct can_bus *bus)
{
    for (int i = 0; i < NETWORK_NODES; i++) {
        network->node[i].start_wait = NETWORK_STOP_TICKS;
        network->node[i].stop_pending = true;
        network->node[i].started = false;
    }
    return network_command(bus, NMT_STOP, 0);
}

unsigned network_index(const struct network *network, uint8_t node)
{
    unsigned index = 0;
    while (index < NETWORK_NODES && (node == 0 || network->node[index].id != node)) {
        index++;
    }
    return index;
}

bool network_is_overdue(const struct network *network, unsigned index)
{
    return network->node[index].id != 0 &&
           network->node[index].silent_ticks > HEARTBEAT_TIMEOUT_TICKS;
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
        if (node->id == 0) {
            continue; /* no such node on this bus */
        }
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
                node->started = true;
            }
        }
    }
}

bool network_has_error(const struct network *network)
{
    unsigned codes = 0;
    for (int i = 0; i < NETWORK_NODES; i++) {
        codes |= network->node[i].error_code;
    }
    return codes != 0;
}

bool network_all_operational(const struct network *network)
{
    unsigned codes = 0;
    for (int i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &network->node[i];
        if (node->id != 0 && node->state != NMT_OPERATIONAL) {
            return false;
        }
        codes |= node->error_code;
    }
    return codes == 0;
}
