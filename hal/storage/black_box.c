#include "hal/storage/black_box.h"

#include <assert.h>
#include <string.h>

#include "hal/bus/bytes.h"

static_assert(sizeof(struct black_box) == BLACK_BOX_BYTES, "the image fills its section");
static_assert(sizeof(((struct black_box_block *)0)->data) >=
                  BLACK_BOX_SNAPSHOT_MAX + 2 * BLACK_BOX_TICK_RESERVE,
              "a block holds a snapshot and some ticks");

#define NO_BLOCK 0xFFFFFFFFU

/* Rows are numbered in the order of the frame table. */
#define ROW_ENTRY(name, id, bytes, period_us, deadline_us, node, kind) ROW_##name,
enum row { FRAME_TABLE(ROW_ENTRY) ROW_COUNT };
#undef ROW_ENTRY
static_assert((int)ROW_COUNT <= (int)BLACK_BOX_ROW_MAX, "a row fits its code and its memory");
static_assert((int)BLACK_BOX_ROW_MAX <= (int)BLACK_BOX_ROW_MASK + 1, "a row fits six bits");

static int row_of_id(uint32_t id)
{
    switch (id) {
#define ROW_CASE(name, frame_id, bytes, period_us, deadline_us, node, kind) \
    case (frame_id):                                                        \
        return ROW_##name;
        FRAME_TABLE(ROW_CASE)
#undef ROW_CASE
    default:
        return -1;
    }
}

static const uint8_t row_bytes[ROW_COUNT] = {
#define ROW_BYTES(name, id, bytes, period_us, deadline_us, node, kind) (bytes),
    FRAME_TABLE(ROW_BYTES)
#undef ROW_BYTES
};

/* Sent by us or received: what a row says of its frames without a byte. */
static const uint8_t row_flags[ROW_COUNT] = {
#define ROW_FLAGS(name, id, bytes, period_us, deadline_us, node, kind) \
    (node) == NODE_CONTROLLER ? CAN_FRAME_OWN : 0,
    FRAME_TABLE(ROW_FLAGS)
#undef ROW_FLAGS
};

int black_box_row(uint32_t id, uint8_t length)
{
    int row = row_of_id(id);

    return row >= 0 && row_bytes[row] == length ? row : -1;
}

uint32_t black_box_block_check(const struct black_box_block *block)
{
    return ~(block->magic + 3U * block->sequence + 5U * block->first_tick +
             7U * block->snapshot_bytes);
}

uint32_t black_box_header_check(const struct black_box_header *header)
{
    return ~(header->magic + 3U * header->build_id + 5U * header->parameter_crc);
}

bool black_box_is_valid(const struct black_box *box)
{
    const struct black_box_header *header = &box->header;

    return header->magic == (uint32_t)BLACK_BOX_MAGIC &&
           header->check == black_box_header_check(header) &&
           header->state >= (uint32_t)BLACK_BOX_RECORDING &&
           header->state <= (uint32_t)BLACK_BOX_FROZEN;
}

static bool is_open(const struct black_box *box)
{
    return box->header.state != (uint32_t)BLACK_BOX_FROZEN &&
           box->header.current < (uint32_t)BLACK_BOX_BLOCK_COUNT;
}

bool black_box_has_recording(const struct black_box *box)
{
    return black_box_is_valid(box) && is_open(box);
}

void black_box_start(struct black_box *box, uint32_t build_id, uint32_t parameter_crc)
{
    memset(&box->header, 0, sizeof box->header);
    for (uint32_t i = 0; i < BLACK_BOX_BLOCK_COUNT; i++) {
        box->blocks[i].magic = 0;
    }
    box->header.build_id = build_id;
    box->header.parameter_crc = parameter_crc;
    box->header.current = NO_BLOCK;
    box->header.state = BLACK_BOX_RECORDING;
    box->header.magic = (uint32_t)BLACK_BOX_MAGIC;
    box->header.check = black_box_header_check(&box->header);
}

static void set_used(struct black_box_block *block, uint32_t used)
{
    block->used = used;
    block->used_inverted = ~used;
}

/* Appends the bytes of half a frame (4 bytes from `at`) that differ from `last`. */
static inline uint32_t put_half(uint8_t *out, uint8_t *last, const uint8_t *data, uint32_t at,
                                uint32_t *mask)
{
    uint32_t now, before, changed, used = 0;

    memcpy(&now, data + at, sizeof now);
    memcpy(&before, last + at, sizeof before);
    changed = now ^ before;
    if (changed == 0U) { /* the usual case for the upper half */
        return 0;
    }
    memcpy(last + at, data + at, sizeof now);
    for (uint32_t i = 0; changed != 0U; i++, changed >>= 8) {
        if ((changed & 0xFFU) != 0U) {
            *mask |= 1U << (at + i);
            out[used++] = data[at + i];
        }
    }
    return used;
}

/* Appends the bytes that differ from `last`, behind a mask of their places. Bytes
 * beyond the length are 0 in every message, so they never differ. */
static uint32_t put_difference(uint8_t *out, uint8_t *last, const struct can_msg *message, int row)
{
    uint32_t mask = 0, used = 2;

    used += put_half(out + used, last, message->data, 0, &mask);
    used += put_half(out + used, last, message->data, 4, &mask);
    if (mask == 0) {
        out[0] = (uint8_t)((uint32_t)row | (uint32_t)BLACK_BOX_SAME);
        return 1;
    }
    out[0] = (uint8_t)row;
    out[1] = (uint8_t)mask;
    return used;
}

static uint32_t put_raw(uint8_t *out, const struct can_msg *message)
{
    uint32_t length = message->length <= CAN_FRAME_DATA_MAX ? message->length : 0U;

    out[0] = BLACK_BOX_RAW;
    out[1] = message->flags;
    out[2] = (uint8_t)length;
    bytes_put_u32(out + 3, message->id);
    memcpy(out + BLACK_BOX_RAW_BYTES, message->data, CAN_FRAME_DATA_MAX); /* room for the longest */
    return (uint32_t)BLACK_BOX_RAW_BYTES + length;
}

void black_box_record(struct black_box *box, const struct can_msg *message)
{
    struct black_box_block *block;
    int row;

    if (!is_open(box)) {
        return;
    }
    block = &box->blocks[box->header.current];
    if (block->used + (uint32_t)BLACK_BOX_RECORD_MAX > sizeof block->data) {
        if (box->header.lost_frames < UINT32_MAX) {
            box->header.lost_frames++;
        }
        return;
    }
    row = black_box_row(message->id, message->length);
    if (row < 0 || row_flags[row] != message->flags) { /* a foreign node's with our identifier */
        set_used(block, block->used + put_raw(block->data + block->used, message));
    } else {
        set_used(block, block->used + put_difference(block->data + block->used,
                                                     box->header.last[row], message, row));
    }
}

static void open_block(struct black_box *box, uint32_t tick, black_box_snapshot snapshot,
                       const void *context)
{
    struct black_box_header *header = &box->header;
    uint32_t next = header->current < BLACK_BOX_BLOCK_COUNT - 1U ? header->current + 1U : 0U;
    struct black_box_block *block = &box->blocks[next];
    size_t bytes;

    block->magic = 0; /* a reset from here on must not find half a block */
    bytes = snapshot != NULL ? snapshot(context, block->data, BLACK_BOX_SNAPSHOT_MAX) : 0U;
    if (bytes > BLACK_BOX_SNAPSHOT_MAX) {
        bytes = 0;
    }
    memset(header->last, 0, sizeof header->last);
    block->sequence = header->next_sequence++;
    block->first_tick = tick;
    block->snapshot_bytes = (uint32_t)bytes;
    block->reserved = 0;
    set_used(block, (uint32_t)bytes);
    block->magic = (uint32_t)BLACK_BOX_BLOCK_MAGIC;
    block->check = black_box_block_check(block);
    header->current = next;
}

static bool has_room(const struct black_box *box, uint32_t bytes)
{
    return is_open(box) &&
           box->blocks[box->header.current].used + bytes <= sizeof box->blocks[0].data;
}

bool black_box_is_full(const struct black_box *box)
{
    return box->header.state != (uint32_t)BLACK_BOX_FROZEN && !has_room(box, BLACK_BOX_TICK_LEAST);
}

void black_box_freeze_when_due(struct black_box *box, uint32_t tick)
{
    struct black_box_header *header = &box->header;

    if (header->state == (uint32_t)BLACK_BOX_CLOSING && (int32_t)(tick - header->close_tick) >= 0) {
        header->state = BLACK_BOX_FROZEN;
    }
}

void black_box_end_tick(struct black_box *box, uint32_t tick, black_box_snapshot snapshot,
                        const void *context)
{
    black_box_freeze_when_due(box, tick);
    if (box->header.state != (uint32_t)BLACK_BOX_FROZEN && !has_room(box, BLACK_BOX_TICK_RESERVE)) {
        open_block(box, tick, snapshot, context);
    }
}

void black_box_trigger(struct black_box *box, uint32_t reason, uint32_t tick, uint32_t more_ticks)
{
    if (box->header.state != (uint32_t)BLACK_BOX_RECORDING) {
        return;
    }
    box->header.reason = reason;
    box->header.trigger_tick = tick;
    box->header.close_tick = tick + more_ticks;
    box->header.state = BLACK_BOX_CLOSING;
}

void black_box_freeze(struct black_box *box, uint32_t reason)
{
    if (box->header.state == (uint32_t)BLACK_BOX_RECORDING) {
        box->header.reason = reason;
    }
    box->header.state = BLACK_BOX_FROZEN;
}
