/* `struct can_bus` on Linux SocketCAN (PF_CAN, raw sockets).
 *
 * Only what was asked for is received (kernel filters), so foreign traffic costs
 * nothing; the own SYNC comes back as CAN_FRAME_OWN at its place in the bus's order,
 * other own frames do not; error frames update the status and arrive as
 * CAN_FRAME_ERROR; what is sent leaves, in order of identifiers, with the next
 * receive, wait or flush (one system call for all), or before a SYNC; when the kernel's
 * queue is full (ENOBUFS, EAGAIN) frames go on waiting and CAN_FULL comes when there is no
 * room left (in the kernel's own queue, `txqueuelen` frames long, none overtakes another);
 * receive overflow is counted from SO_RXQ_OVFL; times are the kernel's receive time
 * stamps, turned into CLOCK_MONOTONIC; an interface that is down or gone gives
 * CAN_DOWN and is taken up again when it is back.
 * Facts: Linux Documentation/networking/can.rst; linux/can/raw.h, can/error.h,
 * can/netlink.h.
 */
#ifndef HAL_PORT_SOCKETCAN_SOCKETCAN_BUS_H
#define HAL_PORT_SOCKETCAN_SOCKETCAN_BUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"

enum {
    SOCKETCAN_FILTERS_MAX = 32,
    SOCKETCAN_TX_QUEUE = 32,
    SOCKETCAN_RX_BATCH = 64,
    SOCKETCAN_NAME_MAX = 16,
    SOCKETCAN_ADVICE_MAX = 320
};

/* A standard frame passes when (frame id & mask) == (id & mask) for one of them. */
struct socketcan_filter {
    uint16_t id;
    uint16_t mask;
};

/* What struct can_bus_status has no place for; counters saturate. */
struct socketcan_counters {
    uint32_t kernel_full; /* ENOBUFS or EAGAIN from send */
    uint32_t went_down;   /* interface down or gone */
    uint32_t came_back;
    uint32_t send_errors; /* any other errno from send */
};

struct socketcan_received {
    uint64_t time_ns;
    struct can_msg message;
};

struct socketcan_bus {
    int fd; /* -1 while the interface does not exist */
    char name[SOCKETCAN_NAME_MAX];
    bool hear_own_sync;
    bool is_down;
    uint64_t next_retry_ns;
    uint32_t kernel_drops;
    int64_t realtime_minus_monotonic_ns;
    uint64_t offset_age_ns; /* when that was measured */
    unsigned filter_count;
    struct socketcan_filter filters[SOCKETCAN_FILTERS_MAX];
    struct can_bus_status status;
    struct socketcan_counters counters;
    int restart_error; /* of the newest request for a restart, negative errno */
    bool was_advised;
    unsigned tx_count;
    struct can_msg tx[SOCKETCAN_TX_QUEUE]; /* sorted by identifier, last is next */
    unsigned rx_next, rx_count;            /* of the batch fetched from the kernel */
    struct socketcan_received rx[SOCKETCAN_RX_BATCH];
};

/* Opens `interface_name`. filters: what to receive, copied (count 0: everything,
 * at most SOCKETCAN_FILTERS_MAX). hear_own_sync: the boundary of the tick is wanted (the
 * controller); the SYNC need not be among the filters. Returns 0, or a negative errno
 * value: -ENODEV no such interface, -EAFNOSUPPORT no CAN in this kernel, -ENAMETOOLONG, -EINVAL no
 * name or too many filters. An interface that is down is not an error: the bus starts CAN_DOWN.
 * Not for a real-time loop; all else is. */
int socketcan_bus_open(struct socketcan_bus *bus, const char *interface_name,
                       const struct socketcan_filter *filters, unsigned filter_count,
                       bool hear_own_sync);

/* Replaces the receive filters; same limits and errors as socketcan_bus_open(). */
int socketcan_bus_set_filters(struct socketcan_bus *bus, const struct socketcan_filter *filters,
                              unsigned filter_count);

void socketcan_bus_close(struct socketcan_bus *bus);

/* The interface as the portable code sees it; valid until close. Its recover() asks
 * the kernel over netlink to restart the controller, which needs CAP_NET_ADMIN; without,
 * set `restart-ms` with ip(8). Bus-off ends with any word of the driver that the controller is
 * restarted or error-active, and with any frame that is received. */
struct can_bus socketcan_bus_interface(struct socketcan_bus *bus);

/* Once, after a restart that was asked for could not be: true, and what to do in text[size]
 * (SOCKETCAN_ADVICE_MAX is enough). For a program's standard error; cheap when there is nothing. */
bool socketcan_bus_advice(struct socketcan_bus *bus, char *text, size_t size);

/* Sleeps until a frame waits or CLOCK_MONOTONIC reaches deadline_ns; meanwhile frames
 * that wait here are sent and an interface that came back is taken up. Returns 1 when
 * there is something to receive, 0 at the deadline, negative errno (-EINTR: a signal). */
int socketcan_bus_wait(struct socketcan_bus *bus, uint64_t deadline_ns);

/* Whether a data frame with this identifier is among those that were fetched from the kernel
 * and wait to be received. At most SOCKETCAN_RX_BATCH of them do. */
bool socketcan_bus_has_fetched(const struct socketcan_bus *bus, uint32_t id);

/* Hands what waits to the kernel now. */
void socketcan_bus_flush(struct socketcan_bus *bus);

/* CLOCK_MONOTONIC in ns. */
uint64_t socketcan_now_ns(void);

#endif
