/* A classic CAN data frame as every room of this project passes it around. */
#ifndef HAL_BUS_CAN_FRAME_H
#define HAL_BUS_CAN_FRAME_H

#include <stdint.h>

enum { CAN_FRAME_DATA_MAX = 8, CAN_ID_STANDARD_MAX = 0x7FF, CAN_ID_EXTENDED_MAX = 0x1FFFFFFF };

/* Bits of can_msg.flags. */
enum can_frame_flag {
    CAN_FRAME_EXTENDED = 1 << 0, /* 29-bit identifier */
    CAN_FRAME_REMOTE = 1 << 1,   /* remote transmission request, no data */
    CAN_FRAME_ERROR = 1 << 2,    /* not a frame: the port reports a bus error */
    CAN_FRAME_OWN = 1 << 3       /* echo of a frame this node sent, now on the bus */
};

struct can_msg {
    uint32_t id;                      /* 0..0x7FF, or 0..0x1FFFFFFF with CAN_FRAME_EXTENDED */
    uint8_t length;                   /* 0..8 data bytes */
    uint8_t flags;                    /* enum can_frame_flag */
    uint8_t data[CAN_FRAME_DATA_MAX]; /* bytes beyond length are 0 */
};

#endif
