#include "sim_host/nodes/latch_node.h"

#include <string.h>

#include "hal/bus/frame_table.h"

enum { STATE_TPDO = 0 };

static const struct co_entry latch_objects[] = {
    CO_ANY(struct latch_node, closed, 0x2101, 0, CO_UNSIGNED8, CO_READ | CO_MAP_TX, "Latch closed"),
    CO_ANY(struct latch_node, output_subs, 0x60FE, 0, CO_UNSIGNED8, CO_READ | CO_CONST,
           "Digital outputs"),
    CO_ANY(struct latch_node, outputs, 0x60FE, 1, CO_UNSIGNED32, CO_READ | CO_WRITE | CO_MAP_RX,
           "Physical outputs"),
};

static void defaults(void *context, struct co_comm *comm)
{
    (void)context;
    comm->device_type = 401; /* CiA 401: generic I/O */
    comm->heartbeat_ms = HEARTBEAT_PERIOD_MS;
    comm->consumer[0] = (uint32_t)NODE_CONTROLLER << 16 | HEARTBEAT_TIMEOUT_MS;
    memcpy(comm->name, "SEA latch board", sizeof "SEA latch board");
}

static void heartbeat(void *context, uint8_t node, bool alive, uint64_t now_ns)
{
    struct latch_node *latch = context;
    (void)node;
    (void)now_ns;
    if (!alive) {
        latch->outputs = 0;
    }
}

static const struct co_device_ops ops = {.heartbeat = heartbeat};

int latch_node_init(struct latch_node *node, uint8_t node_id, struct can_bus bus, uint64_t now_ns)
{
    memset(node, 0, sizeof *node);
    node->output_subs = 1;
    node->dictionary =
        (struct co_dictionary){latch_objects, sizeof latch_objects / sizeof latch_objects[0], node};
    const struct co_device_config config = {.node_id = node_id,
                                            .application = &node->dictionary,
                                            .ops = &ops,
                                            .context = node,
                                            .pdos = co_pdo_four_init(&node->pdos),
                                            .defaults = defaults};
    return co_device_init(&node->device, &config, bus, now_ns);
}

void latch_node_receive(struct latch_node *node, const struct can_msg *message, uint64_t now_ns)
{
    (void)co_device_receive(&node->device, message, now_ns);
}

void latch_node_process(struct latch_node *node, uint64_t now_ns)
{
    co_device_process(&node->device, now_ns);
}

void latch_node_measure(struct latch_node *node, bool holds)
{
    const uint8_t closed = holds ? 1 : 0;
    if (closed != node->closed) {
        node->closed = closed;
        co_device_trigger_tpdo(&node->device, STATE_TPDO);
    }
}

bool latch_node_armed(const struct latch_node *node)
{
    return co_device_is_operational(&node->device) &&
           (node->outputs & DRIVE_OUTPUT_LATCH_ARMED) != 0;
}
