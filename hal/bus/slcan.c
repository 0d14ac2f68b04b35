#include "hal/bus/slcan.h"

#include <stdbool.h>
#include <string.h>

enum {
    CARRIAGE_RETURN = 0x0D,
    LINE_FEED = 0x0A,
    BELL = 0x07,
    STANDARD_DIGITS = 3,
    EXTENDED_DIGITS = 8,
    TIME_STAMP_DIGITS = 4
};

static char digit_of(uint32_t value)
{
    value &= 0x0FU;
    return (char)(value < 10U ? '0' + (char)value : 'A' + (char)(value - 10U));
}

/* The value of a hexadecimal digit, or 16 for anything else. */
static uint32_t value_of(char digit)
{
    if (digit >= '0' && digit <= '9') {
        return (uint32_t)(digit - '0');
    }
    if (digit >= 'A' && digit <= 'F') {
        return (uint32_t)(digit - 'A') + 10U;
    }
    if (digit >= 'a' && digit <= 'f') {
        return (uint32_t)(digit - 'a') + 10U;
    }
    return 16U;
}

size_t slcan_encode(const struct can_msg *message, char *out)
{
    bool extended = (message->flags & CAN_FRAME_EXTENDED) != 0;
    bool remote = (message->flags & CAN_FRAME_REMOTE) != 0;
    uint32_t id_max = extended ? (uint32_t)CAN_ID_EXTENDED_MAX : (uint32_t)CAN_ID_STANDARD_MAX;
    int digits = extended ? EXTENDED_DIGITS : STANDARD_DIGITS;
    size_t used = 0;

    if (message->length > CAN_FRAME_DATA_MAX || message->id > id_max ||
        (message->flags & CAN_FRAME_ERROR) != 0) {
        return 0;
    }
    if (remote) {
        out[used++] = extended ? 'R' : 'r';
    } else {
        out[used++] = extended ? 'T' : 't';
    }
    for (int i = digits - 1; i >= 0; i--) {
        out[used++] = digit_of(message->id >> (4 * i));
    }
    out[used++] = digit_of(message->length);
    for (uint8_t i = 0; !remote && i < message->length; i++) {
        out[used++] = digit_of((uint32_t)message->data[i] >> 4);
        out[used++] = digit_of(message->data[i]);
    }
    out[used++] = CARRIAGE_RETURN;
    return used;
}

/* Reads `digits` hexadecimal digits; false when one is not. */
static bool read_hex(const char *text, int digits, uint32_t *value)
{
    uint32_t sum = 0;

    for (int i = 0; i < digits; i++) {
        uint32_t digit = value_of(text[i]);
        if (digit > 15U) {
            return false;
        }
        sum = (sum << 4) | digit;
    }
    *value = sum;
    return true;
}

/* Parses t, T, r or R; the line is `used` bytes long, without its CR. */
static bool parse_frame(struct slcan_decoder *decoder)
{
    const char *line = decoder->line;
    bool extended = line[0] == 'T' || line[0] == 'R';
    bool remote = line[0] == 'r' || line[0] == 'R';
    int digits = extended ? EXTENDED_DIGITS : STANDARD_DIGITS;
    int header = 1 + digits + 1;
    struct can_msg message;
    uint32_t length, byte, time_stamp;

    memset(&message, 0, sizeof message);
    if ((int)decoder->used < header || !read_hex(line + 1, digits, &message.id) ||
        !read_hex(line + 1 + digits, 1, &length) || length > CAN_FRAME_DATA_MAX) {
        return false;
    }
    const int end = header + (remote ? 0 : 2 * (int)length);
    const bool stamped = (int)decoder->used == end + TIME_STAMP_DIGITS;
    if (message.id > (extended ? (uint32_t)CAN_ID_EXTENDED_MAX : (uint32_t)CAN_ID_STANDARD_MAX) ||
        ((int)decoder->used != end && !stamped) ||
        (stamped && !read_hex(line + end, TIME_STAMP_DIGITS, &time_stamp))) {
        return false;
    }
    for (uint32_t i = 0; !remote && i < length; i++) {
        if (!read_hex(line + header + 2 * (int)i, 2, &byte)) {
            return false;
        }
        message.data[i] = (uint8_t)byte;
    }
    message.length = (uint8_t)length;
    message.flags =
        (uint8_t)((extended ? CAN_FRAME_EXTENDED : 0) | (remote ? CAN_FRAME_REMOTE : 0));
    decoder->message = message;
    return true;
}

static enum slcan_event malformed(struct slcan_decoder *decoder)
{
    if (decoder->malformed < UINT32_MAX) {
        decoder->malformed++;
    }
    return SLCAN_MALFORMED;
}

/* Z0: no time stamps; Z1 and above: of some kind. */
static bool is_time_stamp_command(const struct slcan_decoder *decoder)
{
    return decoder->used == 2 && decoder->line[0] == 'Z' && decoder->line[1] >= '0' &&
           decoder->line[1] <= '9';
}

static enum slcan_event finish_line(struct slcan_decoder *decoder)
{
    enum slcan_event event;

    decoder->line[decoder->used] = '\0';
    if (decoder->used == 0) {
        return SLCAN_DONE;
    }
    switch (decoder->line[0]) {
    case 't':
    case 'T':
    case 'r':
    case 'R':
        event = parse_frame(decoder) ? SLCAN_FRAME : malformed(decoder);
        break;
    case 'z':
    case 'Z':
        if (decoder->used == 1) {
            event = SLCAN_ACKNOWLEDGED;
        } else {
            event = is_time_stamp_command(decoder) ? SLCAN_OTHER : malformed(decoder);
        }
        break;
    default:
        event = SLCAN_OTHER;
        break;
    }
    return event;
}

void slcan_decoder_init(struct slcan_decoder *decoder)
{
    memset(decoder, 0, sizeof *decoder);
}

enum slcan_event slcan_decode(struct slcan_decoder *decoder, char byte)
{
    enum slcan_event event;

    if (byte == BELL) {
        decoder->used = 0;
        decoder->overrun = 0;
        return SLCAN_REFUSED;
    }
    if (byte == CARRIAGE_RETURN) {
        event = decoder->overrun ? malformed(decoder) : finish_line(decoder);
        decoder->used = 0;
        decoder->overrun = 0;
        return event;
    }
    if (byte == LINE_FEED && decoder->used == 0) {
        return SLCAN_NOTHING; /* of an adapter that ends lines with both */
    }
    if (decoder->used >= SLCAN_LINE_MAX) {
        decoder->overrun = 1;
    } else {
        decoder->line[decoder->used++] = byte;
    }
    return SLCAN_NOTHING;
}
