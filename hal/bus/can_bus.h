/* The CAN bus as the portable code sees it: a table of functions and a context.
 *
 * Ports: SocketCAN (Linux), FDCAN (STM32G474), semihosting pipes and slcan
 * (MPS2-AN386), the in-process bus of sim_host. (The struct is called can_msg
 * because Linux's own header owns the name can_frame.)
 */
#ifndef HAL_BUS_CAN_BUS_H
#define HAL_BUS_CAN_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_frame.h"

enum can_result {
    CAN_OK = 0,
    CAN_EMPTY = -1,   /* receive: nothing waits */
    CAN_FULL = -2,    /* send: no room, and nothing less urgent waits; the frame was NOT taken */
    CAN_INVALID = -3, /* send: length above 8 or identifier out of range */
    CAN_DOWN = -4     /* the interface is down or bus-off; nothing was taken */
};

/* Fault confinement states of ISO 11898-1; the values appear in telemetry. */
enum can_error_state {
    CAN_ERROR_ACTIVE = 0,
    CAN_ERROR_WARNING = 1, /* an error counter reached 96 */
    CAN_ERROR_PASSIVE = 2, /* an error counter reached 128 */
    CAN_BUS_OFF = 3
};

/* Everything counted since opening; counters saturate, never wrap. */
struct can_bus_status {
    enum can_error_state error_state;
    uint8_t tx_error_count;
    uint8_t rx_error_count;
    uint32_t tx_frames;
    uint32_t rx_frames;
    uint32_t tx_refused;  /* send returned CAN_FULL, or gave up another frame for a new one */
    uint32_t rx_overflow; /* frames lost because nobody fetched them in time */
    uint32_t error_frames;
    uint32_t bus_off_count;
};

struct can_bus_ops {
    /* Queues a copy of *message; never blocks. Waiting frames leave in the order
     * of their identifiers, as arbitration would have it. A full queue gives up its
     * least urgent frame for a more urgent one: however many old targets wait, an NMT
     * stop goes out (not where frames leave as they are sent: pipes, slcan). Loop only,
     * not ISR.
     * CAN_OK is therefore no promise: what was taken may be given up later, which
     * status.tx_refused alone tells. Returns CAN_OK, CAN_FULL, CAN_INVALID or CAN_DOWN. */
    enum can_result (*send)(void *context, const struct can_msg *message);

    /* Fetches the oldest received frame into *message, with the time it was on
     * the bus in *time_ns (the port's own monotonic clock; may be NULL); never
     * blocks. Also delivers the own SYNC (identifier 0x080), marked
     * CAN_FRAME_OWN, at its place in the order of the bus: it is the boundary of
     * a tick. Other own frames are not delivered. Bus errors arrive as
     * CAN_FRAME_ERROR messages. Returns CAN_OK, CAN_EMPTY or CAN_DOWN. */
    enum can_result (*receive)(void *context, struct can_msg *message, uint64_t *time_ns);

    void (*get_status)(void *context, struct can_bus_status *status);

    /* Asks for recovery from bus-off (128 x 11 recessive bits, ISO 11898-1);
     * without effect in any other state. Returns at once. */
    void (*recover)(void *context);
};

struct can_bus {
    const struct can_bus_ops *ops;
    void *context;
};

static inline enum can_result can_bus_send(const struct can_bus *bus, const struct can_msg *message)
{
    return bus->ops->send(bus->context, message);
}

static inline enum can_result can_bus_receive(const struct can_bus *bus, struct can_msg *message,
                                              uint64_t *time_ns)
{
    return bus->ops->receive(bus->context, message, time_ns);
}

static inline void can_bus_get_status(const struct can_bus *bus, struct can_bus_status *status)
{
    bus->ops->get_status(bus->context, status);
}

static inline void can_bus_recover(const struct can_bus *bus)
{
    bus->ops->recover(bus->context);
}

#endif
