/* The master's view of the network: who is alive, in which NMT state.
 *
 * Consumes the nodes' heartbeats (CiA 301, 7.2.8) and starts each node that
 * reports pre-operational and may be started. The states are those of the
 * heartbeat frame. (The own heartbeat is the controller node's.)
 */
#ifndef HAL_CANOPEN_NETWORK_H
#define HAL_CANOPEN_NETWORK_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/bus/frame_table.h"
#include "model/tick.h"

/* What a node does, and its place: those of NODE_TABLE in its order, then the latch boards, and the ankle
 * sensors that are nodes of their own. Left legs' roles are even. */
#define NETWORK_ROLE(name, number, profile) NETWORK_##name,
enum network_role {
    NODE_TABLE(NETWORK_ROLE) NETWORK_LATCH_LEFT,
    NETWORK_LATCH_RIGHT,
    NETWORK_ANKLE_LEFT,
    NETWORK_ANKLE_RIGHT,
    NETWORK_NODES
};
#undef NETWORK_ROLE

enum nmt_state {
    NMT_BOOT_UP = 0,
    NMT_STOPPED = 4,
    NMT_OPERATIONAL = 5,
    NMT_PRE_OPERATIONAL = 127,
    NMT_UNKNOWN = 255 /* never heard, or silent beyond HEARTBEAT_TIMEOUT_MS */
};

struct network_node {
    uint8_t id;            /* 0 = this device has no such node */
    uint8_t state;         /* enum nmt_state */
    uint16_t silent_ticks; /* since the last heartbeat or boot-up */
    uint16_t start_wait;   /* ticks until NMT start may be repeated */
    uint8_t boot_count;    /* saturates: more than one means it reset itself */
    bool stop_pending;     /* stopped by network_stop_all, and not to be started yet */
    uint16_t error_code;   /* of its newest emergency about itself, 0 = none left */
    bool booted;           /* it booted since network_clear_booted: its boot-up was heard, or it
                              waits without having been asked to */
    bool started;          /* NMT start sent, and nothing but "pre-operational" heard since */
    bool asked_to_wait;    /* sent to pre-operational, and not heard there yet */
};

struct network {
    struct network_node node[NETWORK_NODES];
};

/* NMT commands (CiA 301, 7.2.8.3.1). */
enum nmt_command {
    NMT_START = 1,
    NMT_STOP = 2,
    NMT_ENTER_PRE_OPERATIONAL = 128,
    NMT_RESET_NODE = 129,
    NMT_RESET_COMMUNICATION = 130
};

/* Starts with all nodes unknown: those of NODE_TABLE by their numbers there, and no latch boards. */
void network_init(struct network *network);

/* Gives the nodes other numbers, by role; 0 = there is no such node. Start-up only. */
void network_set_nodes(struct network *network, const uint8_t id[NETWORK_NODES]);

/* Takes boot-up, heartbeat and emergency frames of the nodes; says whether it did. */
bool network_receive(struct network *network, const struct can_msg *message);

/* Once a tick: ages, time-outs, and NMT start for nodes that wait in pre-operational
 * or were stopped, and whose bit (1 << index) is set in may_start. */
void network_update(struct network *network, const struct can_bus *bus, unsigned may_start);

/* Sends one NMT command to a node (0 = all). Returns what the bus says. */
enum can_result network_command(const struct can_bus *bus, enum nmt_command command, uint8_t node);

/* Sends a node to pre-operational, to be set up; that it goes there is then no reset of its own.
 * Returns what the bus says. */
enum can_result network_enter_pre_operational(struct network *network, const struct can_bus *bus,
                                              uint8_t node);

/* Takes all nodes out of operation at once (NMT stop): no PDO is obeyed any more, and each
 * drive unloads by itself (0x6007). They are started again after NETWORK_STOP_TICKS, or when
 * they boot; until then they are `stop_pending`. Returns what the bus says. */
enum can_result network_stop_all(struct network *network, const struct can_bus *bus);
enum { NETWORK_STOP_TICKS = TICKS_OF_MS(1000) };

/* Role of a node's number; NETWORK_NODES if it is none of them. */
unsigned network_index(const struct network *network, uint8_t node);

/* Whether node `index` has been silent for longer than a heartbeat may take. O(1). */
bool network_is_overdue(const struct network *network, unsigned index);

/* Forgets who booted. */
void network_clear_booted(struct network *network);

/* True when all are alive, operational, and without an error of their own device
 * (emergencies about communication are left to its time-outs). */
bool network_all_operational(const struct network *network);

/* True when one of them tells of an error of its own device. */
bool network_has_error(const struct network *network);

#endif
