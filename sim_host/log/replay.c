#include "sim_host/log/replay.h"

#include <stdio.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/log/replay_internal.h"

/* ---- the bus the task sees ------------------------------------------------- */

static enum can_result take_sent(void *context, const struct can_msg *message)
{
    struct replay *replay = (struct replay *)context;
    struct replay_queue *queue = replay_queue_of(replay, message->id);
    if (queue == NULL || queue->count == REPLAY_QUEUE) {
        return CAN_FULL;
    }
    const unsigned at = (queue->head + queue->count++) % REPLAY_QUEUE;
    queue->sent[at] = *message;
    queue->tick[at] = replay->ticks;
    return CAN_OK;
}

/* First the frames of the cycle that ended, then the SYNC that ended it. */
static enum can_result hand_out(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct replay *replay = (struct replay *)context;
    while (replay->next_fed < replay->cycle_count) {
        const struct replay_frame *frame = &replay->cycle[replay->next_fed++];
        if (frame->foreign ||
            !replay_is_controllers(&replay->subject->device.description, frame->message.id)) {
            *message = frame->message;
            if (time_ns != NULL) {
                *time_ns = frame->time_us * 1000u;
            }
            return CAN_OK;
        }
    }
    if (!replay->sync_pending) {
        return CAN_EMPTY;
    }
    replay->sync_pending = false;
    *message = (struct can_msg){.id = FRAME_SYNC, .flags = CAN_FRAME_OWN};
    return CAN_OK;
}

static void no_status(void *context, struct can_bus_status *status)
{
    (void)context;
    memset(status, 0, sizeof *status);
}

static void no_recovery(void *context)
{
    (void)context;
}

static const struct can_bus_ops replay_bus_ops = {take_sent, hand_out, no_status, no_recovery};

/* A controller that has just been switched on. */
static int switch_on(struct replay *replay)
{
    const struct can_bus bus = {&replay_bus_ops, replay};
    replay->queue_count = 0;
    replay->ticks = 0;
    replay->next_fed = 0;
    replay->sync_pending = false;
    replay->fresh = true;
    const int result = host_task_init(&replay->rig, replay->subject, replay->params, bus,
                                      replay->desired_speed_rad_s, true);
    replay->own_parameter_crc = replay->rig.task.node.objects.params_crc;
    return result == CONTROL_PARAMS_OK ? 0 : -1;
}

int replay_init(struct replay *replay, const struct subject *subject,
                const struct control_params *params, double desired_speed_rad_s)
{
    memset(replay, 0, sizeof *replay);
    replay->subject = subject;
    replay->params = params;
    replay->desired_speed_rad_s = desired_speed_rad_s;
    return switch_on(replay);
}

bool replay_set_interface(struct replay *replay, const char *name)
{
    if (strlen(name) >= sizeof replay->interface) {
        return false;
    }
    (void)snprintf(replay->interface, sizeof replay->interface, "%s", name);
    return true;
}

/* ---- cycle by cycle -------------------------------------------------------- */

/* The emergency stop and the wearer's pin as the task read them at the SYNC that began the cycle just read. */
static void read_back_stop(struct replay *replay)
{
    for (unsigned i = 0; i < replay->next_count; i++) {
        if (replay->next[i].message.id == FRAME_CONTROLLER_STATE) {
            const uint8_t state = replay->next[i].message.data[0];
            replay->rig.stop_pressed = (state & 0x80u) != 0;
            replay->rig.task.node.objects.wearer_pin = (state & 0x40u) != 0;
        }
    }
}

static void tick(struct replay *replay)
{
    read_back_stop(replay);
    replay->sync_pending = true;
    replay->next_fed = 0;
    replay->ticks++;
    do {
        (void)control_task_poll(&replay->rig.task);
    } while (replay->sync_pending || replay->next_fed < replay->cycle_count);
}

/* Whether the digest that the log has for this tick is the task's. */
static bool digest_agrees(const struct replay *replay)
{
    for (unsigned i = 0; i < replay->next_count; i++) {
        const struct can_msg *message = &replay->next[i].message;
        if (message->id == FRAME_CONTROLLER_STATE &&
            message->length == FRAME_BYTES_CONTROLLER_STATE) {
            return bytes_get_u32(message->data + 2) == replay->rig.task.node.objects.input_digest;
        }
    }
    return true; /* not told: nothing to choose by */
}

/* The first tick of a run: of what lies before its SYNC the task had heard all, or nothing,
 * or the newest frames. If none agrees the last try stays, and is compared like any tick. */
static void first_tick(struct replay *replay)
{
    struct replay_frame *before = replay->before;
    const uint64_t compared = replay->compared;
    const unsigned count = replay->cycle_count;
    memcpy(before, replay->cycle, count * sizeof *before);
    for (unsigned heard = count, tries = 0; tries <= count; heard = tries++) {
        (void)switch_on(replay);
        replay->compared = compared;
        replay->suspects = 0;
        for (unsigned i = 0; i < count; i++) {
            if (replay_is_controllers(&replay->subject->device.description, before[i].message.id)) {
                replay_compare(replay, &before[i]);
            }
        }
        replay->cycle_count = heard;
        memcpy(replay->cycle, before + count - heard, heard * sizeof *before);
        tick(replay);
        if (replay->differs || digest_agrees(replay)) {
            break;
        }
    }
    replay->fresh = false;
}

static void run_tick(struct replay *replay)
{
    if (replay->fresh) {
        replay->runs++;
        first_tick(replay);
    } else {
        tick(replay);
    }
    replay->all_ticks++;
}

/* What the controller sends when asked, before the next SYNC. */
static bool is_answer(uint32_t id)
{
    return id == FRAME_SDO_ANSWER_CONTROLLER;
}

/* Compares what followed the SYNC, which then becomes the next tick's input. Answers to
 * requests of a cycle are made when that cycle is fed: compared one cycle later. */
static void compare_cycle(struct replay *replay)
{
    for (unsigned i = 0; i < replay->cycle_count && !replay->differs; i++) {
        if (is_answer(replay->cycle[i].message.id)) {
            replay_compare(replay, &replay->cycle[i]);
        }
    }
    for (unsigned i = 0; i < replay->next_count && !replay->differs; i++) {
        if (replay_is_controllers(&replay->subject->device.description,
                                  replay->next[i].message.id) &&
            !is_answer(replay->next[i].message.id)) {
            replay_compare(replay, &replay->next[i]);
        }
    }
    memcpy(replay->cycle, replay->next, replay->next_count * sizeof replay->next[0]);
    replay->cycle_count = replay->next_count;
    replay->next_count = 0;
}

/* What the controller's run ends with may be cut short: what is there must be right. Then
 * the others' frames lie before the next run. */
static void end_run(struct replay *replay)
{
    run_tick(replay);
    compare_cycle(replay);
    replay_end_suspicion(replay);
    for (unsigned i = 0; i < replay->cycle_count; i++) {
        if (replay->cycle[i].foreign || !replay_is_controllers(&replay->subject->device.description,
                                                               replay->cycle[i].message.id)) {
            replay->next[replay->next_count++] = replay->cycle[i];
        }
    }
    replay->cycle_count = 0;
    replay->running = false;
}

static void keep(struct replay *replay, const struct candump_record *record, unsigned long line)
{
    const bool foreign = replay->next_is_foreign;
    replay->next_is_foreign = false;
    replay->foreign_frames += foreign ? 1 : 0;
    if (replay_is_boot(&record->message) && !foreign) {
        if (replay->running && replay->ticks > REPLAY_LATE_BOOT_TICKS) {
            end_run(replay);
        }
        if (!replay->running && replay->runs > 0) {
            (void)switch_on(replay);
        }
        replay->boot_seen = true;
        replay->cut = false;
    }
    if (replay->running && replay->next_count == REPLAY_CYCLE_FRAMES) {
        end_run(replay);
        replay->cut = true; /* more than anybody says in a cycle: the controller is gone */
    }
    if (replay->next_count == REPLAY_CYCLE_FRAMES) { /* the oldest was not heard any more */
        memmove(replay->next, replay->next + 1, (REPLAY_CYCLE_FRAMES - 1) * sizeof replay->next[0]);
        replay->next_count--;
    }
    replay->next[replay->next_count++] =
        (struct replay_frame){record->message, line, record->time_us, foreign};
}

/* A SYNC ends a cycle. Returns false where none can be. */
static bool take_sync(struct replay *replay, const struct candump_record *record,
                      unsigned long line)
{
    replay_gaps_look(replay, line, record->time_us);
    if (replay->cut) {
        snprintf(replay->message, sizeof replay->message,
                 "line %lu: more than %d frames without a SYNC, and no boot-up before this one",
                 line, REPLAY_CYCLE_FRAMES);
        return false;
    }
    if (replay->running) {
        run_tick(replay);
    }
    compare_cycle(replay);
    if (!replay->differs) {
        replay_check_missing(replay);
    }
    replay->running = true;
    return true;
}

/* The task is not to blame for what it never heard. */
static void blame_the_recorder(struct replay *replay)
{
    char found[REPLAY_MESSAGE_MAX], why[REPLAY_MESSAGE_MAX];
    if (replay_gaps_explain(replay, why, sizeof why)) {
        memcpy(found, replay->message, sizeof found);
        snprintf(
            replay->message, sizeof replay->message,
            "%.220s (a larger receive buffer loses none: candump -r 268435456). Found by: %.200s",
            why, found);
    }
}

/* Says of a difference where it may come from. */
static void explain(struct replay *replay)
{
    blame_the_recorder(replay);
    size_t used = strlen(replay->message);
    if (replay->parameter_crc != 0 && replay->parameter_crc != replay->own_parameter_crc) {
        snprintf(replay->message + used, sizeof replay->message - used,
                 " (the log was recorded with other parameters, CRC %08x, here %08x: are person, "
                 "device and law those of the run?)",
                 replay->parameter_crc, replay->own_parameter_crc);
        used = strlen(replay->message);
    }
    if (!replay->boot_seen && replay->snapshots == 0 &&
        replay->all_ticks <= REPLAY_LATE_BOOT_TICKS) {
        snprintf(replay->message + used, sizeof replay->message - used,
                 " (no boot-up of the controller was recorded: does the log begin in the middle "
                 "of a run?)");
    }
}

/* One record of the log. Returns false when nothing can be made of it. */
static bool handle_record(struct replay *replay, const struct candump_record *record,
                          unsigned long line)
{
    if ((record->message.flags & CAN_FRAME_EXTENDED) != 0) {
        replay_take_note(replay, &record->message);
        return true;
    }
    replay->frames++;
    if (record->message.flags != 0) {
        return true; /* remote and error frames command nothing */
    }
    if (replay->snapshot_bytes > 0 && !replay_go_on_from_snapshot(replay, line)) {
        return false;
    }
    if (replay->from_boot) {
        replay->from_boot = record->message.id != FRAME_SYNC && !replay_is_boot(&record->message);
        if (replay->from_boot &&
            replay_is_controllers(&replay->subject->device.description, record->message.id)) {
            return true; /* the last words of the run before */
        }
    }
    if (record->message.id == FRAME_SYNC && !replay->next_is_foreign) {
        return take_sync(replay, record, line);
    }
    keep(replay, record, line);
    return true;
}

enum replay_verdict replay_run(struct replay *replay, FILE *log)
{
    struct candump_record record;
    struct candump_error error;
    unsigned long line = 0;
    enum candump_read_result result = CANDUMP_RECORD;

    if (!replay_choose_interface(replay, log) ||
        (replay->from_boot && !replay_seek_boot(replay, log, &line))) {
        return REPLAY_BAD_LOG;
    }
    while (!replay->differs &&
           (result = candump_read(log, &line, &record, &error)) == CANDUMP_RECORD) {
        if (replay_is_on_interface(replay, &record)) {
            if (!handle_record(replay, &record, line)) {
                return REPLAY_BAD_LOG;
            }
        } else if (replay->interfaces == 0) {
            snprintf(replay->message, sizeof replay->message,
                     "line %lu: a second interface, %s, in a log that can be read only once: name "
                     "one of them (--interface)",
                     line, record.interface_name);
            return REPLAY_BAD_LOG;
        }
    }
    if (result == CANDUMP_BAD) {
        snprintf(replay->message, sizeof replay->message, "line %lu, column %u: %s", error.line,
                 error.column, error.reason);
        return REPLAY_BAD_LOG;
    }
    if (!replay->running && replay->all_ticks == 0) {
        snprintf(replay->message, sizeof replay->message, "the log holds no SYNC (080#)");
        return REPLAY_NO_SYNC;
    }
    if (!replay->differs && replay->running) {
        end_run(replay);
    }
    if (replay->differs) {
        explain(replay);
    }
    return replay->differs ? REPLAY_DIFFERS : REPLAY_EQUAL;
}
