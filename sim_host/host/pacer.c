#include "sim_host/host/pacer.h"

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
    const double mean_us =
        pacer->periods > 0 ? 1e-3 * (double)pacer->sum_late_ns / (double)pacer->periods : 0.0;
    fprintf(stream, "  real time  %llu periods of %.3f ms, %llu missed; %s, memory %s\n",
            (unsigned long long)pacer->periods, 1e-6 * (double)pacer->period_ns,
            (unsigned long long)pacer->missed,
            pacer->fifo ? "SCHED_FIFO" : "ordinary scheduling (SCHED_FIFO not allowed)",
            pacer->locked ? "locked" : "not locked");
    fprintf(stream, "  lateness   mean %.1f us, worst %.1f us\n", mean_us,
            1e-3 * (double)pacer->worst_late_ns);
    for (unsigned i = 0; i < PACER_BINS; i++) {
        if (pacer->bin[i] > 0) {
            fprintf(
                stream, "             %s %6u us: %llu\n", i < PACER_BINS - 1 ? "below" : "from ",
                i < PACER_BINS - 1 ? 1u << i : 1u << (i - 1), (unsigned long long)pacer->bin[i]);
        }
    }
}
