/* Puts an emulated processor in the place of the host's control task, and lets the
 * host's run along on the very same frames, to compare every frame they send.
 *
 * It is a can_bus between the host's control task and the in-process bus. What the
 * host's task sends goes nowhere but into the comparison; what the image sends goes
 * onto the bus.
 */
#ifndef SIM_HOST_EMULATOR_PIL_BRIDGE_H
#define SIM_HOST_EMULATOR_PIL_BRIDGE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/bus/can_bus.h"
#include "sim_host/emulator/emulator.h"

enum { PIL_EXPECTED_MAX = 64 };

struct pil_difference {
    uint32_t tick;
    uint32_t place; /* frame of the tick */
    bool missing;   /* the image sent fewer */
    bool extra;     /* or more */
    struct can_msg host, image;
};

struct pil_bridge {
    struct emulator *emulator;
    struct can_bus inner;
    struct pil_record answer; /* collects what is on the bus */
    struct can_msg expected[PIL_EXPECTED_MAX];
    uint32_t expected_count;
    bool in_tick;
    bool primed; /* the image's first SYNC has been read */
    bool dead;   /* the image restarted: no SYNC until pil_bridge_revive */
    bool failed; /* the emulator is gone or silent */
    bool comparing;
    /* What to tell the image with the next answer: bits of enum pil_input. */
    uint32_t inputs;
    /* For the test of the comparison: flips one bit of the image's n-th compared
     * frame; 0 = none. */
    uint64_t corrupt_frame;
    FILE *costs; /* one line a tick: number, instructions; NULL = none; the caller's */
    /* Results. */
    uint64_t compared, differences;
    struct pil_difference first;
    uint32_t ticks; /* SYNCs of the image since its start */
    uint32_t worst_instructions, worst_tick;
    uint64_t total_instructions;
    uint32_t stack_unused;
    uint32_t starts;
    struct pil_hello hello; /* of the last start */
    uint8_t state, fault;   /* as the image's state frames say */
};

/* Prepares a bridge that talks to *emulator, which stays the caller's. */
void pil_bridge_init(struct pil_bridge *bridge, struct emulator *emulator);

/* Reads the image's greeting. Returns 0, or -1 when there is none. */
int pil_bridge_greet(struct pil_bridge *bridge);

/* For loop_config.wrap_bus: context is the bridge. */
struct can_bus pil_bridge_wrap(void *context, struct can_bus inner);

/* After a restart of the image: its SYNCs go onto the bus again. The comparison
 * stays off. */
void pil_bridge_revive(struct pil_bridge *bridge);

#endif
