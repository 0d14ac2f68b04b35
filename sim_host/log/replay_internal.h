/* Between the files of the replay. */
#ifndef SIM_HOST_LOG_REPLAY_INTERNAL_H
#define SIM_HOST_LOG_REPLAY_INTERNAL_H

#include "sim_host/log/replay.h"

/* What the task sent with this identifier; NULL when there are too many identifiers. */
struct replay_queue *replay_queue_of(struct replay *replay, uint32_t id);

/* Compares a frame with an identifier of the controller. One that the task did not make may be
 * another node's: then it is marked so, and whether it was shows in what follows. In a run's
 * first tick it is a difference at once. */
void replay_compare(struct replay *replay, struct replay_frame *frame);

/* Frames the task sent some cycles ago must have been in the log by now. */
void replay_check_missing(struct replay *replay);

/* The log is over: what was not cleared by then differs. */
void replay_end_suspicion(struct replay *replay);

/* Keeps what an extended frame of a black box's log says; others change nothing. */
void replay_take_note(struct replay *replay, const struct can_msg *message);

/* All that the log says of the time before goes; what was sent and not shown is in a gap.
 * False: it cannot be gone on from, and replay->message says why. */
bool replay_go_on_from_snapshot(struct replay *replay, unsigned long line);

#endif
