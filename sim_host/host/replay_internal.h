/* Between the files of the replay. */
#ifndef SIM_HOST_HOST_REPLAY_INTERNAL_H
#define SIM_HOST_HOST_REPLAY_INTERNAL_H

#include "sim_host/host/replay.h"

/* Keeps what an extended frame of a black box's log says; others change nothing. */
void replay_take_note(struct replay *replay, const struct can_msg *message);

/* All that the log says of the time before goes; what was sent and not shown is in a gap.
 * False: it cannot be gone on from, and replay->message says why. */
bool replay_go_on_from_snapshot(struct replay *replay, unsigned long line);

#endif
