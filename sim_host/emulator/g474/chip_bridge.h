/* The emulated chip as the control task of a loop: its FDCAN1 is port 0 of the in-process
 * bus, its SYNC drives nodes and plant. The host's control task runs along on the frames
 * that FDCAN1 accepts, and every frame that the image sends is compared with what the
 * host's build of the same code sends.
 *
 * The chip's clock leads; the bus follows it. FDCAN1 sends by urgency, not by the order
 * of requests, so frames are compared by identifier, each identifier in order.
 */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_BRIDGE_H
#define SIM_HOST_EMULATOR_G474_CHIP_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "sim_host/emulator/g474/chip.h"
#include "sim_host/loop/loop.h"

enum { CHIP_EXPECTED_MAX = 256 };

struct chip_expected {
    struct can_msg message;
    uint32_t tick;
};

struct chip_bridge {
    struct chip *chip;
    struct loop *loop;
    struct can_bus inner; /* port 0 */
    /* The loop's own listeners, which are asked first. */
    sim_bus_tap tap;
    void *tap_context;
    sim_bus_fault_hook hook;
    void *hook_context;
    /* FDCAN1 and the bus. */
    uint32_t submitted; /* buffers whose frame is in the port's queue or on the wire */
    uint32_t submitted_id[3];
    bool joined;
    bool sync_held; /* the image asks for its SYNC: the period ends first */
    uint64_t destroy_from_ns, destroy_until_ns; /* all frames begun in between are destroyed */
    /* Comparison. */
    bool comparing;
    struct chip_expected expected[CHIP_EXPECTED_MAX];
    uint32_t expected_count;
    uint64_t compared, differences;
    uint64_t corrupt_frame; /* for the test of the comparison: 0 = none */
    char first_difference[160];
    /* Results. */
    uint32_t ticks, silent_periods; /* SYNCs, and periods without one since the last */
    uint64_t tick_began_instructions;
    uint32_t tick_began_resets;
    uint32_t worst_instructions, worst_tick;
    uint64_t sync_ns, sync_late_ns; /* the last SYNC; the worst deviation from a period */
    uint32_t sync_late_tick;
    uint32_t resets_seen;
    uint32_t idle_permit_ticks;
    uint64_t permit_edges_seen; /* PC1's that the relay was told of */
    uint8_t state, fault;       /* as the image's state frames say */
    uint64_t asked_ns;          /* end of the last SDO request to the image */
    bool heard;                 /* the image has sent a frame since its last start */
    FILE *costs; /* one line a tick: number, instructions; NULL = none; the caller's */
};

/* Prepares the bridge; then loop_init with chip_bridge_wrap, then chip_bridge_connect. */
void chip_bridge_init(struct chip_bridge *bridge, struct chip *chip);
struct can_bus chip_bridge_wrap(void *context, struct can_bus inner);
void chip_bridge_connect(struct chip_bridge *bridge, struct loop *loop);

/* One period: up to the image's next SYNC, or a period's time when none comes. */
void chip_bridge_tick(struct chip_bridge *bridge);

/* A part of a period: `time_ns` of it, or up to the image's next SYNC. */
void chip_bridge_pass(struct chip_bridge *bridge, uint64_t time_ns);

/* After a fault that the host's task cannot share. */
void chip_bridge_stop_comparing(struct chip_bridge *bridge);

/* Between the parts of the bridge: a frame that the image sent; and what it did not send in time. */
void chip_bridge_compare(struct chip_bridge *bridge, const struct can_msg *sent);
void chip_bridge_check_missing(struct chip_bridge *bridge);

#endif
