/* The bit rate as a LAWICEL adapter is told it: S and this digit (CANUSB manual, command Sn). */
#ifndef HAL_BUS_SLCAN_RATE_H
#define HAL_BUS_SLCAN_RATE_H

#include <assert.h>

#include "hal/bus/frame_table.h"

enum {
    SLCAN_RATE_DIGIT = BUS_BITRATE == 1000000  ? '8'
                       : BUS_BITRATE == 800000 ? '7'
                       : BUS_BITRATE == 500000 ? '6'
                       : BUS_BITRATE == 250000 ? '5'
                       : BUS_BITRATE == 125000 ? '4'
                                               : 0
};
static_assert(SLCAN_RATE_DIGIT != 0, "an slcan adapter has 1000, 800, 500, 250 or 125 kbit/s");

#endif
