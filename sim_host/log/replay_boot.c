/* Where a run begins in a log that may begin in the middle of an earlier one. */
#include <stdio.h>

#include "hal/bus/frame_table.h"
#include "sim_host/log/replay_internal.h"

/* Nobody is switched off and on within so few periods. */
enum { PAUSE_US = 5000 };

bool replay_is_boot(const struct can_msg *message)
{
    return message->id == FRAME_HEARTBEAT_CONTROLLER && message->length == 1 &&
           message->data[0] == 0;
}

struct place {
    long at;
    unsigned long line;
};

/* The newest SYNCs: where the cycle before each one began, and how long it was. */
struct syncs {
    struct place last; /* behind the newest one */
    uint64_t time_us, count;
    struct place before[REPLAY_LATE_BOOT_TICKS];
    uint64_t period_us[REPLAY_LATE_BOOT_TICKS];
};

static void take_sync(struct syncs *syncs, const struct place *place, uint64_t time_us)
{
    const uint64_t at = syncs->count % REPLAY_LATE_BOOT_TICKS;
    const bool is_first = syncs->count == 0 || time_us < syncs->time_us;
    syncs->before[at] = syncs->last;
    syncs->period_us[at] = is_first ? UINT64_MAX : time_us - syncs->time_us;
    syncs->last = *place;
    syncs->time_us = time_us;
    syncs->count++;
}

/* The longest pause shortly before the boot-up; its own cycle where that is the one right before it, or there is none. */
static bool go_to(FILE *log, const struct syncs *syncs, uint64_t boot_us, unsigned long *line)
{
    const struct place *place = &syncs->last;
    const uint64_t before_us = boot_us > syncs->time_us ? boot_us - syncs->time_us : 0;
    uint64_t longest_us = before_us > PAUSE_US ? before_us : PAUSE_US;
    for (uint64_t i = 0; i < REPLAY_LATE_BOOT_TICKS && i < syncs->count; i++) {
        if (syncs->period_us[i] > longest_us) {
            longest_us = syncs->period_us[i];
            place = &syncs->before[i];
        }
    }
    *line = place->line;
    return fseek(log, place->at, SEEK_SET) == 0;
}

bool replay_seek_boot(struct replay *replay, FILE *log, unsigned long *line)
{
    struct syncs syncs = {.last = {ftell(log), 0}};
    struct candump_record record;
    struct candump_error error;
    struct place place = syncs.last;
    bool found = false;
    while (place.at >= 0 && !found &&
           candump_read(log, &place.line, &record, &error) == CANDUMP_RECORD) {
        place.at = ftell(log);
        if (record.message.flags != 0 || !replay_is_on_interface(replay, &record)) {
            continue;
        }
        if (record.message.id == FRAME_SYNC) {
            take_sync(&syncs, &place, record.time_us);
        }
        found = replay_is_boot(&record.message);
    }
    if (place.at < 0 || (found && !go_to(log, &syncs, record.time_us, line))) {
        (void)snprintf(replay->message, sizeof replay->message,
                       "a pipe is read only once: --from-boot needs a file");
        return false;
    }
    if (!found) {
        (void)snprintf(replay->message, sizeof replay->message,
                       "the log holds no boot-up of the controller (710#00)");
    }
    return found;
}
