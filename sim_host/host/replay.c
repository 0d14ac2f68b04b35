#include "sim_host/host/replay.h"

#include <string.h>

#include "firmware/snapshot.h"
#include "hal/bytes.h"
#include "hal/frame_table.h"
#include "sim_host/host/black_box_log.h"

/* ---- whose frame is it ----------------------------------------------------- */

#define SENDER(name, id, bytes, period_us, deadline_us, node, kind) {id, node},
static const struct {
    uint32_t id;
    uint8_t sender;
} senders[] = {FRAME_TABLE(SENDER)};
#undef SENDER

static bool is_controllers(uint32_t id)
{
    for (size_t i = 0; i < sizeof senders / sizeof senders[0]; i++) {
        if (senders[i].id == id) {
            return senders[i].sender == NODE_CONTROLLER;
        }
    }
    return false;
}

const char *replay_field_name(uint32_t id, unsigned byte)
{
    switch (id) {
    case FRAME_DRIVE_TARGETS:
        return byte < 4 ? "target position left" : "target position right";
    case FRAME_DRIVE_COMMAND_LEFT:
    case FRAME_DRIVE_COMMAND_RIGHT:
        return byte < 2 ? "controlword" : "digital outputs (latch)";
    case FRAME_TELEMETRY:
        return byte < 2   ? "measured speed"
               : byte < 4 ? "commanded speed"
               : byte < 6 ? "precompression"
               : byte < 7 ? "step number"
                          : "side and fault";
    case FRAME_CONTROLLER_STATE:
        return byte < 1   ? "supervisor state"
               : byte < 2 ? "latched fault"
                          : "digest of the input: a frame within the last 100 ticks was changed, "
                            "lost or added";
    case FRAME_NMT:
        return byte < 1 ? "NMT command" : "NMT node";
    case FRAME_HEARTBEAT_CONTROLLER:
        return "heartbeat";
    default:
        return "data";
    }
}

/* ---- the bus the task sees ------------------------------------------------- */

static struct replay_queue *queue_of(struct replay *replay, uint32_t id)
{
    for (unsigned i = 0; i < replay->queue_count; i++) {
        if (replay->queue[i].id == id) {
            return &replay->queue[i];
        }
    }
    if (replay->queue_count == REPLAY_IDS) {
        return NULL;
    }
    struct replay_queue *queue = &replay->queue[replay->queue_count++];
    queue->id = id;
    queue->head = queue->count = 0;
    return queue;
}

static enum can_result take_sent(void *context, const struct can_msg *message)
{
    struct replay *replay = (struct replay *)context;
    struct replay_queue *queue = queue_of(replay, message->id);
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
        if (!is_controllers(frame->message.id)) {
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

int replay_init(struct replay *replay, const struct subject *subject,
                const struct control_params *params, double desired_speed_rad_s)
{
    memset(replay, 0, sizeof *replay);
    const struct can_bus bus = {&replay_bus_ops, replay};
    return task_rig_init(&replay->rig, subject, params, bus, desired_speed_rad_s, true) ==
                   CONTROL_PARAMS_OK
               ? 0
               : -1;
}

/* ---- comparing ------------------------------------------------------------- */

static void print_data(char *text, size_t size, const struct can_msg *message)
{
    size_t used = 0;
    text[0] = '\0';
    for (unsigned i = 0; i < message->length && used + 3 < size; i++) {
        used += (size_t)snprintf(text + used, size - used, "%02X", message->data[i]);
    }
}

static void differ(struct replay *replay, const struct replay_frame *frame,
                   const struct can_msg *sent)
{
    char logged[20];
    char made[20];
    unsigned byte = 0;
    replay->differs = true;
    print_data(logged, sizeof logged, &frame->message);
    if (sent == NULL) {
        snprintf(replay->message, sizeof replay->message,
                 "line %lu, tick %llu: the log has %03X#%s, the control task sent no such frame",
                 frame->line, (unsigned long long)replay->ticks, frame->message.id, logged);
        return;
    }
    print_data(made, sizeof made, sent);
    while (byte < frame->message.length && byte < sent->length &&
           frame->message.data[byte] == sent->data[byte]) {
        byte++;
    }
    snprintf(replay->message, sizeof replay->message,
             "line %lu, tick %llu: frame %03X differs in byte %u (%s): log %s, control task %s",
             frame->line, (unsigned long long)replay->ticks, frame->message.id, byte,
             replay_field_name(frame->message.id, byte), logged, made);
}

static void compare(struct replay *replay, const struct replay_frame *frame)
{
    struct replay_queue *queue = queue_of(replay, frame->message.id);
    if (queue == NULL || queue->count == 0) {
        differ(replay, frame, NULL);
        return;
    }
    const struct can_msg *sent = &queue->sent[queue->head];
    if (sent->length != frame->message.length ||
        memcmp(sent->data, frame->message.data, sent->length) != 0) {
        differ(replay, frame, sent);
        return;
    }
    queue->head = (queue->head + 1) % REPLAY_QUEUE;
    queue->count--;
    replay->compared++;
}

/* Frames the task sent some cycles ago must have been in the log by now. */
static void check_missing(struct replay *replay)
{
    for (unsigned i = 0; i < replay->queue_count && !replay->differs; i++) {
        const struct replay_queue *queue = &replay->queue[i];
        if (queue->count > 0 && queue->tick[queue->head] + 2 < replay->ticks) {
            char made[20];
            print_data(made, sizeof made, &queue->sent[queue->head]);
            snprintf(replay->message, sizeof replay->message,
                     "tick %llu: the control task sent %03X#%s, the log has no such frame",
                     (unsigned long long)queue->tick[queue->head], queue->id, made);
            replay->differs = true;
        }
    }
}

/* ---- cycle by cycle -------------------------------------------------------- */

/* The emergency stop as the task read it at the SYNC that began the cycle just read. */
static void read_back_stop(struct replay *replay)
{
    for (unsigned i = 0; i < replay->next_count; i++) {
        if (replay->next[i].message.id == FRAME_CONTROLLER_STATE) {
            replay->rig.stop_pressed = (replay->next[i].message.data[0] & 0x80u) != 0;
        }
    }
}

static void run_tick(struct replay *replay)
{
    read_back_stop(replay);
    replay->sync_pending = true;
    replay->next_fed = 0;
    replay->ticks++;
    do {
        (void)control_task_poll(&replay->rig.task);
    } while (replay->sync_pending || replay->next_fed < replay->cycle_count);
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
            compare(replay, &replay->cycle[i]);
        }
    }
    for (unsigned i = 0; i < replay->next_count && !replay->differs; i++) {
        if (is_controllers(replay->next[i].message.id) && !is_answer(replay->next[i].message.id)) {
            compare(replay, &replay->next[i]);
        }
    }
    memcpy(replay->cycle, replay->next, replay->next_count * sizeof replay->next[0]);
    replay->cycle_count = replay->next_count;
    replay->next_count = 0;
}

static bool keep(struct replay *replay, const struct candump_record *record, unsigned long line)
{
    if (replay->next_count == REPLAY_CYCLE_FRAMES) {
        snprintf(replay->message, sizeof replay->message,
                 "line %lu: more than %d frames without a SYNC", line, REPLAY_CYCLE_FRAMES);
        return false;
    }
    replay->next[replay->next_count++] =
        (struct replay_frame){record->message, line, record->time_us};
    return true;
}

/* ---- from the middle of a walk ---------------------------------------------- */

static void take_note(struct replay *replay, const struct can_msg *message)
{
    const uint32_t first = bytes_get_u32(message->data), second = bytes_get_u32(message->data + 4);
    if (message->id == BLACK_BOX_ID_IDENTITY) {
        replay->build_id = first;
        replay->parameter_crc = second;
    } else if (message->id == BLACK_BOX_ID_BEGIN) {
        replay->snapshot_tick = first;
        replay->snapshot_bytes = second <= sizeof replay->snapshot ? second : 0;
        memset(replay->snapshot, 0, sizeof replay->snapshot);
    } else if (message->id >= BLACK_BOX_ID_DATA &&
               (message->id - BLACK_BOX_ID_DATA) * 8u + message->length <= replay->snapshot_bytes) {
        memcpy(replay->snapshot + (message->id - BLACK_BOX_ID_DATA) * 8u, message->data,
               message->length);
    }
}

/* All that the log says of the time before goes; what was sent and not shown is in a gap. */
static bool go_on_from_snapshot(struct replay *replay, unsigned long line)
{
    const struct snapshot_source source = {&replay->rig.task, &replay->rig.cia402};
    struct control_task *task = &replay->rig.task;
    const uint32_t bytes = replay->snapshot_bytes;
    replay->snapshot_bytes = 0;
    if (snapshot_restore(&source, replay->snapshot, bytes) != 0) {
        snprintf(replay->message, sizeof replay->message,
                 "line %lu: a snapshot of %u bytes where this build's has %zu: recorded by build "
                 "%08x",
                 line, (unsigned)bytes, snapshot_size(), (unsigned)replay->build_id);
        return false;
    }
    if (controller_node_crc_of(&task->node.objects.params) != task->node.objects.params_crc) {
        snprintf(replay->message, sizeof replay->message,
                 "line %lu: the gait branch of this subject and law is not that of the recording "
                 "(parameter CRC %08x)",
                 line, (unsigned)task->node.objects.params_crc);
        return false;
    }
    replay->rig.stop_pressed = task->emergency_stop;
    replay->snapshots++;
    replay->cycle_count = replay->next_count = 0;
    replay->queue_count = 0;
    return true;
}

enum replay_verdict replay_run(struct replay *replay, FILE *log)
{
    struct candump_record record;
    struct candump_error error;
    unsigned long line = 0;
    bool started = false;
    enum candump_read_result result = CANDUMP_RECORD;

    while (!replay->differs &&
           (result = candump_read(log, &line, &record, &error)) == CANDUMP_RECORD) {
        if ((record.message.flags & CAN_FRAME_EXTENDED) != 0) {
            take_note(replay, &record.message);
            continue;
        }
        replay->frames++;
        if (record.message.flags != 0) {
            continue; /* remote and error frames command nothing */
        }
        if (replay->snapshot_bytes > 0) {
            started = false;
            if (!go_on_from_snapshot(replay, line)) {
                return REPLAY_BAD_LOG;
            }
        }
        if (record.message.id != FRAME_SYNC) {
            if (!keep(replay, &record, line)) {
                return REPLAY_BAD_LOG;
            }
            continue;
        }
        if (started) {
            run_tick(replay);
        }
        compare_cycle(replay);
        if (!replay->differs) {
            check_missing(replay);
        }
        started = true;
    }
    if (result == CANDUMP_BAD) {
        snprintf(replay->message, sizeof replay->message, "line %lu, column %u: %s", error.line,
                 error.column, error.reason);
        return REPLAY_BAD_LOG;
    }
    if (!started) {
        snprintf(replay->message, sizeof replay->message, "the log holds no SYNC (080#)");
        return REPLAY_NO_SYNC;
    }
    if (!replay->differs) { /* the last cycle may be cut short: what is there must be right */
        run_tick(replay);
        compare_cycle(replay);
    }
    return replay->differs ? REPLAY_DIFFERS : REPLAY_EQUAL;
}
