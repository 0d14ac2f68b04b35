/* The black box: the bus traffic of the last seconds, in memory that a reset does
 * not clear, with snapshots of the controller so that it replays from the middle.
 *
 * The image is 64 KiB: a header and a ring of blocks. Each block begins with a
 * snapshot of the controller's state and can be read without any other block. In
 * a block, a frame takes one byte for its row in the frame table, one for the
 * mask of data bytes that differ from the last such frame, and those bytes; one that comes
 * from another than the table says is kept whole, with its flags.
 * black_box_reader.h reads an image.
 *
 * Only the order of frames is kept (it alone defines the controller's inputs),
 * with the number of the tick; times inside a tick are not.
 */
#ifndef HAL_STORAGE_BLACK_BOX_H
#define HAL_STORAGE_BLACK_BOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/bus/can_frame.h"
#include "hal/bus/frame_table.h"

enum {
    BLACK_BOX_BYTES = 65536,
    BLACK_BOX_MAGIC = 0x31424241,       /* "ABB1" in memory order */
    BLACK_BOX_BLOCK_MAGIC = 0x4B4C4242, /* "BBLK" in memory order */
    BLACK_BOX_BLOCK_COUNT = 4,
    BLACK_BOX_SNAPSHOT_MAX = 6656,
    BLACK_BOX_RAW_BYTES = 7, /* of a frame kept whole, its data left aside */
    BLACK_BOX_RECORD_MAX = BLACK_BOX_RAW_BYTES + CAN_FRAME_DATA_MAX,
    /* The most that a tick may carry: frames without data, of 47 bits (ISO 11898-1, the space to the next
     * among them), or error frames of 20: no others take more bytes a bit. */
    BLACK_BOX_TICK_BITS = TICK_PERIOD_US * (BUS_BITRATE / 1000) / 1000,
    BLACK_BOX_TICK_FRAMES = BLACK_BOX_TICK_BITS / 47 + 1,
    BLACK_BOX_TICK_ERRORS = BLACK_BOX_TICK_BITS / 20 + 1,
    BLACK_BOX_ERROR_BYTES = 11, /* of an error frame's record */
    /* With less, a tick's records may not fit. Own frames are recorded before they are on the bus: then they come on
     * top of what is there. */
    BLACK_BOX_TICK_LEAST = BLACK_BOX_TICK_FRAMES * BLACK_BOX_RAW_BYTES +
                           BLACK_BOX_TICK_ERRORS * BLACK_BOX_ERROR_BYTES + BLACK_BOX_RECORD_MAX,
    /* With less, a block should be followed by another. */
    BLACK_BOX_TICK_RESERVE = BLACK_BOX_TICK_LEAST > 1024 ? BLACK_BOX_TICK_LEAST : 1024,
    BLACK_BOX_ROW_MAX = 48
};

/* A bit of the reason that is no fault: a reset that nobody announced cut the recording short. */
#define BLACK_BOX_REASON_RESET 0x80000000u

enum black_box_state {
    BLACK_BOX_RECORDING = 1,
    BLACK_BOX_CLOSING = 2, /* triggered, still recording some ticks */
    BLACK_BOX_FROZEN = 3
};

/* First byte of a record in a block. */
enum black_box_code {
    BLACK_BOX_ROW_MASK = 0x3F, /* row of the frame table */
    BLACK_BOX_SAME = 0x40,     /* with a row: the same data as last time, nothing follows */
    BLACK_BOX_RAW = 0x80       /* flags, length, identifier (4 bytes), data */
};

struct black_box_block {
    uint32_t magic;
    uint32_t sequence;   /* counts blocks since power-up */
    uint32_t first_tick; /* number of the last SYNC before the first record */
    uint32_t snapshot_bytes;
    uint32_t reserved;
    uint32_t check;         /* sum of the fields above */
    uint32_t used;          /* bytes of data[] in use, snapshot included */
    uint32_t used_inverted; /* its complement: both change, so a reset between shows */
    uint8_t data[16160];
};

struct black_box_header {
    uint32_t magic;
    uint32_t state;  /* enum black_box_state */
    uint32_t reason; /* fault bits of the trigger; 0 when none */
    uint32_t trigger_tick;
    uint32_t close_tick; /* CLOSING: freeze after this tick */
    uint32_t build_id;
    uint32_t parameter_crc;
    uint32_t current; /* block being written, 0 .. BLACK_BOX_BLOCK_COUNT-1 */
    uint32_t next_sequence;
    uint32_t lost_frames; /* did not fit their block; saturates */
    uint32_t check;       /* sum of magic, build_id and parameter_crc */
    uint32_t reserved[5];
    uint8_t last[BLACK_BOX_ROW_MAX][CAN_FRAME_DATA_MAX]; /* per row, inside the block */
    uint8_t unused[320];
};

struct black_box {
    struct black_box_header header;
    struct black_box_block blocks[BLACK_BOX_BLOCK_COUNT];
};

/* Writes the controller's state to `out` and returns its size, at most
 * `capacity` (BLACK_BOX_SNAPSHOT_MAX); 0 when it has none. */
typedef size_t (*black_box_snapshot)(const void *context, uint8_t *out, size_t capacity);

/* True when the memory holds an image (after a reset, not after power-up). */
bool black_box_is_valid(const struct black_box *box);

/* Discards what is there and starts recording. `build_id` and `parameter_crc`
 * name what produced the log. The first block opens at the next
 * black_box_end_tick; frames before it are not kept. Loop only; clears 1 KiB. */
void black_box_start(struct black_box *box, uint32_t build_id, uint32_t parameter_crc);

/* Appends a frame in the order of the bus, received or sent; drops it silently
 * while frozen or before the first block. Loop only; at most 250 instructions. */
void black_box_record(struct black_box *box, const struct can_msg *message);

/* Says that the controller has digested everything recorded so far: a tick is
 * over. Opens a new block with a snapshot when the current one is nearly full.
 * Loop only; below 100 instructions, plus the snapshot when it opens one. */
void black_box_end_tick(struct black_box *box, uint32_t tick, black_box_snapshot snapshot,
                        const void *context);

/* The part of it that no tick may leave out: the recording ends with the tick that its trigger set. O(1). */
void black_box_freeze_when_due(struct black_box *box, uint32_t tick);

/* Whether the next block can wait no longer. O(1). */
bool black_box_is_full(const struct black_box *box);

/* Freezes the recording `more_ticks` ticks after `tick`; the first trigger wins.
 * `reason` is kept with the image. Any context; O(1). */
void black_box_trigger(struct black_box *box, uint32_t reason, uint32_t tick, uint32_t more_ticks);

/* True when a recording has begun that nothing has ended yet. */
bool black_box_has_recording(const struct black_box *box);

/* At start, after a crash: freezes an image whose recording a reset cut short. */
void black_box_freeze(struct black_box *box, uint32_t reason);

/* Row of a frame in the frame table, or -1 when it is not there or its length is
 * another. O(1). */
int black_box_row(uint32_t id, uint8_t length);

/* Sums of the guarded fields, as stored in their `check`. */
uint32_t black_box_block_check(const struct black_box_block *block);
uint32_t black_box_header_check(const struct black_box_header *header);

#endif
