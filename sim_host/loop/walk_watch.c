#include "sim_host/loop/walk_watch.h"
#include "model/tick.h"

/* Behind the last apex the controller's record of it is still to come. */
enum {
    RECORD_DELAY_TICKS = TICKS_OF_MS(150),
    FIRST_STEP_TICKS = TICKS_OF_MS(20000),
    STEP_TICKS = TICKS_OF_MS(10000),
    TICKS_PER_S = TICKS_OF_MS(1000)
};

void walk_watch_init(struct walk_watch *watch, uint32_t steps, bool is_recording)
{
    *watch = (struct walk_watch){.steps = steps, .is_recording = is_recording};
}

static uint64_t limit_ticks(const struct walk_watch *watch)
{
    return watch->seen == 0 ? FIRST_STEP_TICKS : STEP_TICKS;
}

int walk_watch_limit_s(const struct walk_watch *watch)
{
    return (int)(limit_ticks(watch) / TICKS_PER_S);
}

enum walk_end walk_watch_tick(struct walk_watch *watch, const struct walk_record *record,
                              const struct loop *loop)
{
    if (record->count != watch->seen) {
        watch->seen = record->count;
        watch->step_tick = loop->tick;
    }
    const uint64_t since = loop->tick - watch->step_tick;
    if (plant_fault(&loop->nodes.plant) != WALK_FAULT_NONE) {
        return WALK_FELL;
    }
    if (watch->seen >= watch->steps &&
        (record->rows[watch->steps - 1].measured || since > RECORD_DELAY_TICKS)) {
        return WALK_DONE;
    }
    if (watch->is_recording) {
        struct plant_truth truth;
        plant_truth(&loop->nodes.plant, &truth);
        return truth.finished ? WALK_RECORDING_OVER : WALK_GOES_ON;
    }
    return since > limit_ticks(watch) ? WALK_STALLED : WALK_GOES_ON;
}
