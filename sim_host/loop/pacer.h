/* Real time on Linux: absolute deadlines, best scheduling allowed, jitter measured.
 *
 * A period that is missed is counted and skipped, never made up for by a burst:
 * the bus keeps its cycle.
 */
#ifndef SIM_HOST_LOOP_PACER_H
#define SIM_HOST_LOOP_PACER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* Bins of wake-up lateness: 0-1, 1-2, 2-4, ... us; the last holds everything above. */
enum { PACER_BINS = 16 };

struct pacer {
    uint64_t period_ns;
    uint64_t next_ns; /* CLOCK_MONOTONIC of the next deadline */
    uint64_t periods;
    uint64_t missed; /* deadlines that had passed before we waited for them */
    uint64_t worst_late_ns;
    uint64_t sum_late_ns;
    uint64_t bin[PACER_BINS];
    bool fifo;   /* SCHED_FIFO was granted */
    bool locked; /* memory is locked */
};

/* Asks for SCHED_FIFO and locked memory; does without where that is not allowed
 * (fifo and locked say so). The first deadline is one period from now. */
void pacer_start(struct pacer *pacer, uint64_t period_ns);

/* Sleeps until the next deadline. Returns the number of periods that have passed,
 * 1 when all is well. A signal ends the sleep early with 0. */
unsigned pacer_wait(struct pacer *pacer);

/* Scheduling, mean and worst lateness, missed deadlines, histogram. */
void pacer_report(const struct pacer *pacer, FILE *stream);

#endif
