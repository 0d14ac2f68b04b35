/* Reads a black-box image back into snapshots and frames, oldest first.
 *
 * For the host; the flashed image does not contain it.
 */
#ifndef HAL_STORAGE_BLACK_BOX_READER_H
#define HAL_STORAGE_BLACK_BOX_READER_H

#include <stdint.h>

#include "hal/storage/black_box.h"

enum black_box_item {
    BLACK_BOX_END = 0,
    BLACK_BOX_SNAPSHOT = 1, /* a block begins: snapshot, snapshot_bytes, tick are set */
    BLACK_BOX_FRAME = 2,    /* message and tick are set */
    BLACK_BOX_DAMAGED = -1  /* a block broke off; reading goes on with the next one */
};

struct black_box_reader {
    const struct black_box *box;
    uint32_t order[BLACK_BOX_BLOCK_COUNT]; /* valid blocks, oldest first */
    uint32_t block_count;
    uint32_t next_block;
    uint32_t position; /* in the data of the current block */
    uint8_t last[BLACK_BOX_ROW_MAX][CAN_FRAME_DATA_MAX];
    /* the current item */
    struct can_msg message;
    uint32_t tick; /* number of the last SYNC at or before the item */
    const uint8_t *snapshot;
    uint32_t snapshot_bytes;
};

/* Prepares reading of *box, which stays the caller's and must not change. A
 * frame the controller itself sends is marked CAN_FRAME_OWN. Returns the number
 * of readable blocks, 0 when there is nothing or the image is invalid. */
uint32_t black_box_reader_open(struct black_box_reader *reader, const struct black_box *box);

/* Moves to the next item. Loop only; O(1) but for the start of a block. */
enum black_box_item black_box_reader_next(struct black_box_reader *reader);

#endif
