/* Puts faults into a running loop: on its bus, into its nodes, plant, clock, commands.
 *
 * A shot is one fault: what, where, when, how long, how strong. The injector ticks the
 * loop in loop_tick()'s place, because some faults are in the tick itself. Every random
 * choice comes from its own generator, so a run repeats bit for bit.
 */
#ifndef SIM_HOST_FAULTS_INJECTOR_H
#define SIM_HOST_FAULTS_INJECTOR_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/faults/fault_kinds.h"
#include "sim_host/loop/loop.h"

enum { INJECTOR_SHOTS = 2, INJECTOR_PORT_FIRST_NODE = 1, INJECTOR_PORT_FOREIGN = 5 };

struct fault_shot {
    enum fault_kind kind;
    uint8_t node;        /* 0..3, enum walker_node: which of them; its side for sides */
    uint32_t start_tick; /* after the injector's begin */
    uint32_t duration_ticks;
    double magnitude;
    uint64_t seed;
};

struct shot_state {
    struct fault_shot shot;
    bool active, done;
    uint64_t rng;
    double held[2]; /* values a fault holds: angle, ankle, position */
    struct sea_params sea;
    struct walk_params walk;
    float speed;
    uint32_t changed; /* samples or frames changed */
    uint64_t next_ns; /* foreign node: when its own clock sends next; UINT64_MAX = never */
    uint64_t period_ns;
    bool sporadic; /* single frames in irregular distances of period_ns on average */
};

struct injector {
    struct loop *loop;
    uint32_t tick;
    uint32_t foreign_node_frames; /* the intruder's at the beginning */
    unsigned count;
    struct shot_state shot[INJECTOR_SHOTS];
};

/* The bus needs a seventh port for foreign nodes: once, after loop_init(). */
bool injector_prepare(struct loop *loop);

/* Begins with these shots; takes over the bus's fault hook. *loop must outlive it. */
void injector_begin(struct injector *injector, struct loop *loop, const struct fault_shot *shots,
                    unsigned count);

/* Whether a foreign node sends in this kind of fault. */
bool injector_is_foreign(enum fault_kind kind);

/* Frames of foreign nodes that came through, so far. */
uint32_t injector_intrusions(const struct injector *injector);

/* One SYNC period with whatever is injected in it. */
void injector_tick(struct injector *injector);

/* A uniform number 0 <= x < 1 and the next state; splitmix64 (Steele et al. 2014). */
double injector_random(uint64_t *state);

#endif
