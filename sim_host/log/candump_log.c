#include "sim_host/log/candump_log.h"

#include <assert.h>
#include <string.h>

enum { SECONDS_DIGITS = 10, MICROS_DIGITS = 6, LINE_READ_MAX = 192 };

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

/* A line without anything in it: some editors put one at the end. */
static bool is_blank(const char *line, size_t length)
{
    size_t at = 0;
    while (at < length && (line[at] == ' ' || line[at] == '\t' || line[at] == '\r')) {
        at++;
    }
    return at == length || line[at] == '\n';
}

static enum candump_read_result read_line(FILE *file, unsigned long *line_number,
                                          struct candump_record *record,
                                          struct candump_error *error, bool *blank)
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
    *blank = is_blank(line, length);
    return *blank || candump_parse(line, length, record, error) ? CANDUMP_RECORD : CANDUMP_BAD;
}

enum candump_read_result candump_read(FILE *file, unsigned long *line_number,
                                      struct candump_record *record, struct candump_error *error)
{
    enum candump_read_result result;
    bool blank;
    do {
        blank = false;
        result = read_line(file, line_number, record, error, &blank);
    } while (blank);
    return result;
}
