/* The master's view of the network: who is alive, in which NMT state.
 *
 * Produces the controller's heartbeat, consumes the four nodes' (CiA 301, 7.2.8),
 * and starts each node that reports pre-operational. The states are those of the
 * heartbeat frame.
 */
#ifndef HAL_NETWORK_H
#define HAL_NETWORK_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/can_bus.h"

enum { NETWORK_NODES = 4 };

enum nmt_state {
    NMT_BOOT_UP = 0,
    NMT_STOPPED = 4,
    NMT_OPERATIONAL = 5,
    NMT_PRE_OPERATIONAL = 127,
    NMT_UNKNOWN = 255 /* never heard, or silent beyond HEARTBEAT_TIMEOUT_MS */
};

struct network_node {
    uint8_t id;
    uint8_t state;           /* enum nmt_state */
    uint16_t silent_ticks;   /* since the last heartbeat or boot-up */
    uint16_t start_wait;     /* ticks until NMT start may be repeated */
    uint8_t boot_count;      /* saturates: more than one means it reset itself */
};

struct network {
    struct network_node node[NETWORK_NODES];
    uint16_t heartbeat_wait;
    uint8_t own_state; /* what the own heartbeat says */
};

/* Starts with all nodes unknown. */
void network_init(struct network *network);

/* Takes boot-up and heartbeat frames of the four nodes; says whether it did. */
bool network_receive(struct network *network, const struct can_msg *message);

/* Once a tick: ages, time-outs, the own heartbeat, and NMT start for nodes that
 * wait in pre-operational and whose bit (1 << index) is set in may_start. */
void network_update(struct network *network, const struct can_bus *bus, unsigned may_start);

/* True when all four are alive and operational. */
bool network_all_operational(const struct network *network);

#endif
