#include "firmware/bring_up.h"

#include "hal/bus/frame_table.h"

void bring_up_skip(struct bring_up *bring_up)
{
    bring_up->configured = (1u << NETWORK_NODES) - 1u;
}

bool bring_up_is_configured(const struct bring_up *bring_up, unsigned index)
{
    return (bring_up->configured & (1u << index)) != 0;
}

/* Forgets what is no longer so: nodes that are silent or booted anew must be set up again. */
static void drop_lost_nodes(struct bring_up *bring_up, struct network *network)
{
    struct node_setup *setup = &bring_up->setup;
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &network->node[i];
        const bool silent = node->state == NMT_UNKNOWN;
        const bool under_way = setup->node == node->id;
        if (silent || node->booted) {
            bring_up->configured = (uint8_t)(bring_up->configured & ~(1u << i));
        }
        if (under_way && !silent) {
            bring_up->scanning = false;
        }
        if (under_way && ((silent && !bring_up->scanning) || node->booted || node->stop_pending)) {
            setup->node = 0;
        }
    }
    network_clear_booted(network);
}

static void begin_next_node(struct bring_up *bring_up, struct network *network,
                            const struct node_setup_config *config, const struct can_bus *bus,
                            uint64_t now_ns)
{
    struct node_setup *setup = &bring_up->setup;
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &network->node[i];
        const bool is_free = setup->node == 0 || bring_up->scanning;
        if (is_free && node->state != NMT_UNKNOWN && !node->stop_pending &&
            !bring_up_is_configured(bring_up, i)) {
            bring_up->scanning = false;
            node_setup_start(setup, config, node->id, now_ns);
            (void)network_enter_pre_operational(network, bus, setup->node);
        }
    }
}

/* Asks the next silent node. It has been given the time of a heartbeat to say something by itself. */
static void begin_scan(struct bring_up *bring_up, const struct network *network,
                       const struct node_setup_config *config, uint64_t now_ns)
{
    for (unsigned i = 1; i <= NETWORK_NODES && bring_up->setup.node == 0; i++) {
        const unsigned index = (bring_up->scanned + i) % NETWORK_NODES;
        const struct network_node *node = &network->node[index];
        if (node->state == NMT_UNKNOWN && network_is_overdue(network, index)) {
            bring_up->scanned = (uint8_t)index;
            bring_up->scanning = true;
            bring_up->scan_ticks = 0;
            node_setup_start(&bring_up->setup, config, node->id, now_ns);
        }
    }
}

/* All nodes that there are speak and are set up, and none began anew: so it is in nearly every tick. */
static bool is_settled(const struct bring_up *bring_up, const struct network *network)
{
    bool settled = bring_up->setup.node == 0;
    for (unsigned i = 0; i < NETWORK_NODES && settled; i++) {
        const struct network_node *node = &network->node[i];
        settled = node->id == 0 || (node->state != NMT_UNKNOWN && !node->booted &&
                                    bring_up_is_configured(bring_up, i));
    }
    return settled;
}

struct bring_up_result bring_up_update(struct bring_up *bring_up, struct network *network,
                                       const struct node_setup_config *config,
                                       const struct can_bus *bus, uint64_t now_ns)
{
    struct node_setup *setup = &bring_up->setup;
    struct bring_up_result result = {SETUP_BUSY, 0};
    if (is_settled(bring_up, network)) {
        return result;
    }
    drop_lost_nodes(bring_up, network);
    begin_next_node(bring_up, network, config, bus, now_ns);
    begin_scan(bring_up, network, config, now_ns);
    if (setup->node == 0 || setup->failure.verdict != SETUP_DONE) {
        return result;
    }
    result.node = setup->node;
    result.verdict = node_setup_poll(setup, bus, now_ns);
    if (bring_up->scanning && result.verdict == SETUP_SILENT) {
        setup->node = 0; /* not there: nothing to tell */
        return (struct bring_up_result){SETUP_BUSY, 0};
    }
    if (bring_up->scanning && result.verdict == SETUP_DONE &&
        bring_up->scan_ticks < HEARTBEAT_TIMEOUT_TICKS) {
        bring_up->scan_ticks++; /* its heartbeat has just been switched on */
        return (struct bring_up_result){SETUP_BUSY, 0};
    }
    if (result.verdict == SETUP_DONE) {
        bring_up->configured =
            (uint8_t)(bring_up->configured | 1u << network_index(network, result.node));
        setup->node = 0;
    } else if (result.verdict == SETUP_SILENT) {
        setup->node = 0; /* a frame may have been lost: from the start again */
    }
    return result;
}
