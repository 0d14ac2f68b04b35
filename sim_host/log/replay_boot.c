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

/* The SYNCs so far: where the last one ended, and where the one behind the last pause began. */
struct syncs {
    struct place last, run;
    uint64_t time_us, count, run_count; /* run_count: of count, at run */
};

static void take_sync(struct syncs *syncs, const struct place *place, uint64_t time_us)
{
    const bool is_pause =
        time_us < syncs->time_us || time_us - syncs->time_us > PAUSE_US || syncs->count == 0;
    if (is_pause) {
        syncs->run = syncs->last;
        syncs->run_count = syncs->count;
    }
    syncs->last = *place;
    syncs->time_us = time_us;
    syncs->count++;
}

/* The boot-up's own cycle, or the pause shortly before it. */
static bool go_to(FILE *log, const struct syncs *syncs, unsigned long *line)
{
    const bool is_near = syncs->count - syncs->run_count <= REPLAY_LATE_BOOT_TICKS;
    const struct place *place = is_near ? &syncs->run : &syncs->last;
    *line = place->line;
    return fseek(log, place->at, SEEK_SET) == 0;
}

bool replay_seek_boot(struct replay *replay, FILE *log, unsigned long *line)
{
    struct syncs syncs = {{ftell(log), 0}, {ftell(log), 0}, 0, 0, 0};
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
    if (place.at < 0 || (found && !go_to(log, &syncs, line))) {
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
