/* Puts faults into a running loop: on its bus, into its nodes, plant, clock, commands.
 *
 * The injector ticks the loop in loop_tick()'s place, because some faults are in the tick
 * itself. Every random choice comes from the shot's own generator, so a run repeats bit for
 * bit.
 */
#ifndef SIM_HOST_FAULTS_INJECTOR_H
#define SIM_HOST_FAULTS_INJECTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/bus_recovery.h"
#include "sim_host/faults/injector_shot.h"
#include "sim_host/loop/loop.h"

enum { INJECTOR_SHOTS = 2 };

struct injector {
    struct loop *loop;
    uint32_t tick;
    struct bus_recovery recovery; /* the controller's */
    uint32_t foreign_node_frames; /* foreign nodes' frames sent before */
    unsigned count;
    struct shot_state shot[INJECTOR_SHOTS];
};

/* Attaches the port of foreign nodes: once, after loop_init(). False when it is not the next port. */
bool injector_prepare(struct loop *loop);

/* Begins with these shots; takes over the bus's fault hook. *loop must outlive it. */
void injector_begin(struct injector *injector, struct loop *loop, const struct fault_shot *shots,
                    unsigned count);

/* Frames that foreign nodes have sent without a collision, since the beginning. */
uint32_t injector_foreign_frames(const struct injector *injector);

/* One SYNC period, with the faults of the shots that are active. */
void injector_tick(struct injector *injector);

#endif
