/* LAWICEL text frames ("slcan"): CAN over a serial line, one line per frame.
 *
 * Source: LAWICEL CANUSB manual, sections on the commands t, T, r, R, and the
 * Linux kernel's drivers/net/can/slcan. A line ends with CR. Lengths are one
 * hexadecimal digit, bytes two; upper case is sent, both cases are understood.
 *   tiiildd..   standard data frame      riiil   standard remote frame
 *   Tiiiiiiiildd..  extended data frame  Riiiiiiiil  extended remote frame
 *   z CR / Z CR  the adapter's acknowledgement of a standard / extended frame
 *   CR          command done             BEL     command refused
 * A received frame may have a time stamp behind it, four hexadecimal digits of milliseconds (command
 * Z1); nobody here needs it. A line feed behind a line's end is ignored.
 */
#ifndef HAL_BUS_SLCAN_H
#define HAL_BUS_SLCAN_H

#include <stddef.h>
#include <stdint.h>

#include "hal/bus/can_frame.h"

enum {
    SLCAN_LINE_MAX = 31 /* T + 8 + 1 + 16 + time stamp 4 + CR */
};

/* Writes *message as one line, CR included, no NUL, to `out` (SLCAN_LINE_MAX
 * bytes). Returns the number of bytes, 0 when the message is no valid frame
 * (length above 8, identifier out of range, or an error message). O(1). */
size_t slcan_encode(const struct can_msg *message, char *out);

enum slcan_event {
    SLCAN_NOTHING = 0,      /* the byte belongs to an unfinished line */
    SLCAN_FRAME = 1,        /* a frame is in decoder->message */
    SLCAN_ACKNOWLEDGED = 2, /* the other end took a frame that was sent to it */
    SLCAN_REFUSED = 3,      /* BEL: the other end refused the last command */
    SLCAN_DONE = 4,         /* an empty line: a command without answer was done */
    SLCAN_OTHER = 5,        /* a well-formed line of another kind (open, speed, ..) in line[] */
    SLCAN_MALFORMED = -1    /* the line was no frame; counted and dropped */
};

struct slcan_decoder {
    char line[SLCAN_LINE_MAX + 1]; /* the line so far; after SLCAN_OTHER NUL-ended */
    uint8_t used;
    uint8_t overrun;    /* line too long: drop up to its end */
    uint32_t malformed; /* saturates */
    struct can_msg message;
};

void slcan_decoder_init(struct slcan_decoder *decoder);

/* Takes one received byte. Returns what it completed. The decoder is ready for
 * the next line after every result but SLCAN_NOTHING. O(1), at most one line of
 * work. Any context, one caller at a time. */
enum slcan_event slcan_decode(struct slcan_decoder *decoder, char byte);

#endif
