#include "sim_host/devices/device_text.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/text/nearest.h"
#include "sim_host/text/number_text.h"

enum { WORDS_MAX = 32, WORD_MAX = 32 };

/* The words of a key's unit, "a|b|c". */
struct words {
    int count;
    char text[WORDS_MAX][WORD_MAX];
    const char *pointer[WORDS_MAX];
};

static void split(const char *list, struct words *words)
{
    words->count = 0;
    while (words->count < WORDS_MAX) {
        const size_t length = strcspn(list, "|");
        snprintf(words->text[words->count], WORD_MAX, "%.*s", (int)length, list);
        words->pointer[words->count] = words->text[words->count];
        words->count++;
        if (list[length] == '\0') {
            return;
        }
        list += length + 1;
    }
}

const char *device_leg_name(int leg)
{
    return leg < 0 ? "device" : leg == SIDE_LEFT ? "left leg" : "right leg";
}

static void flags_text(const struct words *words, uint32_t flags, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < words->count && used < size; i++) {
        if ((flags >> i & 1u) != 0) {
            used += (size_t)snprintf(text + used, size - used, "%s%s", used > 0 ? ", " : "",
                                     words->text[i]);
        }
    }
    if (flags == 0) {
        snprintf(text, size, "nothing");
    }
}

void device_value_text(const struct device_key *row, double value, char *text, size_t size)
{
    struct words words;
    const uint32_t bits = value > 0.0 ? (uint32_t)value : 0u;
    switch ((enum device_key_type)row->type) {
    case DEVICE_WORD:
        split(row->unit, &words);
        snprintf(text, size, "%s",
                 bits < (uint32_t)words.count ? words.text[bits] : "no word of this key");
        break;
    case DEVICE_FLAGS:
        split(row->unit, &words);
        flags_text(&words, bits, text, size);
        break;
    case DEVICE_OBJECT:
        snprintf(text, size, bits == 0 ? "none" : "0x%04X:%02X", bits >> 8, bits & 0xFFu);
        break;
    case DEVICE_INT:
        snprintf(text, size, "%.0f", value);
        break;
    default:
        number_text(value, text, size);
    }
}

static int read_number(const struct device_key *row, const char *text, double *value, char *message,
                       size_t size)
{
    char *end = NULL;
    errno = 0;
    const double number = strtod(text, &end);
    if (end == text || *end != '\0' || errno == ERANGE || !isfinite(number)) {
        snprintf(message, size, "\"%.40s\" is not a number", text);
        return -1;
    }
    if (row->type == DEVICE_INT && number != floor(number)) {
        snprintf(message, size, "%.40s is not a whole number", text);
        return -1;
    }
    if (number < (double)row->minimum || number > (double)row->maximum) {
        snprintf(message, size, "%.40s is out of range, allowed is %g to %g %s", text,
                 (double)row->minimum, (double)row->maximum, row->unit);
        return -1;
    }
    *value = number;
    return 0;
}

static int read_word(const struct words *words, const char *text, double *value, char *message,
                     size_t size)
{
    for (int i = 0; i < words->count; i++) {
        if (strcmp(words->text[i], text) == 0) {
            *value = (double)i;
            return 0;
        }
    }
    nearest_refuse(text, words->pointer, (size_t)words->count, sizeof words->pointer[0], message,
                   size);
    return -1;
}

static int read_flags(const struct words *words, const char *text, double *value, char *message,
                      size_t size)
{
    uint32_t flags = 0;
    double bit = 0.0;
    if (strcmp(text, "nothing") == 0) {
        *value = 0.0;
        return 0;
    }
    while (*text != '\0') {
        char word[WORD_MAX];
        const size_t length = strcspn(text, ", ");
        snprintf(word, sizeof word, "%.*s", (int)length, text);
        if (read_word(words, word, &bit, message, size) != 0) {
            return -1;
        }
        flags |= UINT32_C(1) << (unsigned)bit;
        text += length;
        text += strspn(text, ", ");
    }
    *value = (double)flags;
    return 0;
}

static int read_object(const char *text, double *value, char *message, size_t size)
{
    char *end = NULL;
    if (strcmp(text, "none") == 0) {
        *value = 0.0;
        return 0;
    }
    const unsigned long index = strtoul(text, &end, 16);
    if (end != text && *end == ':' && index >= 0x1000 && index <= 0xFFFF) {
        const char *from = end + 1;
        const unsigned long sub = strtoul(from, &end, 16);
        if (end != from && *end == '\0' && sub <= 0xFF) {
            *value = (double)(index << 8 | sub);
            return 0;
        }
    }
    snprintf(message, size,
             "\"%.40s\" is no object; write index and sub-index, as 0x2101:00, or none", text);
    return -1;
}

int device_value_read(const struct device_key *row, const char *text, double *value, char *message,
                      size_t size)
{
    struct words words;
    switch ((enum device_key_type)row->type) {
    case DEVICE_WORD:
        split(row->unit, &words);
        return read_word(&words, text, value, message, size);
    case DEVICE_FLAGS:
        split(row->unit, &words);
        return read_flags(&words, text, value, message, size);
    case DEVICE_OBJECT:
        return read_object(text, value, message, size);
    default:
        return read_number(row, text, value, message, size);
    }
}

const char *device_verdict_text(enum device_verdict verdict)
{
#define TEXT(code, number, text) [number] = (text),
    static const char *const texts[] = {DEVICE_VERDICTS(TEXT)};
#undef TEXT
    const bool is_known =
        (size_t)verdict < sizeof texts / sizeof texts[0] && texts[verdict] != NULL;
    return is_known ? texts[verdict] : "is refused";
}

/* Behind the verdict: what would be right. */
static void allowed_text(const struct device_refusal *refusal, const struct device_key *row,
                         char *text, size_t size)
{
    switch (refusal->verdict) {
    case DEVICE_BAD_RANGE:
        snprintf(text, size, ", allowed is %g to %g %s", (double)row->minimum, (double)row->maximum,
                 row->unit);
        break;
    case DEVICE_BAD_SCALE:
    case DEVICE_BAD_TORQUE:
    case DEVICE_BAD_SPRINGS:
    case DEVICE_BAD_LATENCIES:
    case DEVICE_BAD_TICK:
    case DEVICE_BAD_BITRATE:
        snprintf(text, size, ", which is %.7g %s", (double)refusal->allowed, row->unit);
        break;
    case DEVICE_BAD_LIMIT_ORDER:
        snprintf(text, size, " %.4g %s or more, with a counterpart above 0",
                 (double)refusal->allowed, row->unit);
        break;
    case DEVICE_BAD_NUMBER:
        snprintf(text, size, ", %g", (double)refusal->allowed);
        break;
    case DEVICE_BAD_STROKE_FIELD:
        snprintf(text, size, ", %g rad", (double)refusal->allowed);
        break;
    case DEVICE_BAD_ID_TAKEN:
        snprintf(text, size, ", such as 0x%03X", (unsigned)refusal->allowed);
        break;
    default:
        text[0] = '\0';
    }
}

void device_refusal_text(const struct device_refusal *refusal, char *message, size_t size)
{
    const struct device_key *row = device_key_row(refusal->leg, refusal->key);
    char found[DEVICE_VALUE_TEXT_MAX], allowed[96];
    device_value_text(row, (double)refusal->found, found, sizeof found);
    allowed_text(refusal, row, allowed, sizeof allowed);
    snprintf(message, size, "%s, key \"%s\" (%s): %s%s%s %s%s", device_leg_name(refusal->leg),
             row->name, row->meaning, found, row->type == DEVICE_FLOAT ? " " : "",
             row->type == DEVICE_FLOAT ? row->unit : "", device_verdict_text(refusal->verdict),
             allowed);
}
