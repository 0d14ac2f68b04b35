/* A shot: one fault, with what, where, when, how long and how strong, and its state while it runs. */
#ifndef SIM_HOST_FAULTS_INJECTOR_SHOT_H
#define SIM_HOST_FAULTS_INJECTOR_SHOT_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "model/side.h"
#include "sim_host/faults/fault_kinds.h"
#include "sim_host/plant/sea.h"
#include "sim_host/plant/walk.h"

/* Ports of the bus: 0 the controller, from the first node on enum walker_node's, then foreign nodes'. */
enum { INJECTOR_PORT_CONTROLLER = 0, INJECTOR_PORT_FIRST_NODE = 1, INJECTOR_PORT_FOREIGN = 5 };

struct fault_shot {
    enum fault_kind kind;
    uint8_t node;        /* 0..3, enum walker_node; its side, where a fault has a side only */
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

/* The side that the shot's node is on. */
enum side injector_side(const struct fault_shot *shot);

/* The identifier of the shot's side, given the left one's. */
uint32_t injector_by_side(const struct fault_shot *shot, uint32_t left);

/* The CANopen number of the shot's node. */
uint32_t injector_node_id(const struct fault_shot *shot);

/* A uniform number 0 <= x < 1 and the next state; splitmix64 (Steele et al. 2014). */
double injector_random(uint64_t *state);

/* A uniform number low <= x < high of the shot's generator. */
double injector_between(struct shot_state *state, double low, double high);

#endif
