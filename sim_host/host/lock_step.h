/* Who is waited for in lock-step.
 *
 * A controller that runs ahead of its nodes gets their answers in a bunch, and takes them
 * for somebody else's. So it waits for everybody who will answer, not only when all do: a node
 * answers a SYNC when it was told to start before it (frames keep their order), and goes on
 * as long as it has answered the last one.
 */
#ifndef SIM_HOST_HOST_LOCK_STEP_H
#define SIM_HOST_HOST_LOCK_STEP_H

#include <stdbool.h>

#include "firmware/control_task.h"

/* Before a SYNC is sent: the nodes that will answer it, bit i for node i of the network. */
unsigned lock_step_expected(const struct control_task *task);

/* Behind it: whether all of them have, and nobody works on a request of the set-up. */
bool lock_step_answered(const struct control_task *task, unsigned expected);

#endif
