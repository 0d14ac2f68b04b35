#include "sim_host/loop/frame_stream.h"

#include <assert.h>
#include <errno.h>
#include <string.h>
#include <sys/socket.h>

#include "firmware/snapshot.h"
#include "firmware/version.h"
#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "sim_host/log/black_box_log.h"

static_assert(sizeof(struct frame_record) == 24, "a record is 24 bytes on the socket");

#define RING_BYTES ((uint64_t)FRAME_STREAM_RECORDS * sizeof(struct frame_record))
#define ID_EXTENDED (UINT32_C(1) << 31)
#define ID_REMOTE (UINT32_C(1) << 30)
/* Requests are few; nobody may keep the walk busy with them. */
enum { REQUESTS_AT_ONCE = 32 };

/* ---- out --------------------------------------------------------------------- */

static bool put(struct frame_stream *stream, const struct frame_record *record)
{
    const uint64_t used = stream->head - stream->tail;
    if (stream->fd < 0 || stream->is_gone) {
        return true;
    }
    if (RING_BYTES - used < sizeof *record) {
        return false;
    }
    stream->ring[stream->head % RING_BYTES / sizeof *record] = *record;
    stream->head += sizeof *record;
    return true;
}

static void put_note(struct frame_stream *stream, uint32_t id, uint32_t first, uint32_t second)
{
    struct frame_record record = {
        .time_us = sim_bus_now_ns(&stream->loop->bus) / 1000u, .id = id, .length = 8};
    bytes_put_u32(record.data, first);
    bytes_put_u32(record.data + 4, second);
    (void)put(stream, &record);
}

static void put_frame(struct frame_stream *stream, const struct sim_bus_event *event)
{
    struct frame_record record = {.time_us = event->time_ns / 1000u,
                                  .id = event->message.id,
                                  .length = event->message.length};
    record.id |= (event->message.flags & CAN_FRAME_EXTENDED) != 0 ? ID_EXTENDED : 0;
    record.id |= (event->message.flags & CAN_FRAME_REMOTE) != 0 ? ID_REMOTE : 0;
    memcpy(record.data, event->message.data, sizeof record.data);
    if (stream->lost > 0) {
        const struct frame_record lost = {
            .time_us = record.time_us, .id = FRAME_STREAM_LOST, .length = 4};
        const uint64_t room = RING_BYTES - (stream->head - stream->tail);
        if (room < 2 * sizeof record) {
            stream->lost++;
            return;
        }
        struct frame_record note = lost;
        bytes_put_u32(note.data, stream->lost);
        stream->lost = 0;
        (void)put(stream, &note);
    }
    stream->lost += put(stream, &record) ? 0 : 1;
}

static void tap(void *context, const struct sim_bus_event *event)
{
    struct frame_stream *stream = (struct frame_stream *)context;
    if (stream->next_tap != NULL) {
        stream->next_tap(stream->next_context, event);
    }
    if (event->kind == SIM_BUS_FRAME) {
        put_frame(stream, event);
    }
}

static void send_waiting(struct frame_stream *stream)
{
    while (stream->head != stream->tail) {
        const uint64_t at = stream->tail % RING_BYTES;
        const uint64_t waiting = stream->head - stream->tail;
        const uint64_t whole = RING_BYTES - at < waiting ? RING_BYTES - at : waiting;
        const ssize_t sent = send(stream->fd, (const uint8_t *)stream->ring + at, (size_t)whole,
                                  MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent > 0) {
            stream->tail += (uint64_t)sent;
        } else if (errno != EINTR) {
            stream->is_gone = errno != EAGAIN && errno != EWOULDBLOCK;
            return;
        }
    }
}

/* ---- a snapshot ---------------------------------------------------------------- */

static bool is_at_rest(const struct loop *loop)
{
    return loop->bus.pending == 0 && loop->bus.phase != SIM_BUS_TRANSMIT &&
           !loop->rig.task.audit.under_way;
}

/* The task's state, and who it is: what a log needs to begin in the middle of a walk. */
static void put_snapshot(struct frame_stream *stream)
{
    uint8_t *bytes = stream->snapshot;
    struct host_task *rig = &stream->loop->rig;
    const struct snapshot_source source = {&rig->task, &rig->drives};
    const size_t size = snapshot_save(&source, bytes, sizeof stream->snapshot);
    put_note(stream, ID_EXTENDED | BLACK_BOX_ID_IDENTITY, version_build_id(),
             rig->task.node.objects.params_crc);
    put_note(stream, ID_EXTENDED | BLACK_BOX_ID_BEGIN, rig->task.tick, (uint32_t)size);
    for (size_t at = 0; at < size; at += CAN_FRAME_DATA_MAX) {
        struct frame_record record = {.time_us = sim_bus_now_ns(&stream->loop->bus) / 1000u};
        record.id = ID_EXTENDED | (BLACK_BOX_ID_DATA + (uint32_t)(at / CAN_FRAME_DATA_MAX));
        record.length = (uint8_t)(size - at < CAN_FRAME_DATA_MAX ? size - at : CAN_FRAME_DATA_MAX);
        memcpy(record.data, bytes + at, record.length);
        (void)put(stream, &record);
    }
}

/* ---- in -------------------------------------------------------------------------- */

/* CiA 301, client's command specifiers in bits 5 to 7: to read an object, or to give it up. */
enum { SDO_READ = 2, SDO_READ_SEGMENT = 3, SDO_ABORT = 4 };

static bool may_be_sent(const struct frame_record *record)
{
    const unsigned node = record->id - CO_COB_SDO_REQUEST, specifier = record->data[0] >> 5;
    if (record->length != CAN_FRAME_DATA_MAX || record->id <= CO_COB_SDO_REQUEST ||
        node > CO_NODE_MAX) {
        return false;
    }
    return record->id == FRAME_SDO_REQUEST_CONTROLLER || specifier == SDO_READ ||
           specifier == SDO_READ_SEGMENT || specifier == SDO_ABORT;
}

static void obey(struct frame_stream *stream, const struct frame_record *record)
{
    if (record->id == FRAME_STREAM_SNAPSHOT) {
        stream->wants_snapshot = true;
    } else if (record->id == FRAME_STREAM_RESTART) {
        stream->wants_restart = true;
    } else if (may_be_sent(record)) {
        const struct can_bus bus = sim_bus_port(&stream->loop->bus, stream->port);
        struct can_msg message = {.id = record->id, .length = record->length};
        memcpy(message.data, record->data, sizeof message.data);
        stream->refused += can_bus_send(&bus, &message) == CAN_OK ? 0 : 1;
    } else {
        stream->refused++;
    }
}

static void receive(struct frame_stream *stream)
{
    for (int i = 0; i < REQUESTS_AT_ONCE; i++) {
        uint8_t *part = (uint8_t *)&stream->part;
        const ssize_t got = recv(stream->fd, part + stream->part_bytes,
                                 sizeof stream->part - stream->part_bytes, MSG_DONTWAIT);
        if (got <= 0) {
            stream->is_gone =
                got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
            return;
        }
        stream->part_bytes += (unsigned)got;
        if (stream->part_bytes == sizeof stream->part) {
            stream->part_bytes = 0;
            obey(stream, &stream->part);
        }
    }
}

/* ---- the whole --------------------------------------------------------------------- */

/* The stream hears by the tap; what its port receives is not needed. */
static void drain(void *context, uint64_t now_ns)
{
    struct frame_stream *stream = (struct frame_stream *)context;
    const struct can_bus bus = sim_bus_port(&stream->loop->bus, stream->port);
    struct can_msg message;
    (void)now_ns;
    while (can_bus_receive(&bus, &message, NULL) == CAN_OK) {
    }
}

void frame_stream_init(struct frame_stream *stream, int fd)
{
    memset(stream, 0, sizeof *stream);
    stream->fd = fd;
    stream->port = -1;
}

bool frame_stream_attach(struct frame_stream *stream, struct loop *loop)
{
    stream->loop = loop;
    stream->next_tap = loop->bus.tap;
    stream->next_context = loop->bus.tap_context;
    stream->wants_restart = stream->wants_snapshot = false;
    stream->port = sim_bus_attach(&loop->bus, "view", drain, stream);
    if (stream->port < 0) {
        return false;
    }
    sim_bus_set_tap(&loop->bus, tap, stream);
    put_note(stream, FRAME_STREAM_BEGIN, version_build_id(),
             loop->rig.task.node.objects.params_crc);
    return true;
}

void frame_stream_serve(struct frame_stream *stream)
{
    if (stream->fd < 0 || stream->is_gone) {
        return;
    }
    receive(stream);
    if (stream->wants_snapshot && is_at_rest(stream->loop)) {
        stream->wants_snapshot = false;
        put_snapshot(stream);
    }
    send_waiting(stream);
}
