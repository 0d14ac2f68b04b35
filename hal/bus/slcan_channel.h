/* One end of an slcan line: which frames that were sent the adapter has answered.
 *
 * An adapter answers in order, a frame with z or Z when it was on the bus, with BEL when it was
 * refused, a command with CR or BEL (LAWICEL CANUSB manual, chapter 2). Nothing in an answer says to
 * what, so the answers to the opening commands are counted.
 */
#ifndef HAL_BUS_SLCAN_CHANNEL_H
#define HAL_BUS_SLCAN_CHANNEL_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/slcan.h"

enum { SLCAN_PENDING_MAX = 16, SLCAN_OPEN_COMMANDS_LENGTH = 11 };

struct slcan_channel {
    struct slcan_decoder decoder; /* its message after SLCAN_FRAME */
    uint16_t pending[SLCAN_PENDING_MAX];
    uint8_t pending_count;
    uint8_t commands_unanswered;
    uint8_t commands_refused; /* of the opening ones; an adapter without time stamps refuses Z0 */
    uint16_t answered_id;     /* after SLCAN_ACKNOWLEDGED and SLCAN_REFUSED: the frame's */
};

/* What opens the adapter, whatever it was doing: ends a line, closes, 1 Mbit/s, no time stamps
 * (possible only while closed), opens. To be sent once, at the start. */
extern const char slcan_open_commands[SLCAN_OPEN_COMMANDS_LENGTH + 1];

/* For a line on which slcan_open_commands is sent now. */
void slcan_channel_init(struct slcan_channel *channel);

/* A frame is sent now. False: SLCAN_PENDING_MAX wait for an answer already; do not send it. O(1). */
bool slcan_channel_sent(struct slcan_channel *channel, uint32_t id);

/* Takes one received byte. Returns as slcan_decode() does; SLCAN_ACKNOWLEDGED and SLCAN_REFUSED only
 * for a frame that was sent, SLCAN_DONE also for a command that was refused. O(1). Any context, one
 * caller at a time. */
enum slcan_event slcan_channel_receive(struct slcan_channel *channel, char byte);

#endif
