#include "firmware/bring_up.h"

void bring_up_skip(struct bring_up *bring_up)
{
    bring_up->configured = (1u << NETWORK_NODES) - 1u;
}

/* Forgets what is no longer so: nodes that are silent or booted anew must be set up again. */
static void drop_lost_nodes(struct bring_up *bring_up, struct network *network)
{
    struct node_setup *setup = &bring_up->setup;
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &network->node[i];
        const bool is_new = node->state == NMT_UNKNOWN || node->booted;
        if (is_new) {
            bring_up->configured = (uint8_t)(bring_up->configured & ~(1u << i));
        }
        if ((is_new || node->stop_pending) && setup->node == node->id) {
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
    for (unsigned i = 0; i < NETWORK_NODES && setup->node == 0; i++) {
        const struct network_node *node = &network->node[i];
        if (node->state != NMT_UNKNOWN && !node->stop_pending &&
            (bring_up->configured & (1u << i)) == 0) {
            node_setup_start(setup, config, node->id, now_ns);
            (void)network_enter_pre_operational(network, bus, setup->node);
        }
    }
}

struct bring_up_result bring_up_update(struct bring_up *bring_up, struct network *network,
                                       const struct node_setup_config *config,
                                       const struct can_bus *bus, uint64_t now_ns)
{
    struct node_setup *setup = &bring_up->setup;
    struct bring_up_result result = {SETUP_BUSY, 0};
    drop_lost_nodes(bring_up, network);
    begin_next_node(bring_up, network, config, bus, now_ns);
    if (setup->node == 0 || setup->failure.verdict != SETUP_DONE) {
        return result;
    }
    result.node = setup->node;
    result.verdict = node_setup_poll(setup, bus, now_ns);
    if (result.verdict == SETUP_DONE) {
        bring_up->configured = (uint8_t)(bring_up->configured | 1u << network_index(result.node));
        setup->node = 0;
    } else if (result.verdict == SETUP_SILENT) {
        setup->node = 0; /* a frame may have been lost: from the start again */
    }
    return result;
}
