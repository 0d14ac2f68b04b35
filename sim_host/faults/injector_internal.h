/* Shared by the two halves of the injector. */
#ifndef SIM_HOST_FAULTS_INJECTOR_INTERNAL_H
#define SIM_HOST_FAULTS_INJECTOR_INTERNAL_H

#include "sim_host/faults/injector.h"

enum side injector_side(const struct fault_shot *shot);
bool injector_is_drive(const struct fault_shot *shot);
/* The identifier of the shot's side, given the left one's; the node's number. */
uint32_t injector_by_side(const struct fault_shot *shot, uint32_t left);
uint32_t injector_node_id(const struct fault_shot *shot);

/* Bus: what the shot does to a frame that won arbitration. */
struct sim_bus_fault injector_on_frame(struct shot_state *state, const struct can_msg *message,
                                       unsigned sender);

/* A foreign node with a clock of its own: it begins to send at an arbitrary moment of the
 * tick that starts at now_ns; foreign_node_send puts one frame on its port and sets
 * state->next_ns to the moment of the next. Kinds that send nothing: next_ns UINT64_MAX. */
void foreign_node_begin(struct shot_state *state, uint64_t now_ns);
void foreign_node_send(struct shot_state *state, struct loop *loop);

/* Nodes and plant: when a shot begins and ends, and before every tick while it lasts. */
void injector_start(struct shot_state *state, struct loop *loop);
void injector_stop(struct shot_state *state, struct loop *loop);
void injector_hold(struct shot_state *state, struct loop *loop);

#endif
