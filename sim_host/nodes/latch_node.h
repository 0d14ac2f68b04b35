/* A virtual latch board: a small CANopen device beside a drive that has no latch of its own.
 *
 * Output 0x60FE:01, bit 16 arms the latch; 0x2101 is 1 while it holds, and is sent on change. It disarms
 * when the master's heartbeat fails. Without being set up it maps nothing.
 */
#ifndef SIM_HOST_NODES_LATCH_NODE_H
#define SIM_HOST_NODES_LATCH_NODE_H

#include "hal/canopen/co_device.h"
#include "hal/canopen/co_pdo_objects.h"

struct latch_node {
    struct co_device device;
    struct co_pdo_four pdos;
    struct co_dictionary dictionary;
    uint32_t outputs;    /* 0x60FE:01 */
    uint8_t closed;      /* 0x2101 */
    uint8_t output_subs; /* 0x60FE:00 */
};

/* Boots the board on `bus` (kept by value). Returns 0, or -1 when the number is out of range. Do not move
 * *node afterwards. */
int latch_node_init(struct latch_node *node, uint8_t node_id, struct can_bus bus, uint64_t now_ns);

/* One frame from the bus, whoever it is for; what is due by time. */
void latch_node_receive(struct latch_node *node, const struct can_msg *message, uint64_t now_ns);
void latch_node_process(struct latch_node *node, uint64_t now_ns);

/* Whether the latch holds, from now on; sends it where it changed. */
void latch_node_measure(struct latch_node *node, bool holds);

bool latch_node_armed(const struct latch_node *node);

#endif
