/* A tool that writes over SDO to a node's objects: the frames of the fault kinds FOREIGN_SDO (drives and
 * sensors) and FOREIGN_SDO_CONTROLLER.
 *
 * The shot's magnitude, 0 to 1, chooses the object out of all that the node's dictionary has, those that may
 * only be read included; each frame has a value of its own: 0, 1, all bits, one bit changed, any other. Each is
 * one expedited download (CiA 301, 7.2.4.3.3), which takes effect at once where the node does not refuse it.
 */
#ifndef SIM_HOST_FAULTS_STRANGE_TOOL_H
#define SIM_HOST_FAULTS_STRANGE_TOOL_H

#include "sim_host/faults/injector_shot.h"
#include "sim_host/loop/loop.h"

/* How many objects of at most four bytes node 0..3 (enum walker_node) or 4 (the controller) has. */
unsigned strange_tool_objects(const struct loop *loop, unsigned node);

/* The shot's object: its index << 8 | sub-index. */
uint32_t strange_tool_object(const struct loop *loop, const struct fault_shot *shot);

/* The shot's next frame; draws its value from state->rng. */
struct can_msg strange_tool_frame(struct shot_state *state, const struct loop *loop);

#endif
