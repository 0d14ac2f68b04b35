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

/* A SYNC ends the cycle in replay->next: looks for signs of missing frames. */
void replay_gaps_look(struct replay *replay, unsigned long line, uint64_t time_us);

/* The digest of this tick agreed: what came before it was complete. */
void replay_gaps_agreed(struct replay *replay, uint64_t told_tick);

/* Whether missing frames explain a difference now; says where and why. */
bool replay_gaps_explain(const struct replay *replay, char *text, size_t size);

/* Sets replay->interface by what the whole log holds, and goes back to its beginning. False: there is none
 * of the name asked for, or the log cannot be read twice; replay->message says it. */
bool replay_choose_interface(struct replay *replay, FILE *log);

/* Whether the record is of the interface that is replayed (of a pipe: the first one). */
bool replay_is_on_interface(struct replay *replay, const struct candump_record *record);

/* Keeps what an extended frame of a black box's log says; others change nothing. */
void replay_take_note(struct replay *replay, const struct can_msg *message);

/* All that the log says of the time before goes; what was sent and not shown is in a gap.
 * False: it cannot be gone on from, and replay->message says why. */
bool replay_go_on_from_snapshot(struct replay *replay, unsigned long line);

/* A controller's boot-up may wait on the bus for its first ticks' more urgent frames. */
enum { REPLAY_LATE_BOOT_TICKS = 100 };

bool replay_is_boot(const struct can_msg *message);

/* Puts the log at the beginning of the run of the first boot-up in it. *line: of the log, there. Returns false, with the
 * reason in the message, when there is none, or the log is a pipe. */
bool replay_seek_boot(struct replay *replay, FILE *log, unsigned long *line);

#endif
