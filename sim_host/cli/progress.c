#include "sim_host/cli/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "sim_host/cli/program.h"

/* Between two lines, seconds: a terminal's is replaced, a log's stays. */
#define TERMINAL_S 0.5
#define LOG_S 30.0

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_begin(struct progress *progress, const char *unit, uint64_t total, bool quiet)
{
    const double now = now_s();
    *progress = (struct progress){.unit = quiet ? NULL : unit,
                                  .total = total,
                                  .is_terminal = isatty(STDERR_FILENO) == 1,
                                  .started_s = now,
                                  .told_s = now};
}

void progress_tell(struct progress *progress, uint64_t done)
{
    if (progress->unit == NULL) {
        return;
    }
    const double now = now_s(), spent = now - progress->started_s;
    if (now - progress->told_s < (progress->is_terminal ? TERMINAL_S : LOG_S)) {
        return;
    }
    progress->told_s = now;
    progress->is_shown = true;
    fprintf(stderr, "%s%s: %llu", progress->is_terminal ? "\r" : "", program_name(),
            (unsigned long long)done);
    if (progress->total > 0) {
        fprintf(stderr, " of %llu", (unsigned long long)progress->total);
    }
    fprintf(stderr, " %s, %.0f s gone", progress->unit, spent);
    if (progress->total > done && done > 0) {
        fprintf(stderr, ", about %.0f s left",
                spent * (double)(progress->total - done) / (double)done);
    }
    fputs(progress->is_terminal ? "     " : "\n", stderr);
    fflush(stderr);
}

void progress_end(struct progress *progress)
{
    if (progress->is_shown && progress->is_terminal) {
        fprintf(stderr, "\r%78s\r", "");
        fflush(stderr);
    }
    progress->unit = NULL;
}
