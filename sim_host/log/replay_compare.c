/* What the log has of the controller beside what the control task made: and what is left over
 * in the log, which another node may have sent with an identifier of the controller. */
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/log/replay_internal.h"

struct replay_queue *replay_queue_of(struct replay *replay, uint32_t id)
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

/* ---- differences ------------------------------------------------------------ */

static void print_data(char *text, size_t size, const struct can_msg *message)
{
    size_t used = 0;
    text[0] = '\0';
    for (unsigned i = 0; i < message->length && used + 3 < size; i++) {
        used += (size_t)snprintf(text + used, size - used, "%02X", message->data[i]);
    }
}

static void describe(const struct replay *replay, char *text, const struct replay_frame *frame,
                     const struct can_msg *sent)
{
    char logged[20];
    char made[20];
    unsigned byte = 0;
    print_data(logged, sizeof logged, &frame->message);
    if (sent == NULL) {
        snprintf(text, REPLAY_MESSAGE_MAX,
                 "line %lu, tick %llu: the log has %03X#%s, the control task sent no such frame",
                 frame->line, (unsigned long long)replay->ticks, frame->message.id, logged);
        return;
    }
    print_data(made, sizeof made, sent);
    while (byte < frame->message.length && byte < sent->length &&
           frame->message.data[byte] == sent->data[byte]) {
        byte++;
    }
    snprintf(text, REPLAY_MESSAGE_MAX,
             "line %lu, tick %llu: frame %03X differs in byte %u (%s): log %s, control task %s",
             frame->line, (unsigned long long)replay->ticks, frame->message.id, byte,
             replay_field_name(frame->message.id, byte), logged, made);
}

/* Not what the control task made. If another node sent it, the control task's own frame is in
 * the log as well, and the digest that it tells next holds this one, if it is one that a
 * controller hears. Until then it is a difference, and the first one is the message. */
static void suspect(struct replay *replay, struct replay_frame *frame, const struct can_msg *sent)
{
    if (replay->suspects == 0) {
        describe(replay, replay->message, frame, sent);
        replay->suspected_tick = replay->ticks;
    }
    replay->differs = replay->fresh;
    replay->suspects++;
    frame->foreign = frame_is_masters(frame->message.id) ||
                     frame_is_node_request(frame->message.id); /* the others pass no filter */
    if (!frame->foreign && replay->unheard_frames++ == 0) {
        describe(replay, replay->unheard_message, frame, sent);
    }
}

static void clear_of_suspicion(struct replay *replay, uint64_t told_tick)
{
    if (replay->suspects > 0 && told_tick > replay->suspected_tick) {
        replay->foreign_frames += replay->suspects;
        replay->suspects = 0;
        replay->message[0] = '\0';
    }
}

void replay_end_suspicion(struct replay *replay)
{
    const size_t used = strlen(replay->message);
    if (replay->suspects > 0 && !replay->differs) {
        replay->differs = true;
        snprintf(replay->message + used, sizeof replay->message - used,
                 " (if it was another node's: the log ends before the controller tells)");
    }
}

/* ---- frame by frame ---------------------------------------------------------- */

/* Bit s: 0x2020:s counts what happened between the controller and its port, or its clock:
 * no frame of the log tells of it. (Refused SYNCs, commands and frames, error frames, missed
 * ticks, frames lost on receive, times bus-off.) */
enum { COUNTERS = 0x2020, PORTS_COUNTERS = 0x1D1C, IDENTITY = 0x2030, BUILD = 2, PARAMETERS = 3 };

static bool is_expedited_answer(const struct can_msg *message, uint16_t index)
{
    return message->id == FRAME_SDO_ANSWER_CONTROLLER && message->length == 8 &&
           message->data[0] == 0x43 && bytes_get_u16(message->data + 1) == index;
}

/* Whose value is not the control task's to make: of its port, and which build recorded. */
static bool is_another_matter(const struct can_msg *message)
{
    const uint8_t sub = message->data[3];
    return (is_expedited_answer(message, COUNTERS) && sub < 16 &&
            (PORTS_COUNTERS >> sub & 1) != 0) ||
           (is_expedited_answer(message, IDENTITY) && sub == BUILD);
}

static void keep_identity(struct replay *replay, const struct can_msg *message)
{
    if (is_expedited_answer(message, IDENTITY) && message->data[3] == BUILD) {
        replay->build_id = bytes_get_u32(message->data + 4);
    } else if (is_expedited_answer(message, IDENTITY) && message->data[3] == PARAMETERS) {
        replay->parameter_crc = bytes_get_u32(message->data + 4);
    }
}

void replay_compare(struct replay *replay, struct replay_frame *frame)
{
    if (frame->foreign) {
        return; /* by the word of a black box */
    }
    struct replay_queue *queue = replay_queue_of(replay, frame->message.id);
    if (queue == NULL || queue->count == 0) {
        suspect(replay, frame, NULL);
        return;
    }
    const struct can_msg *sent = &queue->sent[queue->head];
    const unsigned bytes = is_another_matter(sent) ? 4 : sent->length;
    if (sent->length != frame->message.length ||
        memcmp(sent->data, frame->message.data, bytes) != 0) {
        suspect(replay, frame, sent);
        return;
    }
    if (sent->id == FRAME_CONTROLLER_STATE) {
        clear_of_suspicion(replay, queue->tick[queue->head]);
        replay_gaps_agreed(replay, queue->tick[queue->head]);
        replay->digest_tick = replay->all_ticks;
    }
    keep_identity(replay, &frame->message);
    queue->head = (queue->head + 1) % REPLAY_QUEUE;
    queue->count--;
    replay->compared++;
}

/* Where one of many equal frames is not in the log, the next one is taken for it: the queue never
 * empties again. Notes what was not seen when that began. */
static bool is_missing(struct replay_queue *queue, uint64_t ticks)
{
    if (queue->count == 0) {
        queue->behind_ticks = 0;
        return false;
    }
    if (queue->behind_ticks++ == 0) {
        queue->first_unseen = queue->sent[queue->head];
        queue->unseen_tick = queue->tick[queue->head];
    }
    return queue->behind_ticks > REPLAY_BEHIND_TICKS || queue->tick[queue->head] + 2 < ticks;
}

void replay_check_missing(struct replay *replay)
{
    for (unsigned i = 0; i < replay->queue_count && !replay->differs; i++) {
        struct replay_queue *queue = &replay->queue[i];
        if (!is_missing(queue, replay->ticks)) {
            continue;
        }
        replay->differs = true;
        if (replay->suspects == 0) {
            char made[20];
            print_data(made, sizeof made, &queue->first_unseen);
            snprintf(replay->message, sizeof replay->message,
                     "tick %llu: the control task sent %03X#%s, the log has no such frame%s",
                     (unsigned long long)queue->unseen_tick, queue->id, made,
                     queue->id == FRAME_DRIVE_TARGETS
                         ? " (or the SYNC before was another node's: in a log of a bus they "
                           "are alike, a black box tells them apart)"
                         : "");
        }
    }
}
