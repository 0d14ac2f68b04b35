#include "hal/storage/black_box_reader.h"

#include <string.h>

struct table_row {
    uint32_t id;
    uint8_t bytes;
    uint8_t node;
};

static const struct table_row table[] = {
#define TABLE_ROW(name, id, bytes, period_us, deadline_us, node, kind) {(id), (bytes), (node)},
    FRAME_TABLE(TABLE_ROW)
#undef TABLE_ROW
};

static int block_is_valid(const struct black_box_block *block)
{
    return block->magic == (uint32_t)BLACK_BOX_BLOCK_MAGIC &&
           block->check == black_box_block_check(block) && block->used == ~block->used_inverted &&
           block->used <= sizeof block->data && block->snapshot_bytes <= block->used;
}

uint32_t black_box_reader_open(struct black_box_reader *reader, const struct black_box *box)
{
    memset(reader, 0, sizeof *reader);
    reader->box = box;
    if (!black_box_is_valid(box)) {
        return 0;
    }
    for (uint32_t i = 0; i < BLACK_BOX_BLOCK_COUNT; i++) {
        uint32_t place = reader->block_count;
        if (!block_is_valid(&box->blocks[i])) {
            continue;
        }
        while (place > 0 &&
               box->blocks[reader->order[place - 1U]].sequence > box->blocks[i].sequence) {
            reader->order[place] = reader->order[place - 1U];
            place--;
        }
        reader->order[place] = i;
        reader->block_count++;
    }
    return reader->block_count;
}

static enum black_box_item begin_block(struct black_box_reader *reader)
{
    const struct black_box_block *block;

    if (reader->next_block >= reader->block_count) {
        return BLACK_BOX_END;
    }
    block = &reader->box->blocks[reader->order[reader->next_block++]];
    memset(reader->last, 0, sizeof reader->last);
    reader->position = block->snapshot_bytes;
    reader->tick = block->first_tick;
    reader->snapshot = block->data;
    reader->snapshot_bytes = block->snapshot_bytes;
    return BLACK_BOX_SNAPSHOT;
}

static enum black_box_item damaged(struct black_box_reader *reader)
{
    reader->position = BLACK_BOX_BYTES; /* past any block: the next call opens another */
    return BLACK_BOX_DAMAGED;
}

/* Of a frame that is kept whole: code, flags, length, identifier. */
enum { RAW_BYTES = 7 };

/* Where the records of a block end. */
static uint32_t end_of(const struct black_box_block *block)
{
    return block->used < sizeof block->data ? block->used : (uint32_t)sizeof block->data;
}

static enum black_box_item read_raw(struct black_box_reader *reader,
                                    const struct black_box_block *block)
{
    const uint8_t *record = block->data + reader->position;
    const uint32_t end = end_of(block);
    uint8_t length;

    if (end < RAW_BYTES || reader->position > end - RAW_BYTES) {
        return damaged(reader);
    }
    length = record[2];
    if (length > CAN_FRAME_DATA_MAX || length > end - RAW_BYTES - reader->position) {
        return damaged(reader);
    }
    reader->message.flags = record[1];
    reader->message.length = length;
    reader->message.id = (uint32_t)record[3] | ((uint32_t)record[4] << 8) |
                         ((uint32_t)record[5] << 16) | ((uint32_t)record[6] << 24);
    reader->position += RAW_BYTES;
    for (uint32_t i = 0; i < length && reader->position < end; i++) {
        reader->message.data[i] = block->data[reader->position++];
    }
    return BLACK_BOX_FRAME;
}

static enum black_box_item read_row(struct black_box_reader *reader,
                                    const struct black_box_block *block, uint8_t code)
{
    uint32_t row = code & (uint32_t)BLACK_BOX_ROW_MASK;
    const uint32_t end = end_of(block);
    uint32_t at = reader->position + 1U, mask = 0;

    if (row >= sizeof table / sizeof table[0]) {
        return damaged(reader);
    }
    if ((code & BLACK_BOX_SAME) == 0) {
        if (at >= end) {
            return damaged(reader);
        }
        mask = block->data[at++];
    }
    for (uint32_t i = 0; i < CAN_FRAME_DATA_MAX; i++) {
        if ((mask & (1U << i)) == 0U) {
            continue;
        }
        if (at >= end || i >= table[row].bytes) {
            return damaged(reader);
        }
        reader->last[row][i] = block->data[at++];
    }
    reader->message.id = table[row].id;
    reader->message.length = table[row].bytes;
    reader->message.flags = table[row].node == NODE_CONTROLLER ? CAN_FRAME_OWN : 0;
    memcpy(reader->message.data, reader->last[row], table[row].bytes);
    reader->position = at;
    if (table[row].id == FRAME_SYNC) {
        reader->tick++;
    }
    return BLACK_BOX_FRAME;
}

enum black_box_item black_box_reader_next(struct black_box_reader *reader)
{
    const struct black_box_block *block;
    uint8_t code;

    if (reader->next_block == 0) {
        return begin_block(reader);
    }
    block = &reader->box->blocks[reader->order[reader->next_block - 1U]];
    if (reader->position >= end_of(block)) {
        return begin_block(reader);
    }
    memset(&reader->message, 0, sizeof reader->message);
    code = block->data[reader->position];
    return (code & BLACK_BOX_RAW) != 0 ? read_raw(reader, block) : read_row(reader, block, code);
}
