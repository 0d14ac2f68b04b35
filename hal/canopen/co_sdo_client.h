/* SDO client, CiA 301 clause 7.2.4: one transfer at a time with one server,
 * expedited and segmented, as a state machine that never blocks.
 *
 * Use: co_sdo_client_read() or _write(), then feed answers to _receive() and call
 * _poll() until it is no longer CO_SDO_BUSY.
 */
#ifndef HAL_CANOPEN_CO_SDO_CLIENT_H
#define HAL_CANOPEN_CO_SDO_CLIENT_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/canopen/co_od.h"

enum co_sdo_result {
    CO_SDO_DONE = 0,
    CO_SDO_BUSY = 1,
    CO_SDO_ABORTED = -1, /* abort_code says why: the server's word or CO_ABORT_TIMEOUT */
};

struct co_sdo_client {
    uint8_t node; /* the server's node */
    uint8_t state;
    uint8_t toggle;
    uint8_t length; /* of the value in buffer */
    uint8_t position;
    uint8_t sub;
    uint16_t index;
    bool unsent; /* the bus had no room for `request` */
    uint8_t request[8];
    uint32_t abort_code;
    uint64_t sent_ns;
    uint64_t timeout_ns;
    uint8_t buffer[CO_VALUE_MAX];
};

/* node 1..127; an answer that takes longer than timeout_ns ends the transfer. */
void co_sdo_client_init(struct co_sdo_client *client, uint8_t node, uint64_t timeout_ns);

/* Starts reading index:sub; a transfer under way is forgotten (the server notices
 * by the new request). The first frame leaves with the next _poll. */
void co_sdo_client_read(struct co_sdo_client *client, uint16_t index, uint8_t sub, uint64_t now_ns);

/* Starts writing length bytes (1..CO_VALUE_MAX, copied, bus order). */
void co_sdo_client_write(struct co_sdo_client *client, uint16_t index, uint8_t sub,
                         const uint8_t *bytes, unsigned length, uint64_t now_ns);

/* Takes a frame when it is this server's answer and says whether it did. */
bool co_sdo_client_receive(struct co_sdo_client *client, const struct can_msg *message,
                           uint64_t now_ns);

/* Sends what is due and watches the time. After CO_SDO_DONE of a read the value is
 * buffer[0..length-1]. */
enum co_sdo_result co_sdo_client_poll(struct co_sdo_client *client, const struct can_bus *bus,
                                      uint64_t now_ns);

/* Whether an answer is awaited. */
bool co_sdo_client_is_busy(const struct co_sdo_client *client);

#endif
