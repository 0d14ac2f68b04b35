/* Fuzzer: the black box. The first byte chooses: an image of any bytes, read to its end with its
 * guards repaired or not; or any frames, recorded and read back as they were. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/storage/black_box_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MODE_RECORD = 0x80, BAD_HEADER = 0x40, TIMES_SHIFT = 4, TIMES_MASK = 3 };
enum { FRAMES_MAX = 1024, RECORD_BYTES = 10, PASSES_MAX = 64 };

static struct black_box box;

/* ---- an image of any bytes -------------------------------------------------------- */

/* One block of the input: used (2 bytes), snapshot (2), sequence (1), what is broken (1), data. */
static size_t take_block(struct black_box_block *block, const uint8_t *data, size_t size)
{
    enum { HEAD = 6, DATA_MAX = 200 };
    if (size < HEAD) {
        return size;
    }
    const size_t length = size - HEAD < DATA_MAX ? size - HEAD : DATA_MAX;
    block->magic = BLACK_BOX_BLOCK_MAGIC;
    block->used = (uint32_t)data[0] | (uint32_t)data[1] << 8;
    block->used_inverted = ~block->used;
    block->snapshot_bytes = (uint32_t)data[2] | (uint32_t)data[3] << 8;
    block->sequence = data[4];
    block->first_tick = data[4] * 0x01010101u;
    block->check = black_box_block_check(block) ^ (data[5] & 1u);
    block->magic ^= data[5] & 2u;
    block->used_inverted ^= data[5] & 4u;
    /* The records begin where the snapshot ends; what the input has not, is one of its bytes. */
    memset(block->data, data[5], sizeof block->data);
    if (block->snapshot_bytes < sizeof block->data - DATA_MAX) {
        memcpy(block->data + block->snapshot_bytes, data + HEAD, length);
    }
    return HEAD + length;
}

static void read_image(const uint8_t *data, size_t size, unsigned how)
{
    static struct black_box_reader reader;
    memset(&box, 0, sizeof box);
    black_box_start(&box, 1, 2);
    box.header.state = (how & 3u) + 1u;
    box.header.check ^= (how & BAD_HEADER) != 0 ? 1u : 0u;
    for (unsigned i = 0; i < BLACK_BOX_BLOCK_COUNT; i++) {
        const size_t taken = take_block(&box.blocks[i], data, size);
        data += taken;
        size -= taken;
    }
    const uint32_t blocks = black_box_reader_open(&reader, &box);
    if (blocks > BLACK_BOX_BLOCK_COUNT || (blocks > 0 && !black_box_is_valid(&box))) {
        abort();
    }
    uint32_t begun = 0;
    /* Each record takes a byte at least: it must come to an end. */
    for (uint32_t items = 0;; items++) {
        const enum black_box_item item = black_box_reader_next(&reader);
        if (item == BLACK_BOX_END) {
            break;
        }
        begun += item == BLACK_BOX_SNAPSHOT;
        if (items > BLACK_BOX_BYTES || reader.message.length > CAN_FRAME_DATA_MAX ||
            reader.snapshot_bytes > sizeof box.blocks[0].data) {
            abort();
        }
    }
    if (begun != blocks) {
        abort();
    }
}

/* ---- any frames, there and back ---------------------------------------------------- */

static struct can_msg sent[FRAMES_MAX * PASSES_MAX];

static size_t give_snapshot(const void *context, uint8_t *out, size_t capacity)
{
    const size_t bytes = *(const size_t *)context;
    memset(out, 0xA5, bytes < capacity ? bytes : capacity);
    return bytes;
}

static struct can_msg message_of(const uint8_t *record)
{
    static const uint32_t known[] = {
#define KNOWN_ID(name, id, bytes, period_us, deadline_us, node, kind) (id),
        FRAME_TABLE(KNOWN_ID)
#undef KNOWN_ID
    };
    static const uint8_t known_bytes[] = {
#define KNOWN_BYTES(name, id, bytes, period_us, deadline_us, node, kind) (bytes),
        FRAME_TABLE(KNOWN_BYTES)
#undef KNOWN_BYTES
    };
    const unsigned row = record[0] % (sizeof known / sizeof known[0]);
    struct can_msg message = {.id = known[row], .length = known_bytes[row]};
    if ((record[1] & 0x80u) != 0) {
        message.id = record[0] * 0x00400801u;
        message.length = record[1] & 7u;
    }
    message.flags = (record[1] & 0x40u) != 0 ? CAN_FRAME_OWN : 0;
    memcpy(message.data, record + 2, message.length);
    return message;
}

/* The frames read are the last ones sent, none changed, none left out. */
static void check_read(unsigned count)
{
    static struct black_box_reader reader;
    static struct can_msg found[FRAMES_MAX * PASSES_MAX];
    unsigned read = 0;
    (void)black_box_reader_open(&reader, &box);
    for (;;) {
        const enum black_box_item item = black_box_reader_next(&reader);
        if (item == BLACK_BOX_END) {
            break;
        }
        if (item == BLACK_BOX_DAMAGED) {
            abort();
        }
        if (item == BLACK_BOX_FRAME && read < sizeof found / sizeof found[0]) {
            found[read++] = reader.message;
        }
    }
    if (read > count || (count > 0 && read == 0 && box.header.lost_frames == 0)) {
        abort();
    }
    if (box.header.lost_frames != 0) {
        return;
    }
    for (unsigned i = 0; i < read; i++) {
        const struct can_msg *wanted = &sent[count - read + i];
        if (found[i].id != wanted->id || found[i].length != wanted->length ||
            found[i].flags != wanted->flags ||
            memcmp(found[i].data, wanted->data, wanted->length) != 0) {
            abort();
        }
    }
}

static void record_frames(const uint8_t *data, size_t size, unsigned how)
{
    const size_t snapshot = how % 7u * 1100u; /* the largest is refused */
    const unsigned passes = 1u << (2 * (how >> TIMES_SHIFT & TIMES_MASK));
    unsigned count = 0, tick = 0;
    memset(&box, 0, sizeof box);
    black_box_start(&box, 1, 2);
    black_box_end_tick(&box, tick++, give_snapshot, &snapshot);
    for (unsigned pass = 0; pass < passes; pass++) {
        for (size_t at = 0; at + RECORD_BYTES <= size && at / RECORD_BYTES < FRAMES_MAX;
             at += RECORD_BYTES) {
            const struct can_msg message = message_of(data + at);
            sent[count++] = message;
            black_box_record(&box, &message);
            if ((data[at + 1] & 0x20u) != 0) {
                black_box_end_tick(&box, tick++, give_snapshot, &snapshot);
            }
        }
    }
    if ((how & 1u) != 0) {
        black_box_trigger(&box, 4, tick, 1);
        black_box_end_tick(&box, tick + 1, give_snapshot, &snapshot);
    } else {
        black_box_freeze(&box, BLACK_BOX_REASON_RESET);
    }
    check_read(count);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size > 0) {
        ((data[0] & MODE_RECORD) != 0 ? record_frames : read_image)(data + 1, size - 1,
                                                                    data[0] & 0x7Fu);
    }
    return 0;
}
