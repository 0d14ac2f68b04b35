/* Shared by the two halves of the injector. */
#ifndef SIM_HOST_FAULTS_INJECTOR_INTERNAL_H
#define SIM_HOST_FAULTS_INJECTOR_INTERNAL_H

#include "sim_host/faults/injector.h"

enum side injector_side(const struct fault_shot *shot);
bool injector_is_drive(const struct fault_shot *shot);

/* Bus: what the shot does to a frame that won arbitration; frames of its own. */
struct sim_bus_fault injector_on_frame(struct shot_state *state, const struct can_msg *message,
                                       unsigned sender);
void injector_send_foreign(struct shot_state *state, struct loop *loop);

/* Nodes and plant: when a shot begins and ends, and before every tick while it lasts. */
void injector_start(struct shot_state *state, struct loop *loop);
void injector_stop(struct shot_state *state, struct loop *loop);
void injector_hold(struct shot_state *state, struct loop *loop);

#endif
