/* A classic CAN bus inside the process, in virtual time.
 *
 * Frames compete by identifier, as ISO 11898-1 has it. They last as long as their
 * exactly stuffed bits (CRC-15 computed) at the chosen bit rate. They are
 * acknowledged, fail, are sent again, and drive nodes to error passive and bus-off.
 * Nothing here reads a clock: time moves only in sim_bus_run_until(), so the
 * same calls give the same log on every machine.
 *
 * A loop attaches every node once, with a wake function that polls the node. Then it
 * queues the SYNC and runs the bus until the next tick. After each frame the bus
 * copies it into the receive queue of every other node and wakes them in order
 * of their ports. What they send takes part in the next arbitration, three bit
 * times later.
 */
#ifndef SIM_HOST_BUS_SIM_BUS_H
#define SIM_HOST_BUS_SIM_BUS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "sim_host/bus/frame_bits.h"

enum {
    SIM_BUS_PORTS_MAX = 16,
    SIM_BUS_TX_QUEUE = 32,
    SIM_BUS_DELAYED_MAX = 32,
    SIM_BUS_RX_QUEUE = 128
};

/* What the tap is told; values appear in logs and tests, they never change. */
enum sim_bus_event_kind {
    SIM_BUS_FRAME = 0,       /* a frame was on the bus; time is the end of its EOF */
    SIM_BUS_ERROR_FRAME = 1, /* transmission destroyed; it will be repeated */
    SIM_BUS_NODE_BUS_OFF = 2,
    SIM_BUS_NODE_RECOVERED = 3
};

/* What a fault hook may do to a frame that won arbitration. */
enum sim_bus_fault_kind {
    SIM_BUS_FAULT_NONE = 0,
    SIM_BUS_FAULT_DROP = 1,     /* on the bus, but `receivers` do not hear it */
    SIM_BUS_FAULT_DESTROY = 2,  /* a bit error at `bit`: error frame, sent again */
    SIM_BUS_FAULT_ALTER = 3,    /* delivered with data XOR `flip`, CRC made to fit */
    SIM_BUS_FAULT_DELAY = 4,    /* taken off the bus, queued again `delay_ns` later */
    SIM_BUS_FAULT_DUPLICATE = 5 /* delivered, and sent a second time */
};

struct sim_bus_fault {
    enum sim_bus_fault_kind kind;
    uint32_t receivers;               /* DROP: bit p = port p; 0 means all */
    uint32_t delay_ns;                /* DELAY */
    uint16_t bit;                     /* DESTROY: stuffed bit after SOF, clipped to the frame */
    uint8_t flip[CAN_FRAME_DATA_MAX]; /* ALTER */
};

struct sim_bus_event {
    enum sim_bus_event_kind kind;
    uint64_t time_ns;
    uint8_t port;                  /* sender, or the node that changed state */
    enum sim_bus_fault_kind fault; /* what the hook did to this frame */
    struct can_msg message;        /* as delivered */
};

/* Called on every event, before the receivers are woken. May not send. */
typedef void (*sim_bus_tap)(void *context, const struct sim_bus_event *event);
/* Called when `sender` won arbitration with *message, at the start of frame. */
typedef struct sim_bus_fault (*sim_bus_fault_hook)(void *context, const struct can_msg *message,
                                                   unsigned sender, uint64_t time_ns);
/* Called after a frame reached this node's receive queue. May receive and send. */
typedef void (*sim_bus_wake)(void *context, uint64_t now_ns);

enum sim_bus_phase { SIM_BUS_IDLE = 0, SIM_BUS_TRANSMIT = 1, SIM_BUS_INTERMISSION = 2 };

/* How the frame on the wire will end. */
enum sim_bus_outcome {
    SIM_BUS_ENDS_WELL = 0,
    SIM_BUS_ENDS_DESTROYED = 1, /* a bit error, or two senders of one identifier */
    SIM_BUS_ENDS_UNHEARD = 2    /* nobody acknowledged */
};

struct sim_bus_stats {
    uint64_t frames;
    uint64_t error_frames;
    uint64_t faults[6]; /* by enum sim_bus_fault_kind: what the hook really did */
    uint64_t babble_frames;
};

struct sim_bus_tx_entry {
    uint32_t key;   /* arbitration field, smaller wins */
    bool hook_done; /* a fault hook had its say already */
    bool is_babble;
    uint64_t queued_ns;
    struct can_msg message;
};

struct sim_bus_rx_entry {
    uint64_t time_ns;
    struct can_msg message;
};

struct sim_bus_delayed {
    uint64_t due_ns;
    unsigned port;
    struct sim_bus_tx_entry entry;
};

struct sim_bus;

struct sim_bus_port {
    struct sim_bus *bus;
    const char *name;
    sim_bus_wake wake;
    void *context;
    bool connected;
    bool recovering;
    bool babbling;
    uint8_t index;
    uint32_t recovery_left; /* sequences of 11 recessive bits still to see */
    uint64_t may_start_ns;  /* suspended transmission of an error-passive node */
    uint64_t babble_until_ns;
    struct can_msg babble;
    int tec;
    int rec;
    struct can_bus_status status;
    unsigned tx_count;
    unsigned rx_head;
    unsigned rx_count;
    struct sim_bus_tx_entry tx[SIM_BUS_TX_QUEUE + 1]; /* sorted, last wins; one for a repeat */
    struct sim_bus_rx_entry rx[SIM_BUS_RX_QUEUE];
};

/* Longest time from queueing to the end of the frame, by standard identifier. */
struct sim_bus_response {
    uint64_t worst_ns[CAN_ID_STANDARD_MAX + 1];
    uint32_t count[CAN_ID_STANDARD_MAX + 1];
};

struct sim_bus {
    struct frame_bits bits;
    uint32_t bit_ns;
    uint64_t now_ns;
    uint64_t idle_since_ns;
    /* The frame on the wire. */
    enum sim_bus_phase phase;
    enum sim_bus_outcome outcome;
    uint64_t phase_end_ns;
    uint64_t busy_ns;    /* taken time up to the end of the last phase */
    uint32_t contenders; /* ports sending this same frame, normally one */
    unsigned sender;
    struct sim_bus_fault fault;
    struct sim_bus_tx_entry wire;
    struct sim_bus_tx_entry rivals[SIM_BUS_PORTS_MAX]; /* what each contender sends */
    /* Frames a fault hook delayed. */
    unsigned delayed_count;
    struct sim_bus_delayed delayed[SIM_BUS_DELAYED_MAX];

    sim_bus_tap tap;
    void *tap_context;
    sim_bus_fault_hook fault_hook;
    void *fault_context;
    struct sim_bus_response *response;
    struct sim_bus_stats stats;
    uint32_t pending;    /* ports with something to send */
    uint32_t recovering; /* ports counting recessive bits */
    unsigned port_count;
    struct sim_bus_port ports[SIM_BUS_PORTS_MAX];
};

/* An empty bus at time 0. bitrate: 10,000..1,000,000 bit/s, a divisor of 1e9
 * (asserted). The bus is large (about 100 kB): keep it static or on the heap of
 * a host program. It holds no resources; there is no close. */
void sim_bus_init(struct sim_bus *bus, uint32_t bitrate);

/* Adds a node. name must outlive the bus; wake may be NULL (the owner polls).
 * Returns the port number 0..15, or -1 when all ports are taken. Order of
 * attaching is the order of waking. */
int sim_bus_attach(struct sim_bus *bus, const char *name, sim_bus_wake wake, void *context);

/* The CAN interface of port `port` (valid as long as the bus). Own SYNC frames
 * come back marked CAN_FRAME_OWN; error frames arrive as CAN_FRAME_ERROR. */
struct can_bus sim_bus_port(struct sim_bus *bus, int port);

/* Runs up to virtual time `until_ns` (>= now, else nothing happens). A frame on
 * the wire at that moment is completed by the next call. Cost: about 0.1 us a
 * frame plus what the wake functions take. Not to be called from a wake
 * function. */
void sim_bus_run_until(struct sim_bus *bus, uint64_t until_ns);

uint64_t sim_bus_now_ns(const struct sim_bus *bus);

/* Share of the time from 0 to now in which the bus was taken, 0..1. */
double sim_bus_load(const struct sim_bus *bus);

/* tap == NULL switches the tap off; likewise the fault hook. */
void sim_bus_set_tap(struct sim_bus *bus, sim_bus_tap tap, void *context);
void sim_bus_set_fault_hook(struct sim_bus *bus, sim_bus_fault_hook hook, void *context);

/* Keeps the worst response time per identifier in *response (cleared here;
 * NULL switches it off). */
void sim_bus_measure_response(struct sim_bus *bus, struct sim_bus_response *response);

/* Pulls or plugs the connector of a port. Pulled: it neither hears nor
 * acknowledges, and its own frames wait in its queue until that is full. */
void sim_bus_connect(struct sim_bus *bus, int port, bool connected);

/* Takes the waiting frames with identifier `id` out of the queue of a port, as a controller
 * does whose transmit request is cancelled. One that is on the wire goes on. Returns how
 * many there were. */
unsigned sim_bus_withdraw(struct sim_bus *bus, int port, uint32_t id);

/* The next moment at which the bus does something by itself: the end of what is on the wire,
 * or when one that waits may start, now at the earliest; UINT64_MAX when nobody can. */
uint64_t sim_bus_next_ns(const struct sim_bus *bus);

/* Replaces the node behind a port by a fresh one: queues and error counters
 * emptied, as after its power was switched off and on. */
void sim_bus_reset_port(struct sim_bus *bus, int port);

/* Lets a port send *message again and again, as a babbling node does, until
 * virtual time until_ns (0 stops it). */
void sim_bus_babble(struct sim_bus *bus, int port, const struct can_msg *message,
                    uint64_t until_ns);

#endif
