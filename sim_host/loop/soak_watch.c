#include "sim_host/loop/soak_watch.h"
#include "model/tick.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RESIDENT_PAGES_MORE = 256 }; /* 1 MB: what a program touches for the first time, later */

/* Every counter of the controller's side that is said to saturate. */
static unsigned list_counters(struct loop *loop, uint32_t *counter[SOAK_COUNTERS_MAX])
{
    struct control_task *task = &loop->rig.task;
    struct controller_counters *counters = &task->node.objects.counters;
    struct co_device *device = &task->node.device;
    uint32_t *const all[] = {&counters->syncs_sent, /* first: this one has to rise every tick */
                             &counters->syncs_refused,
                             &counters->send_failures,
                             &counters->error_frames,
                             &counters->foreign_frames,
                             &counters->late_answers,
                             &counters->forced_stops,
                             &task->sensors.rx_malformed,
                             &loop->rig.drives.state.cia402.rx_malformed,
                             &device->counters.send_failures,
                             &device->counters.sdo_requests,
                             &device->counters.rpdo_length_errors,
                             &device->counters.emcy_lost,
                             &device->counters.malformed,
                             &device->sdo.aborts};
    memcpy(counter, all, sizeof all);
    return sizeof all / sizeof all[0];
}

void soak_watch_init(struct soak_watch *watch, struct loop *loop)
{
    uint32_t *counter[SOAK_COUNTERS_MAX];
    const unsigned count = list_counters(loop, counter);
    memset(watch, 0, sizeof *watch);
    for (unsigned i = 0; i < count; i++) {
        *counter[i] = UINT32_MAX - (i == 0 ? SOAK_TICKS_BEFORE_WRAP : 1);
        watch->seen[i] = *counter[i];
    }
    loop->rig.task.tick = UINT32_MAX - SOAK_TICKS_BEFORE_WRAP;
    watch->now_begin_ns = loop->rig.task.now_ns;
}

static void note(struct soak_watch *watch, enum soak_ill ill, bool holds)
{
    if (holds && watch->ill[ill]++ == 0) {
        watch->first_ill[ill] = watch->ticks;
    }
}

void soak_watch_tick(struct soak_watch *watch, struct loop *loop)
{
    uint32_t *counter[SOAK_COUNTERS_MAX];
    const unsigned count = list_counters(loop, counter);
    const struct control_task *task = &loop->rig.task;
    watch->ticks++;
    for (unsigned i = 0; i < count; i++) {
        note(watch, SOAK_COUNTER_FELL, *counter[i] < watch->seen[i]);
        watch->seen[i] = *counter[i];
    }
    const uint64_t ends =
        watch->ticks < SOAK_TICKS_BEFORE_WRAP ? watch->ticks : SOAK_TICKS_BEFORE_WRAP;
    note(watch, SOAK_COUNTER_STUCK,
         *counter[0] != UINT32_MAX - SOAK_TICKS_BEFORE_WRAP + (uint32_t)ends);
    note(watch, SOAK_CLOCK_WRONG,
         task->tick != (uint32_t)(UINT32_MAX - SOAK_TICKS_BEFORE_WRAP + watch->ticks) ||
             task->now_ns != watch->now_begin_ns + watch->ticks * UINT64_C(1000) * TICK_PERIOD_US);
    if (watch->ticks == SOAK_SAMPLES_SET_AT) {
        loop->rig.task.controller.observer.samples = UINT32_MAX - SOAK_SAMPLES_BEFORE_END;
    }
}

/* From /proc/self/statm; -1 where there is none. */
static long resident_pages(void)
{
    char text[128] = "";
    FILE *file = fopen("/proc/self/statm", "r");
    if (file == NULL) {
        return -1;
    }
    char *resident = text;
    if (fgets(text, sizeof text, file) != NULL) {
        (void)strtol(text, &resident, 10); /* the whole size */
    }
    fclose(file);
    return strtol(resident, NULL, 10);
}

void soak_watch_memory(struct soak_watch *watch)
{
    /* Pages first: the block that reading them takes and gives back counts as in use. */
    const long pages = resident_pages();
    const size_t heap = mallinfo2().uordblks; /* exact: one block more is one too many */
    if (watch->heap_bytes == 0) {
        watch->heap_bytes = heap;
        watch->resident_pages = pages;
    }
    note(watch, SOAK_MEMORY_GREW,
         heap > watch->heap_bytes || pages > watch->resident_pages + RESIDENT_PAGES_MORE);
}

const char *soak_ill_name(enum soak_ill ill)
{
    static const char *const names[SOAK_ILLS] = {
        [SOAK_COUNTER_FELL] = "no counter went back: at their ends they stay",
        [SOAK_COUNTER_STUCK] = "SYNCs are counted, each one, up to the counter's end",
        [SOAK_CLOCK_WRONG] =
            "the controller's tick and time went on by one at each SYNC, through the wrap",
        [SOAK_MEMORY_GREW] = "not a byte more of the heap is in use than after the first part"};
    return (unsigned)ill < SOAK_ILLS ? names[ill] : "unknown";
}
