/* The serial line's decoder and its count of answers, under any bytes and any frames to send. */
#include "hal/bus/slcan.h"
#include "hal/bus/slcan_channel.h"
#include "tests/proof/arbitrary.h"

static struct slcan_channel channel;

void proof_slcan(void)
{
    slcan_channel_init(&channel);
    //@ loop widen_hints channel.decoder.used, 31; loop widen_hints channel.pending_count, 16;
    for (;;) {
        const enum slcan_event event = slcan_channel_receive(&channel, (char)any_u8);
        if (event == SLCAN_FRAME) {
            //@ assert length: channel.decoder.message.length <= CAN_FRAME_DATA_MAX;
        }
        struct can_msg message;
        char line[SLCAN_LINE_MAX];
        any_message(&message);
        message.length = any_u8; /* what is no frame is refused */
        const size_t bytes = slcan_encode(&message, line);
        //@ assert bytes: bytes <= SLCAN_LINE_MAX;
        (void)slcan_channel_sent(&channel, message.id);
    }
}
