/* Lines of logs, as they are written by candump -L and -l, by candump -t a, d or z on the screen, and by
 * python-can's CanutilsLogWriter. Facts: can-utils lib.c (snprintf_canframe, snprintf_long_canframe,
 * parse_canframe) and candump.c; can/io/canutils.py of python-can. */
#include <string.h>

#include "sim_host/log/candump_log.h"

enum { SECONDS_DIGITS_MAX = 12, MICROS_DIGITS = 6, NANOS_DIGITS = 9 };

static const uint32_t ERROR_FLAG_IN_LOG = UINT32_C(0x20000000);

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

static bool starts(const struct cursor *cursor, const char *word)
{
    const size_t length = strlen(word);
    return cursor->length - cursor->at >= length &&
           memcmp(cursor->text + cursor->at, word, length) == 0;
}

static bool skip_word(struct cursor *cursor, const char *word)
{
    if (!starts(cursor, word)) {
        return false;
    }
    cursor->at += strlen(word);
    return true;
}

static bool expect_char(struct cursor *cursor, char wanted, const char *reason)
{
    if (peek(cursor) != (unsigned char)wanted) {
        return fail(cursor, reason);
    }
    cursor->at++;
    return true;
}

static void skip_spaces(struct cursor *cursor)
{
    while (peek(cursor) == ' ') {
        cursor->at++;
    }
}

static bool is_decimal(int character)
{
    return character >= '0' && character <= '9';
}

static int hex_value(int character)
{
    if (is_decimal(character)) {
        return character - '0';
    }
    if (character >= 'A' && character <= 'F') {
        return character - 'A' + 10;
    }
    return -1;
}

/* Six digits, or nine of which the last three are dropped. */
static bool take_fraction(struct cursor *cursor, uint64_t *micros)
{
    unsigned digits = 0;
    *micros = 0;
    for (; is_decimal(peek(cursor)) && digits < NANOS_DIGITS; digits++) {
        if (digits < MICROS_DIGITS) {
            *micros = *micros * 10 + (uint64_t)(peek(cursor) - '0');
        }
        cursor->at++;
    }
    return digits == MICROS_DIGITS || digits == NANOS_DIGITS
               ? true
               : fail(cursor, "expected six digits of microseconds, or nine of nanoseconds");
}

static bool take_time(struct cursor *cursor, uint64_t *time_us)
{
    uint64_t seconds = 0;
    uint64_t micros = 0;
    unsigned digits = 0;
    skip_spaces(cursor);
    if (peek(cursor) != '(' && starts(cursor, "DROPCOUNT")) {
        return fail(cursor, "candump says that it lost frames here: nothing after it can be "
                            "replayed (candump -r 268435456 gives it a larger buffer)");
    }
    if (!expect_char(cursor, '(', "expected '(' before the time (as by candump -L, or -t a)")) {
        return false;
    }
    for (; is_decimal(peek(cursor)) && digits < SECONDS_DIGITS_MAX; digits++) {
        seconds = seconds * 10 + (uint64_t)(peek(cursor) - '0');
        cursor->at++;
    }
    if (digits == 4 && peek(cursor) == '-') {
        return fail(cursor, "a date, as by candump -t A: seconds are needed, as by candump -L");
    }
    if (digits == 0) {
        return fail(cursor, "expected digits of seconds");
    }
    if (!expect_char(cursor, '.', "expected '.' after the seconds") ||
        !take_fraction(cursor, &micros)) {
        return false;
    }
    *time_us = seconds * 1000000 + micros;
    return expect_char(cursor, ')', "expected ')' after the time") &&
           expect_char(cursor, ' ', "expected a space before the interface");
}

static bool take_interface(struct cursor *cursor, char *name)
{
    size_t length = 0;
    skip_spaces(cursor);
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
    return expect_char(cursor, ' ', "expected a space before the frame");
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
    return true;
}

static bool take_byte(struct cursor *cursor, struct can_msg *message)
{
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
    return true;
}

/* Eight bytes may have been announced as 9 to 15: _9 to _F (candump -8). */
static bool skip_raw_length(struct cursor *cursor, const struct can_msg *message)
{
    if (message->length == CAN_FRAME_DATA_MAX && peek(cursor) == '_') {
        cursor->at++;
        if (hex_value(peek(cursor)) <= CAN_FRAME_DATA_MAX) {
            return fail(cursor, "expected a length of 9 to F behind '_'");
        }
        cursor->at++;
    }
    return true;
}

/* ---- ID#DATA, as in log files ------------------------------------------------- */

/* Whether the frame was received or sent (candump -x, python-can): the same here. */
static void skip_direction(struct cursor *cursor)
{
    const size_t left = cursor->length - cursor->at;
    if (left == 2 && (starts(cursor, " R") || starts(cursor, " T"))) {
        cursor->at += 2;
    }
}

static bool take_compact(struct cursor *cursor, struct can_msg *message)
{
    if (peek(cursor) == '#') {
        return fail(cursor, "a CAN FD frame: the orthosis bus is classic CAN");
    }
    if (peek(cursor) == 'R') {
        cursor->at++;
        message->flags |= CAN_FRAME_REMOTE;
        if (peek(cursor) >= '1' && peek(cursor) <= '8') {
            message->length = (uint8_t)(peek(cursor) - '0');
            cursor->at++;
        }
    } else {
        while (hex_value(peek(cursor)) >= 0) {
            if (!take_byte(cursor, message)) {
                return false;
            }
        }
    }
    if (!skip_raw_length(cursor, message)) {
        return false;
    }
    skip_direction(cursor);
    return cursor->at == cursor->length
               ? true
               : fail(cursor, "expected two digits 0-9A-F per data byte, or R or T for the "
                              "direction, or the end of the line");
}

/* ---- columns, as on the screen ------------------------------------------------- */

/* candump -x: RX or TX, and two marks that CAN FD needs. */
static void skip_marks(struct cursor *cursor)
{
    if (skip_word(cursor, "RX ") || skip_word(cursor, "TX ")) {
        skip_spaces(cursor);
        while (peek(cursor) == '-' ||
               ((peek(cursor) == 'B' || peek(cursor) == 'E') && cursor->at + 1 < cursor->length &&
                cursor->text[cursor->at + 1] == ' ')) {
            cursor->at++;
            skip_spaces(cursor);
        }
    }
}

static bool take_length(struct cursor *cursor, unsigned *length)
{
    skip_spaces(cursor);
    if (!expect_char(cursor, '[', "expected '#' behind the identifier, or [length]")) {
        return false;
    }
    const size_t start = cursor->at;
    *length = 0;
    while (is_decimal(peek(cursor)) && cursor->at - start < 2) {
        *length = *length * 10 + (unsigned)(peek(cursor) - '0');
        cursor->at++;
    }
    if (cursor->at - start == 2) { /* FD lengths have two digits, also the short ones */
        return fail(cursor, "a CAN FD frame: the orthosis bus is classic CAN");
    }
    if (cursor->at == start || *length > CAN_FRAME_DATA_MAX) {
        return fail(cursor, "expected a length of 0 to 8");
    }
    return expect_char(cursor, ']', "expected ']' behind the length");
}

/* What candump writes for a reader behind the bytes. */
static bool is_remark(const struct cursor *cursor)
{
    return cursor->at == cursor->length || peek(cursor) == '\'' || starts(cursor, "ERRORFRAME");
}

static bool take_columns(struct cursor *cursor, struct can_msg *message)
{
    unsigned length;
    if (!take_length(cursor, &length)) {
        return false;
    }
    skip_spaces(cursor);
    if (skip_word(cursor, "remote request")) {
        message->flags |= CAN_FRAME_REMOTE;
        message->length = (uint8_t)length;
        return cursor->at == cursor->length ? true : fail(cursor, "unexpected text");
    }
    while (message->length < length) {
        if (peek(cursor) == '`') {
            return fail(cursor, "bytes in swapped order (candump -S): log without -S");
        }
        if (!take_byte(cursor, message)) {
            return false;
        }
        if (peek(cursor) == ' ') {
            skip_spaces(cursor);
        } else if (cursor->at < cursor->length) {
            return fail(cursor, "expected a space between data bytes");
        }
    }
    skip_spaces(cursor);
    return is_remark(cursor) ? true : fail(cursor, "unexpected text after the frame");
}

bool candump_parse(const char *line, size_t length, struct candump_record *record,
                   struct candump_error *error)
{
    while (length > 0 && (line[length - 1] == '\n' || line[length - 1] == '\r' ||
                          line[length - 1] == ' ' || line[length - 1] == '\t')) {
        length--;
    }
    struct cursor cursor = {.text = line, .length = length, .error = error};
    memset(record, 0, sizeof *record);
    if (!take_time(&cursor, &record->time_us) || !take_interface(&cursor, record->interface_name)) {
        return false;
    }
    skip_spaces(&cursor);
    skip_marks(&cursor);
    if (!take_identifier(&cursor, &record->message)) {
        return false;
    }
    if (peek(&cursor) == '#') {
        cursor.at++;
        return take_compact(&cursor, &record->message);
    }
    return take_columns(&cursor, &record->message);
}
