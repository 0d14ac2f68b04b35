/* Brings the nodes of the network up: sets them up one after the other, as they appear, and
 * keeps which of them may be started.
 *
 * A node that is silent or boots again starts over; one that is stopped answers no SDO, and
 * waits. A node whose heartbeat time is 0 says nothing until it is asked (CiA 301, 7.5.2.18), so silent
 * nodes are asked for their device type in turn, one at a time, whenever no other is waiting. A
 * node that is refused stays so until the controller starts again.
 */
#ifndef FIRMWARE_BRING_UP_H
#define FIRMWARE_BRING_UP_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/canopen/network.h"
#include "hal/devices/node_setup.h"

struct bring_up {
    struct node_setup setup; /* of the node under way; setup.node 0 = none */
    uint8_t configured;      /* bit i: node i of the network is set up */
    uint8_t scanned;         /* index of the silent node that was asked last */
    bool scanning;           /* the node under way was silent when it was asked */
    uint16_t scan_ticks;     /* since its set-up ended and its first heartbeat is awaited */
};

struct bring_up_result {
    enum setup_verdict verdict; /* SETUP_BUSY: nothing new */
    uint8_t node;               /* with SETUP_DONE: which one is set up; else see setup.failure */
};

/* Without a set-up of its own (nodes of another protocol): every node may be started. O(1). */
void bring_up_skip(struct bring_up *bring_up);

/* Whether node `index` of the network is set up, so that PDOs mean to it what they mean here. O(1). */
bool bring_up_is_configured(const struct bring_up *bring_up, unsigned index);

/* Once a tick: goes on with the node under way, or begins with the next one. At most one SDO
 * request and one NMT command a tick. *config must outlive the node's set-up. Loop only;
 * O(NETWORK_NODES). */
struct bring_up_result bring_up_update(struct bring_up *bring_up, struct network *network,
                                       const struct node_setup_config *config,
                                       const struct can_bus *bus, uint64_t now_ns);

#endif
