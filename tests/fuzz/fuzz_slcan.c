/* Fuzzer: an slcan decoder under any bytes; what it takes for a frame is a valid one and
 * survives being written and read again. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/slcan.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_round_trip(const struct can_msg *message)
{
    char line[SLCAN_LINE_MAX];
    struct slcan_decoder again;
    const size_t length = slcan_encode(message, line);
    if (length == 0 || length > SLCAN_LINE_MAX) {
        abort();
    }
    slcan_decoder_init(&again);
    enum slcan_event event = SLCAN_NOTHING;
    for (size_t i = 0; i < length; i++) {
        event = slcan_decode(&again, line[i]);
    }
    if (event != SLCAN_FRAME || again.message.id != message->id ||
        again.message.length != message->length || again.message.flags != message->flags ||
        memcmp(again.message.data, message->data, sizeof message->data) != 0) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct slcan_decoder decoder;
    slcan_decoder_init(&decoder);
    for (size_t i = 0; i < size; i++) {
        if (slcan_decode(&decoder, (char)data[i]) == SLCAN_FRAME) {
            check_round_trip(&decoder.message);
        }
    }
    return 0;
}
