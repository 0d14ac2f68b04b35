/* Between the files of the SocketCAN port. */
#ifndef HAL_PORT_SOCKETCAN_SOCKETCAN_INTERNAL_H
#define HAL_PORT_SOCKETCAN_SOCKETCAN_INTERNAL_H

#include "hal/port_socketcan/socketcan_bus.h"

enum { SOCKETCAN_SYNC_ID = 0x080, SOCKETCAN_NS_PER_S = 1000000000 };

static inline void socketcan_count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

/* How far CLOCK_REALTIME is ahead of CLOCK_MONOTONIC. */
int64_t socketcan_realtime_minus_monotonic_ns(void);

/* Measures that again when it is a second old. */
void socketcan_follow_clock(struct socketcan_bus *bus, uint64_t now_ns);

/* Takes a frame into the queue; false when it is full and nothing less urgent waits. */
bool socketcan_queue(struct socketcan_bus *bus, const struct can_msg *message);

/* Hands the queue to the kernel, as far as it takes it. */
void socketcan_flush(struct socketcan_bus *bus);

/* Fetches the next batch from the kernel. Returns false when the interface is lost. */
bool socketcan_fetch(struct socketcan_bus *bus);

/* True when the interface can be used; tries a lost one now and then. */
bool socketcan_is_usable(struct socketcan_bus *bus);

/* The interface is down or gone, by this errno. */
void socketcan_lose_interface(struct socketcan_bus *bus, int error);

#endif
