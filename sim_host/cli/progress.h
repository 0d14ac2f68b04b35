/* How far a long command is, on standard error: a line that is rewritten on a terminal, and a line now
 * and then where standard error is a file or a pipe, so that a log tells of it, too. */
#ifndef SIM_HOST_CLI_PROGRESS_H
#define SIM_HOST_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
    const char *unit; /* "steps"; NULL = silent */
    uint64_t total;   /* 0 = not known */
    bool is_terminal, is_shown;
    double started_s, told_s;
};

/* Begins. quiet: nothing is ever told. unit stays the caller's. total: how many there will be; 0 when
 * nobody knows. Nothing is printed before some seconds have passed, half a second on a terminal. */
void progress_begin(struct progress *progress, const char *unit, uint64_t total, bool quiet);

/* So many are done. Cheap enough for every step, not for every tick. */
void progress_tell(struct progress *progress, uint64_t done);

/* Clears the terminal's line. */
void progress_end(struct progress *progress);

#endif
