#include "sim_host/log/candump_log.h"

#include <assert.h>
#include <string.h>

enum { SECONDS_DIGITS = 10, MICROS_DIGITS = 6, LINE_READ_MAX = 160 };

static const uint32_t ERROR_FLAG_IN_LOG = UINT32_C(0x20000000);

static char *put_decimal(char *at, uint64_t value, unsigned digits)
{
    for (unsigned i = digits; i-- > 0;) {
        at[i] = (char)('0' + (int)(value % 10));
        value /= 10;
    }
    return at + digits;
}

static char *put_hex(char *at, uint32_t value, unsigned digits)
{
    static const char digit[] = "0123456789ABCDEF";
    for (unsigned i = digits; i-- > 0;) {
        at[i] = digit[value & 0xFU];
        value >>= 4;
    }
    return at + digits;
}

size_t candump_format(char *line, uint64_t time_us, const char *interface_name,
                      const struct can_msg *message)
{
    const size_t name_length = strlen(interface_name);
    assert(name_length > 0 && name_length < CANDUMP_INTERFACE_MAX);
    assert(message->length <= CAN_FRAME_DATA_MAX);
    char *at = line;
    *at++ = '(';
    at = put_decimal(at, time_us / 1000000, SECONDS_DIGITS);
    *at++ = '.';
    at = put_decimal(at, time_us % 1000000, MICROS_DIGITS);
    *at++ = ')';
    *at++ = ' ';
    memcpy(at, interface_name, name_length);
    at += name_length;
    *at++ = ' ';
    if ((message->flags & CAN_FRAME_ERROR) != 0) {
        at = put_hex(at, message->id | ERROR_FLAG_IN_LOG, 8);
    } else {
        at = put_hex(at, message->id, (message->flags & CAN_FRAME_EXTENDED) != 0 ? 8 : 3);
    }
    *at++ = '#';
    if ((message->flags & CAN_FRAME_REMOTE) != 0) {
        *at++ = 'R';
        if (message->length > 0) {
            *at++ = (char)('0' + message->length);
        }
    } else {
        for (unsigned i = 0; i < message->length; i++) {
            at = put_hex(at, message->data[i], 2);
        }
    }
    *at++ = '\n';
    return (size_t)(at - line);
}

bool candump_write(FILE *file, uint64_t time_us, const char *interface_name,
                   const struct can_msg *message)
{
    char line[CANDUMP_LINE_MAX];
    const size_t length = candump_format(line, time_us, interface_name, message);
    return fwrite(line, 1, length, file) == length;
}

/* A line being read: the position is the column for the error. */
struct cursor {
    const char *text;
    size_t length;
    size_t at;
    struct candump_error *error;
};

static bool fail(const struct cursor *cursor, const char *reason)
{
    cursor->error->column = (unsigned)cursor->at + 1;
    cursor->error->reason = reason;
    return false;
}

static int peek(const struct cursor *cursor)
{
    return cursor->at < cursor->length ? (unsigned char)cursor->text[cursor->at] : -1;
}

static bool take(struct cursor *cursor, char wanted, const char *reason)
{
    if (peek(cursor) != (unsigned char)wanted) {
        return fail(cursor, reason);
    }
    cursor->at++;
    return true;
}

static int hex_value(int character)
{
    if (character >= '0' && character <= '9') {
        return character - '0';
    }
    if (character >= 'A' && character <= 'F') {
        return character - 'A' + 10;
    }
    return -1;
}

static bool take_time(struct cursor *cursor, uint64_t *time_us)
{
    uint64_t seconds = 0;
    uint64_t micros = 0;
    unsigned digits = 0;
    if (!take(cursor, '(', "expected '(' before the time")) {
        return false;
    }
    for (; peek(cursor) >= '0' && peek(cursor) <= '9' && digits < 12; digits++) {
        seconds = seconds * 10 + (uint64_t)(peek(cursor) - '0');
        cursor->at++;
    }
    if (digits < SECONDS_DIGITS) {
        return fail(cursor, "expected at least ten digits of seconds");
    }
    if (!take(cursor, '.', "expected '.' after the seconds")) {
        return false;
    }
    for (digits = 0; digits < MICROS_DIGITS; digits++) {
        if (peek(cursor) < '0' || peek(cursor) > '9') {
            return fail(cursor, "expected six digits of microseconds");
        }
        micros = micros * 10 + (uint64_t)(peek(cursor) - '0');
        cursor->at++;
    }
    *time_us = seconds * 1000000 + micros;
    return take(cursor, ')', "expected ')' after the time") &&
           take(cursor, ' ', "expected one space before the interface");
}

static bool take_interface(struct cursor *cursor, char *name)
{
    size_t length = 0;
    for (int c = peek(cursor); c > ' ' && c < 127; c = peek(cursor)) {
        if (length == CANDUMP_INTERFACE_MAX - 1) {
            return fail(cursor, "interface name longer than 15 characters");
        }
        name[length++] = (char)c;
        cursor->at++;
    }
    name[length] = '\0';
    if (length == 0) {
        return fail(cursor, "expected an interface name");
    }
    return take(cursor, ' ', "expected one space before the frame");
}

static bool take_identifier(struct cursor *cursor, struct can_msg *message)
{
    const size_t start = cursor->at;
    uint32_t id = 0;
    for (int value = hex_value(peek(cursor)); value >= 0; value = hex_value(peek(cursor))) {
        if (cursor->at - start == 8) {
            return fail(cursor, "identifier longer than eight digits");
        }
        id = id << 4 | (uint32_t)value;
        cursor->at++;
    }
    const size_t digits = cursor->at - start;
    if (digits != 3 && digits != 8) {
        return fail(cursor, "identifier needs three or eight digits 0-9A-F");
    }
    message->id = id;
    if (digits == 3) {
        message->flags = 0;
    } else if ((id & ERROR_FLAG_IN_LOG) != 0) {
        message->flags = CAN_FRAME_ERROR;
        message->id = id & (uint32_t)CAN_ID_EXTENDED_MAX;
    } else {
        message->flags = CAN_FRAME_EXTENDED;
    }
    const uint32_t max =
        digits == 3 ? (uint32_t)CAN_ID_STANDARD_MAX : (uint32_t)CAN_ID_EXTENDED_MAX;
    if (message->id > max || (id & UINT32_C(0xC0000000)) != 0) {
        cursor->at = start;
        return fail(cursor, "identifier out of range");
    }
    return take(cursor, '#', "expected '#' after the identifier");
}

static bool take_data(struct cursor *cursor, struct can_msg *message)
{
    if (peek(cursor) == 'R') {
        cursor->at++;
        message->flags |= CAN_FRAME_REMOTE;
        if (peek(cursor) >= '1' && peek(cursor) <= '8') {
            message->length = (uint8_t)(peek(cursor) - '0');
            cursor->at++;
        }
        return true;
    }
    while (cursor->at < cursor->length) {
        const int high = hex_value(peek(cursor));
        if (high < 0) {
            return fail(cursor, "expected two digits 0-9A-F per data byte");
        }
        if (message->length == CAN_FRAME_DATA_MAX) {
            return fail(cursor, "more than eight data bytes");
        }
        cursor->at++;
        const int low = hex_value(peek(cursor));
        if (low < 0) {
            return fail(cursor, "expected two digits 0-9A-F per data byte");
        }
        cursor->at++;
        message->data[message->length++] = (uint8_t)(high << 4 | low);
    }
    return true;
}

bool candump_parse(const char *line, size_t length, struct candump_record *record,
                   struct candump_error *error)
{
    if (length > 0 && line[length - 1] == '\n') {
        length--;
    }
    struct cursor cursor = {.text = line, .length = length, .error = error};
    memset(record, 0, sizeof *record);
    if (!take_time(&cursor, &record->time_us) || !take_interface(&cursor, record->interface_name) ||
        !take_identifier(&cursor, &record->message) || !take_data(&cursor, &record->message)) {
        return false;
    }
    if (cursor.at != length) {
        return fail(&cursor, "unexpected text after the frame");
    }
    return true;
}

enum candump_read_result candump_read(FILE *file, unsigned long *line_number,
                                      struct candump_record *record, struct candump_error *error)
{
    char line[LINE_READ_MAX];
    size_t length = 0;
    int c = 0;
    while (length < sizeof line && (c = getc(file)) != EOF) {
        line[length++] = (char)c;
        if (c == '\n') {
            break;
        }
    }
    *line_number += 1;
    error->line = *line_number;
    error->column = 1;
    if (c == EOF && ferror(file)) {
        error->reason = "cannot read the file";
        return CANDUMP_BAD;
    }
    if (length == 0) {
        return CANDUMP_END;
    }
    if (length == sizeof line && line[length - 1] != '\n') {
        error->column = LINE_READ_MAX;
        error->reason = "line too long";
        return CANDUMP_BAD;
    }
    if (line[length - 1] != '\n') {
        error->column = (unsigned)length + 1;
        error->reason = "last line is cut off: no line end";
        return CANDUMP_BAD;
    }
    return candump_parse(line, length, record, error) ? CANDUMP_RECORD : CANDUMP_BAD;
}
