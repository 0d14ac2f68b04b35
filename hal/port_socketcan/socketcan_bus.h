/* `struct can_bus` on Linux SocketCAN (PF_CAN, raw sockets).
 *
 * Only what was asked for is received (kernel filters), so foreign traffic costs
 * nothing; the own SYNC comes back as CAN_FRAME_OWN, other own frames do not;
 * error frames update the status and arrive as CAN_FRAME_ERROR; ENOBUFS becomes
 * CAN_FULL and is counted; receive overflow is counted from SO_RXQ_OVFL; times are
 * the kernel's receive time stamps, turned into CLOCK_MONOTONIC; an interface that
 * goes down gives CAN_DOWN until it comes back.
 * Facts: Linux Documentation/networking/can.rst; linux/can/raw.h, linux/can/error.h.
 */
#ifndef HAL_PORT_SOCKETCAN_SOCKETCAN_BUS_H
#define HAL_PORT_SOCKETCAN_SOCKETCAN_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/can_bus.h"

enum { SOCKETCAN_FILTERS_MAX = 32, SOCKETCAN_TX_QUEUE = 32, SOCKETCAN_NAME_MAX = 16 };

/* A standard data frame passes when (id & mask) == (filter.id & mask). */
struct socketcan_filter {
    uint16_t id;
    uint16_t mask;
};

struct socketcan_bus {
    int fd;
    int sync_fd; /* second socket which hears the own SYNC, -1 if not asked for */
    int interface_index;
    char name[SOCKETCAN_NAME_MAX];
    bool is_down;
    uint32_t kernel_drops;
    int64_t realtime_minus_monotonic_ns;
    struct can_bus_status status;
    unsigned tx_count;
    struct can_msg tx[SOCKETCAN_TX_QUEUE]; /* sorted by identifier, for when the kernel is full */
};

/* Opens `interface_name`. filters: what to receive (count 0: everything); the array
 * is copied. hear_own_sync: the boundary of the tick is wanted (the controller).
 * Returns 0, or a negative errno value (-ENODEV: no such interface; -EAFNOSUPPORT:
 * the kernel has no CAN; -ENETDOWN is not an error here, the bus starts CAN_DOWN).
 * Not for real-time use after start; the others below are. */
int socketcan_bus_open(struct socketcan_bus *bus, const char *interface_name,
                       const struct socketcan_filter *filters, unsigned filter_count,
                       bool hear_own_sync);

void socketcan_bus_close(struct socketcan_bus *bus);

/* The interface as the portable code sees it; valid until close. */
struct can_bus socketcan_bus_interface(struct socketcan_bus *bus);

/* Sleeps until a frame waits, the send queue can move, or CLOCK_MONOTONIC reaches
 * deadline_ns. Returns 1 when there is something to receive, 0 at the deadline,
 * negative errno on failure (-EINTR: a signal). */
int socketcan_bus_wait(struct socketcan_bus *bus, uint64_t deadline_ns);

/* CLOCK_MONOTONIC in ns. */
uint64_t socketcan_now_ns(void);

#endif
