/* Decides who is waited for in lock-step.
 *
 * A controller that runs ahead of its nodes gets their answers in a bunch and takes them for those of
 * another node. So it waits for each node that will answer, not only when all will. A node
 * answers when it is operational by its heartbeat, or was told to start before the SYNC (frames keep
 * their order). Nobody waits for a node that was stopped, is being set up, or boots meanwhile.
 */
#ifndef SIM_HOST_LOOP_LOCK_STEP_H
#define SIM_HOST_LOOP_LOCK_STEP_H

#include <stdbool.h>

#include "firmware/control_task.h"

/* Before a SYNC is sent: the nodes that will answer it, bit i for node i of the network. */
unsigned lock_step_expected(const struct control_task *task);

/* Behind it: whether all of them have, and nobody works on a request of the set-up. */
bool lock_step_answered(const struct control_task *task, unsigned expected);

/* Whether every node has told its state. A controller that is switched on beside nodes that
 * are operational already must know so before its first SYNC: they answer it. */
bool lock_step_knows_all(const struct control_task *task);

#endif
