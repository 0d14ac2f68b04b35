/* Brings the nodes of the network up: sets them up one after the other, as they appear, and
 * keeps which of them may be started.
 *
 * A node that is silent or boots again starts over; one that is stopped answers no SDO, and
 * waits. A node that is refused stays so until the controller starts again.
 */
#ifndef FIRMWARE_BRING_UP_H
#define FIRMWARE_BRING_UP_H

#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/canopen/network.h"
#include "hal/devices/node_setup.h"

struct bring_up {
    struct node_setup setup; /* of the node under way; setup.node 0 = none */
    uint8_t configured;      /* bit i: node i of the network is set up */
};

struct bring_up_result {
    enum setup_verdict verdict; /* SETUP_BUSY: nothing new */
    uint8_t node;               /* with SETUP_DONE: which one is set up; else see setup.failure */
};

/* Without a set-up of its own (nodes of another protocol): every node may be started. O(1). */
void bring_up_skip(struct bring_up *bring_up);

/* Once a tick: goes on with the node under way, or begins with the next one. At most one SDO
 * request and one NMT command a tick. *config must outlive the node's set-up. Loop only;
 * O(NETWORK_NODES). */
struct bring_up_result bring_up_update(struct bring_up *bring_up, struct network *network,
                                       const struct node_setup_config *config,
                                       const struct can_bus *bus, uint64_t now_ns);

#endif
