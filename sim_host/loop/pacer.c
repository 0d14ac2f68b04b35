#include "sim_host/loop/pacer.h"

#include <errno.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

static uint64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

void pacer_start(struct pacer *pacer, uint64_t period_ns)
{
    const struct sched_param priority = {.sched_priority = 50};
    *pacer = (struct pacer){.period_ns = period_ns};
    pacer->fifo = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
    pacer->locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
    pacer->next_ns = now_ns() + period_ns;
}

static unsigned bin_of(uint64_t late_ns)
{
    uint64_t limit_ns = 1000;
    unsigned bin = 0;
    while (late_ns >= limit_ns && bin < PACER_BINS - 1) {
        limit_ns *= 2;
        bin++;
    }
    return bin;
}

unsigned pacer_wait(struct pacer *pacer)
{
    unsigned passed = 1;
    uint64_t now = now_ns();
    if (now >= pacer->next_ns) {
        const uint64_t skipped = (now - pacer->next_ns) / pacer->period_ns + 1;
        pacer->missed += skipped;
        pacer->next_ns += skipped * pacer->period_ns;
        passed += (unsigned)skipped;
    }
    const struct timespec deadline = {(time_t)(pacer->next_ns / 1000000000u),
                                      (long)(pacer->next_ns % 1000000000u)};
    if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, NULL) == EINTR) {
        return 0;
    }
    now = now_ns();
    const uint64_t late_ns = now > pacer->next_ns ? now - pacer->next_ns : 0;
    pacer->bin[bin_of(late_ns)]++;
    pacer->sum_late_ns += late_ns;
    if (late_ns > pacer->worst_late_ns) {
        pacer->worst_late_ns = late_ns;
    }
    pacer->periods++;
    pacer->next_ns += pacer->period_ns;
    return passed;
}

void pacer_report(const struct pacer *pacer, FILE *stream)
{
    const double begun = pacer->periods > 0 ? (double)pacer->periods : 1.0;
    const double due = begun + (double)pacer->missed;
    fprintf(
        stream,
        "  real time  %llu periods of %.3f ms begun by the clock; %llu (%.3g %%) missed: woken too "
        "late, or still in the one before\n",
        (unsigned long long)pacer->periods, 1e-6 * (double)pacer->period_ns,
        (unsigned long long)pacer->missed, 100.0 * (double)pacer->missed / due);
    fprintf(stream, "             %s, memory %s\n",
            pacer->fifo ? "SCHED_FIFO" : "ordinary scheduling: SCHED_FIFO is not allowed",
            pacer->locked ? "locked" : "not locked: not allowed");
    fprintf(stream, "  woken late mean %.1f us, worst %.1f us\n",
            1e-3 * (double)pacer->sum_late_ns / begun, 1e-3 * (double)pacer->worst_late_ns);
    for (unsigned i = 0; i < PACER_BINS; i++) {
        const double share = 100.0 * (double)pacer->bin[i] / begun;
        if (pacer->bin[i] == 0) {
            continue;
        }
        if (i < PACER_BINS - 1) {
            fprintf(stream, "             %5u to %5u us", i > 0 ? 1u << (i - 1) : 0, 1u << i);
        } else {
            fprintf(stream, "             %5u us and more", 1u << (i - 1));
        }
        fprintf(stream, "  %9llu  %6.2f %%\n", (unsigned long long)pacer->bin[i], share);
    }
}
