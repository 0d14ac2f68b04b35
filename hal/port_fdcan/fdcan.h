/* FDCAN1 of the STM32G474 as a can_bus: classic CAN, 1 Mbit/s, standard frames.
 *
 * The interrupt copies: received frames into a ring, in the order of the bus, the
 * echo of the own SYNC among them, and waiting frames into the three transmit
 * buffers, lowest identifier first. The loop interprets.
 *
 * Frames that wait when the bus goes off are dropped: a command that is late is
 * worse than none, and the drives' own time-out is the defined reaction.
 */
#ifndef HAL_PORT_FDCAN_FDCAN_H
#define HAL_PORT_FDCAN_FDCAN_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"

enum {
    FDCAN_RX_RING =
        16,          /* a power of two; a frame takes 50 us or more, a tick of the loop as long */
    FDCAN_BATCH = 4, /* so many received frames do not wait for the tick to end */
    FDCAN_URGENT_ID = 0x580, /* SDO: somebody may wait for the answer */
    FDCAN_URGENT_LAST = 0x67F,
    FDCAN_TX_QUEUE = 12,
    FDCAN_TX_BUFFERS = 3,
    FDCAN_INIT_POLLS = 100000 /* a few ms: the core needs some bit times */
};

/* One entry of the acceptance list: identifiers first..last, into FIFO 0 or 1. */
struct fdcan_filter {
    uint16_t first;
    uint16_t last;
    uint8_t fifo;
};

struct fdcan_received {
    struct can_msg message;
    uint64_t time_ns;
};

struct fdcan_config {
    uint32_t kernel_clock_hz;           /* of the core: a multiple of 24 MHz's 24 quanta a bit */
    const struct fdcan_filter *filters; /* the caller's, read at init only */
    uint32_t filter_count;              /* at most 28 */
    /* The port's clock; callable from the ISR. NULL: nobody asks when a frame came, and each is cheaper. */
    uint64_t (*now_ns)(void *context);
    void *now_context;
};

struct fdcan {
    struct fdcan_config config;
    /* Received: written by the interrupt, read by the loop. */
    struct fdcan_received ring[FDCAN_RX_RING];
    volatile uint32_t ring_in;
    volatile uint32_t ring_out;
    volatile uint32_t ring_due; /* up to here the loop should not wait */
    /* To send: sorted, the next one last. Under mmio_lock. */
    struct can_msg queue[FDCAN_TX_QUEUE + 1]; /* the last for one that was cancelled */
    uint32_t queued;
    struct can_msg in_buffer[FDCAN_TX_BUFFERS];
    uint32_t pending;    /* bit per buffer that holds a frame */
    uint32_t cancelling; /* bit per buffer asked back for a more urgent frame */
    struct can_bus_status status;
    bool started;
    uint32_t lost_register; /* its address, in the registers or in the message RAM; 0 = none */
};

enum fdcan_result {
    FDCAN_OK = 0,
    FDCAN_BAD_CONFIG = -1, /* clock gives no exact 1 Mbit/s, or too many filters */
    FDCAN_TIMEOUT = -2,    /* the core did not enter or leave its init mode */
    FDCAN_LOST_WRITE = -3  /* lost_register does not hold what was written; not on the bus */
};

/* Sets FDCAN1 up and joins the bus. Clock and pins must be on. *can stays the
 * caller's. Start-up only; blocks some ms at most. */
enum fdcan_result fdcan_init(struct fdcan *can, const struct fdcan_config *config);

/* The interrupt, line 0. The highest priority of all, so that what it reads from
 * the two FIFOs and the event FIFO belongs together. Below 400 instructions a
 * frame. */
void fdcan_interrupt(struct fdcan *can);

/* True while received frames wait for the loop that are due: the own SYNC's echo, which begins a tick, what
 * may want an answer, or FDCAN_BATCH of them. Fewer others can wait for the next tick, and each look
 * costs. Any context; O(1). */
static inline bool fdcan_is_due(const struct fdcan *can)
{
    return (int32_t)(can->ring_due - can->ring_out) > 0;
}

/* The bus interface on *can. */
struct can_bus fdcan_bus(struct fdcan *can);

/* Leaves the bus at once; nothing is sent any more until a reset. Any context,
 * fault handlers included. */
void fdcan_silence(void);

#endif
