#include "sim_host/log/black_box_log.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/storage/black_box_reader.h"
#include "sim_host/log/candump_log.h"
#include "sim_host/log/replay.h"
#include "sim_host/log/sdo_upload.h"

enum {
    OBJECT_IDENTITY = 0x2030,
    OBJECT_CRASH = 0x2032,
    OBJECT_BLACK_BOX = 0x2040,
    SUB_STATE = 1,
    SUB_IMAGE = 3
};

/* ---- image to log ------------------------------------------------------------- */

struct writer {
    FILE *log;
    const char *interface;
    uint64_t time_us;
    bool good;
};

static void put(struct writer *writer, const struct can_msg *message)
{
    writer->good =
        candump_write(writer->log, writer->time_us, writer->interface, message) && writer->good;
}

static void put_note(struct writer *writer, uint32_t id, const uint8_t *bytes, size_t length)
{
    struct can_msg message = {.id = id, .flags = CAN_FRAME_EXTENDED};

    while (message.length < CAN_FRAME_DATA_MAX && message.length < length) {
        message.data[message.length] = bytes[message.length];
        message.length++;
    }
    put(writer, &message);
}

static void put_words(struct writer *writer, uint32_t id, uint32_t first, uint32_t second)
{
    uint8_t bytes[8];

    bytes_put_u32(bytes, first);
    bytes_put_u32(bytes + 4, second);
    put_note(writer, id, bytes, sizeof bytes);
}

static void put_snapshot(struct writer *writer, const struct black_box_reader *reader)
{
    put_words(writer, BLACK_BOX_ID_BEGIN, reader->tick, reader->snapshot_bytes);
    for (uint32_t at = 0; at < reader->snapshot_bytes; at += 8) {
        put_note(writer, BLACK_BOX_ID_DATA + at / 8, reader->snapshot + at,
                 reader->snapshot_bytes - at);
    }
}

static void put_frame(struct writer *writer, const struct black_box_reader *reader)
{
    struct can_msg message = reader->message;

    /* The order is kept, times inside a tick are not: a microsecond each. */
    const uint64_t tick_us = (uint64_t)reader->tick * TICK_PERIOD_US;
    writer->time_us = writer->time_us < tick_us ? tick_us : writer->time_us + 1;
    if (message.flags == 0 && replay_is_controllers(NULL, message.id)) {
        put_note(writer, BLACK_BOX_ID_FOREIGN, NULL, 0);
    }
    message.flags &= (uint8_t)~CAN_FRAME_OWN;
    put(writer, &message);
}

static void describe(const struct black_box *box, struct black_box_summary *summary)
{
    const struct black_box_header *header = &box->header;

    memset(summary, 0, sizeof *summary);
    summary->state = header->state;
    summary->reason = header->reason;
    summary->trigger_tick = header->trigger_tick;
    summary->build_id = header->build_id;
    summary->parameter_crc = header->parameter_crc;
    summary->lost_frames = header->lost_frames;
}

bool black_box_log_identify(FILE *log, const char *interface, uint32_t build_id,
                            uint32_t parameter_crc, const char *version)
{
    struct writer writer = {log, interface, 0, true};
    const size_t length = strlen(version);

    put_words(&writer, BLACK_BOX_ID_IDENTITY, build_id, parameter_crc);
    for (size_t at = 0; at < length && at < BLACK_BOX_VERSION_MAX; at += 8) {
        put_note(&writer, BLACK_BOX_ID_VERSION + (uint32_t)(at / 8), (const uint8_t *)version + at,
                 length - at);
    }
    return writer.good;
}

int black_box_log_write(const struct black_box *box, const char *version, const char *interface,
                        FILE *log, struct black_box_summary *summary)
{
    struct black_box_reader reader;
    struct writer writer = {log, interface, 0, true};
    enum black_box_item item;
    bool gap = true;

    describe(box, summary);
    summary->blocks = black_box_reader_open(&reader, box);
    if (summary->blocks == 0) {
        return -1;
    }
    writer.good =
        black_box_log_identify(log, interface, summary->build_id, summary->parameter_crc, version);
    while ((item = black_box_reader_next(&reader)) != BLACK_BOX_END) {
        if (item == BLACK_BOX_DAMAGED) {
            summary->damaged++;
            gap = true;
        } else if (item == BLACK_BOX_FRAME) {
            put_frame(&writer, &reader);
            summary->frames++;
        } else if (gap || reader.tick != summary->last_tick) {
            if (summary->snapshots++ == 0) {
                summary->first_tick = reader.tick;
            }
            put_snapshot(&writer, &reader);
            gap = false;
        }
        summary->last_tick = reader.tick;
    }
    return writer.good ? 0 : -1;
}

/* ---- over the bus ---------------------------------------------------------------- */

static int explain(const struct sdo_upload *upload, enum sdo_upload_result result, const char *what,
                   char *message, size_t size)
{
    if (result == SDO_UPLOAD_DONE) {
        return 0;
    }
    if (result == SDO_UPLOAD_ABORTED) {
        snprintf(message, size, "node %d refuses %s: abort code 0x%08X%s", NODE_CONTROLLER, what,
                 (unsigned)upload->abort_code,
                 upload->abort_code == 0x08000022u ? " (not in its present state)" : "");
    } else if (result == SDO_UPLOAD_DISTURBED) {
        snprintf(message, size,
                 "another SDO client spoke with node %d in the middle of %s: stop it and try again",
                 NODE_CONTROLLER, what);
    } else if (result == SDO_UPLOAD_TOO_LARGE) {
        snprintf(message, size, "node %d has more to say than this program has room for: %s",
                 NODE_CONTROLLER, what);
    } else {
        snprintf(message, size, "node %d does not answer to %s", NODE_CONTROLLER, what);
    }
    return -1;
}

int black_box_fetch(const struct can_bus *bus, bool (*wait)(void *context, unsigned waits),
                    void *context, bool freeze, struct black_box *box,
                    char version[BLACK_BOX_VERSION_MAX + 1], char *message, size_t size)
{
    struct sdo_upload upload = {
        .bus = bus, .node = NODE_CONTROLLER, .wait = wait, .context = context};
    size_t length;

    memset(version, 0, BLACK_BOX_VERSION_MAX + 1);
    if (explain(&upload,
                sdo_upload(&upload, OBJECT_IDENTITY, 1, (uint8_t *)version, BLACK_BOX_VERSION_MAX,
                           &length),
                "reading its version", message, size) != 0) {
        return -1;
    }
    if (freeze &&
        explain(&upload, sdo_write(&upload, OBJECT_BLACK_BOX, SUB_STATE, BLACK_BOX_FROZEN, 1),
                "freezing its black box", message, size) != 0) {
        return -1;
    }
    if (explain(
            &upload,
            sdo_upload(&upload, OBJECT_BLACK_BOX, SUB_IMAGE, (uint8_t *)box, sizeof *box, &length),
            "reading its black box, which it gives only frozen", message, size) != 0) {
        return -1;
    }
    if (length != sizeof *box) {
        snprintf(message, size, "the black box has %zu bytes instead of %zu", length, sizeof *box);
        return -1;
    }
    return 0;
}

int black_box_fetch_crash(const struct can_bus *bus, bool (*wait)(void *context, unsigned waits),
                          void *context, struct crash_record *record, char *message, size_t size)
{
    struct sdo_upload upload = {
        .bus = bus, .node = NODE_CONTROLLER, .wait = wait, .context = context};
    uint8_t cause;
    size_t length;

    memset(record, 0, sizeof *record);
    if (explain(&upload, sdo_upload(&upload, OBJECT_CRASH, 1, &cause, sizeof cause, &length),
                "saying how it crashed", message, size) != 0) {
        return -1;
    }
    if (cause == CRASH_NONE) {
        return 0;
    }
    if (explain(&upload,
                sdo_upload(&upload, OBJECT_CRASH, 2, (uint8_t *)record, sizeof *record, &length),
                "reading its crash record", message, size) != 0) {
        return -1;
    }
    if (!crash_record_is_valid(record)) {
        snprintf(message, size, "the crash record is damaged");
        return -1;
    }
    return 0;
}

int black_box_release(const struct can_bus *bus, bool (*wait)(void *context, unsigned waits),
                      void *context, char *message, size_t size)
{
    struct sdo_upload upload = {
        .bus = bus, .node = NODE_CONTROLLER, .wait = wait, .context = context};

    if (explain(&upload, sdo_write(&upload, OBJECT_BLACK_BOX, SUB_STATE, BLACK_BOX_RECORDING, 1),
                "recording anew", message, size) != 0) {
        return -1;
    }
    const enum sdo_upload_result seen = sdo_write(&upload, OBJECT_CRASH, 1, CRASH_NONE, 1);
    /* A controller on Linux leaves no crash records, and says so. */
    return seen == SDO_UPLOAD_ABORTED ? 0 : explain(&upload, seen, "the crash seen", message, size);
}
