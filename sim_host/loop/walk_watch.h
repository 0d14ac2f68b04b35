/* When a walk of so many steps is over, and how it ended: the same for every command that walks. */
#ifndef SIM_HOST_LOOP_WALK_WATCH_H
#define SIM_HOST_LOOP_WALK_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/loop/loop.h"
#include "sim_host/loop/walk_record.h"

enum walk_end {
    WALK_GOES_ON = 0,
    WALK_DONE = 1,           /* all steps, the controller's record of the last among them */
    WALK_FELL = 2,           /* plant_fault() says how */
    WALK_RECORDING_OVER = 3, /* the recorded person's last sample was played */
    WALK_STALLED = 4         /* no further step for walk_watch_limit_s() */
};

struct walk_watch {
    uint32_t steps; /* asked for; UINT32_MAX = to the recording's end */
    bool is_recording;
    uint32_t seen;
    uint64_t step_tick; /* of the last one seen */
};

void walk_watch_init(struct walk_watch *watch, uint32_t steps, bool is_recording);

/* Once a tick, behind walk_record_take(). A recorded person may stand still for as long as they like. */
enum walk_end walk_watch_tick(struct walk_watch *watch, const struct walk_record *record,
                              const struct loop *loop);

/* How long the next step may take, seconds: the first one longer. */
int walk_watch_limit_s(const struct walk_watch *watch);

#endif
