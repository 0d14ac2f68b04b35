/* Watches a loop that runs for days: counters, clocks and memory.
 *
 * Counters must rise and stop at their ends. Clocks must run over without an effect. Memory must not
 * grow. Counters and clocks begin so close to their ends that every one of them passes it. The watch
 * counts what they must be by itself.
 */
#ifndef SIM_HOST_LOOP_SOAK_WATCH_H
#define SIM_HOST_LOOP_SOAK_WATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sim_host/loop/loop.h"

enum {
    SOAK_TICKS_BEFORE_WRAP = 20000, /* of the controller's clock and its count of SYNCs */
    SOAK_SAMPLES_SET_AT = 30000,    /* then the observer's count of samples is put near its end */
    SOAK_SAMPLES_BEFORE_END = 5000,
    SOAK_COUNTERS_MAX = 16
};

enum soak_ill {
    SOAK_COUNTER_FELL = 0,  /* a counter that saturates went back */
    SOAK_COUNTER_STUCK = 1, /* the count of SYNCs is not what it must be */
    SOAK_CLOCK_WRONG = 2,   /* ticks or time of the control task are not what they must be */
    SOAK_MEMORY_GREW = 3,
    SOAK_ILLS = 4
};

struct soak_watch {
    uint32_t seen[SOAK_COUNTERS_MAX]; /* each counter, as of the last tick */
    uint64_t ticks;
    uint64_t now_begin_ns;
    size_t heap_bytes; /* in use when soak_watch_memory was first asked; 0 = not yet */
    long resident_pages;
    uint64_t ill[SOAK_ILLS];       /* how often */
    uint64_t first_ill[SOAK_ILLS]; /* and since which tick */
};

/* Puts counters and clocks of a new loop near their ends. */
void soak_watch_init(struct soak_watch *watch, struct loop *loop);

/* After every tick. */
void soak_watch_tick(struct soak_watch *watch, struct loop *loop);

/* From time to time; the first call is what later ones are compared with. */
void soak_watch_memory(struct soak_watch *watch);

/* What an ill is, in words, for "it is well that ...". */
const char *soak_ill_name(enum soak_ill ill);

#endif
