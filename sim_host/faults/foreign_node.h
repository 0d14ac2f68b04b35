/* A foreign node: it sends frames with identifiers of this bus, by a clock of its own.
 *
 * A frame that begins at the same bit as the rightful sender's collides: both see a bit
 * error. At any other moment it comes through. The node draws one of six rhythms, as a
 * second controller, a forgotten script or a gateway has them:
 *   - the bus's period at a fixed phase, or with a clock that is off;
 *   - a faster or a slower period;
 *   - single frames at irregular intervals, or one frame alone.
 * After a bus-off the node recovers by itself, as most controllers are set up to.
 */
#ifndef SIM_HOST_FAULTS_FOREIGN_NODE_H
#define SIM_HOST_FAULTS_FOREIGN_NODE_H

#include "sim_host/faults/injector_shot.h"
#include "sim_host/loop/loop.h"

/* Draws a rhythm and the moment of the first frame within the tick that starts at now_ns.
 * Without effect on a shot whose kind sends nothing: its next_ns stays UINT64_MAX. */
void foreign_node_begin(struct shot_state *state, uint64_t now_ns);

/* Puts one frame on the port of foreign nodes, unless the last one still waits there, and
 * sets state->next_ns to the moment of the next. */
void foreign_node_send(struct shot_state *state, struct loop *loop);

#endif
