/* Configuring the nodes before they may run: written over SDO, read back, compared.
 *
 * One step an SDO transfer, one transfer a tick, one node after the other, so that
 * start-up costs the bus at most one request and one answer a cycle. The steps of
 * a node are computed, not stored. A difference that stays for SETUP_SETTLE_MS ends the
 * setup with the object, the expected and the found value: a drive with another scaling, another
 * mode or other limits is refused, never assumed. Objects that the device is said to lack are left
 * alone: what that costs is the device's (enum device_lack, sim_host/devices).
 * Objects: CiA 301, CiA 402-2, CiA 406, as in sim_host/nodes' dictionaries.
 */
#ifndef HAL_DEVICES_NODE_SETUP_H
#define HAL_DEVICES_NODE_SETUP_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/canopen/co_sdo_client.h"
#include "hal/devices/setup_config.h"
#include "model/side.h"

enum setup_verdict {
    SETUP_BUSY = 1,
    SETUP_DONE = 0,
    SETUP_DIFFERS = -1, /* found is not expected */
    SETUP_ABORTED = -2, /* the node refused the transfer: found is its abort code */
    SETUP_SILENT = -3   /* no answer within SETUP_TIMEOUT_MS, SETUP_TRIES times */
};

/* What was wrong; valid when the verdict is negative. */
struct setup_failure {
    enum setup_verdict verdict;
    uint8_t node;
    uint8_t sub;
    uint16_t index;
    uint32_t expected;
    uint32_t found;
};

enum {
    SETUP_TIMEOUT_MS = 100,
    SETUP_TRIES = 3,
    SETUP_SETTLE_MS = 200, /* a value that was written may show the old one for so long */
    SETUP_SCALING_VALUES = 7
};

struct node_setup {
    const struct node_setup_config *config; /* the caller's */
    struct co_sdo_client client;
    struct setup_failure failure;
    uint16_t step;
    uint8_t node;
    uint8_t role;     /* enum network_role */
    uint8_t timeouts; /* of the transfer under way: one lost frame is no refusal */
    uint64_t
        differs_since_ns; /* this step's value is not the expected one; 0 = it was not read yet */
    bool with_rtr;        /* the node refused a PDO without remote requests */
    bool reading_back;    /* the value of this step was written, now it is read */
    bool under_way;       /* a transfer is with the client */
    uint32_t speed_found; /* 0x6080 as read */
    uint32_t scaling[SETUP_SCALING_VALUES]; /* 0x608F, 0x6091, 0x6092, 0x6076 as read */
};

/* Begins with one of config->node; *config must outlive. */
void node_setup_start(struct node_setup *setup, const struct node_setup_config *config,
                      uint8_t node, uint64_t now_ns);

/* Takes an SDO answer of the node being set up and says whether it did. */
bool node_setup_receive(struct node_setup *setup, const struct can_msg *message, uint64_t now_ns);

/* Once a tick: sends the next request when the last is answered. After a negative
 * verdict nothing more is sent; see setup->failure. Constant cost. */
enum setup_verdict node_setup_poll(struct node_setup *setup, const struct can_bus *bus,
                                   uint64_t now_ns);

/* Whether an answer of the node is awaited. */
bool node_setup_is_waiting(const struct node_setup *setup);

#endif
