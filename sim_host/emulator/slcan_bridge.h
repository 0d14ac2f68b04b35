/* Plays the slcan adapter (LAWICEL protocol) on an emulated board's UART, and puts that board
 * in the place of the host's control task, which runs along and is compared frame by frame.
 *
 * It is a can_bus between the host's control task and the in-process bus, like pil_bridge.h.
 * Frames that the board sends go onto the bus and are acknowledged when they are on it; every
 * frame that the bus brings goes down the line as it comes. The board waits for the answers
 * to its SYNC by itself, so the line and its protocol are all that couples the two.
 */
#ifndef SIM_HOST_EMULATOR_SLCAN_BRIDGE_H
#define SIM_HOST_EMULATOR_SLCAN_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/bus/slcan.h"
#include "sim_host/emulator/emulator.h"

enum { SLCAN_EXPECTED_MAX = 64 };

struct slcan_bridge {
    struct emulator *emulator;
    struct can_bus inner;
    struct slcan_decoder decoder;
    struct can_msg expected[SLCAN_EXPECTED_MAX]; /* sent by the host's task, not yet by the board */
    unsigned expected_count;
    unsigned unacknowledged; /* frames of the board on their way to the bus, besides the SYNC */
    bool in_tick;            /* the host's task has the own SYNC, the board's commands are due */
    bool is_open;            /* the board opened the channel, at 1 Mbit/s */
    bool failed;             /* the emulator is gone, silent, or spoke out of turn */
    uint64_t corrupt_frame;  /* flips one bit of the board's n-th frame; 0 = none */
    /* Results. */
    uint64_t compared, differences;
    uint64_t bytes_in, bytes_out; /* from and to the board */
    uint32_t syncs;
};

/* Prepares a bridge to *emulator (EMULATOR_UART), which stays the caller's. */
void slcan_bridge_init(struct slcan_bridge *bridge, struct emulator *emulator);

/* For loop_config.wrap_bus: context is the bridge. */
struct can_bus slcan_bridge_wrap(void *context, struct can_bus inner);

#endif
