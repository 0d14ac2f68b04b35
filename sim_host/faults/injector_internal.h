/* The two halves of the injector: faults of frames, faults of nodes and plant. Private to it. */
#ifndef SIM_HOST_FAULTS_INJECTOR_INTERNAL_H
#define SIM_HOST_FAULTS_INJECTOR_INTERNAL_H

#include "sim_host/bus/sim_bus.h"
#include "sim_host/faults/injector_shot.h"
#include "sim_host/loop/loop.h"

/* What the shot does to a frame that won arbitration. sender: its port. */
struct sim_bus_fault injector_on_frame(struct shot_state *state, const struct can_msg *message,
                                       unsigned sender);

/* Nodes and plant: when a shot begins and ends, and before every tick while it lasts. */
void injector_start(struct shot_state *state, struct loop *loop);
void injector_stop(struct shot_state *state, struct loop *loop);
void injector_hold(struct shot_state *state, struct loop *loop);

/* The same for what befalls a person and what they wear; nothing for the walker. */
void injector_person_start(struct shot_state *state, struct loop *loop);
void injector_person_stop(struct shot_state *state, struct loop *loop);
void injector_person_hold(struct shot_state *state, struct loop *loop);

/* A neutral angle that is off, as an offset of the ankle's extension, m. */
double injector_neutral_m(const struct loop *loop, double degrees);

#endif
