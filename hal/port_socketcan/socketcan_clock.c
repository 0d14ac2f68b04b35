/* The two clocks: the kernel stamps frames with CLOCK_REALTIME, everybody else counts in CLOCK_MONOTONIC. */
#include <time.h>

#include "hal/port_socketcan/socketcan_internal.h"

static int64_t clock_ns(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * SOCKETCAN_NS_PER_S + now.tv_nsec;
}

/* How far one clock is ahead of the other: of a few readings the one that was least interrupted. */
int64_t socketcan_realtime_minus_monotonic_ns(void)
{
    int64_t ahead = 0, least = INT64_MAX;
    for (int i = 0; i < 5; i++) {
        const int64_t before = clock_ns(CLOCK_MONOTONIC);
        const int64_t real = clock_ns(CLOCK_REALTIME);
        const int64_t took = clock_ns(CLOCK_MONOTONIC) - before;
        if (took < least) {
            least = took;
            ahead = real - (before + took / 2);
        }
    }
    return ahead;
}

uint64_t socketcan_now_ns(void)
{
    return (uint64_t)clock_ns(CLOCK_MONOTONIC);
}

/* The kernel stamps with CLOCK_REALTIME, which may be set: measured again each second. */
void socketcan_follow_clock(struct socketcan_bus *bus, uint64_t now_ns)
{
    if (now_ns - bus->offset_age_ns > (uint64_t)SOCKETCAN_NS_PER_S) {
        bus->offset_age_ns = now_ns;
        bus->realtime_minus_monotonic_ns = socketcan_realtime_minus_monotonic_ns();
    }
}
