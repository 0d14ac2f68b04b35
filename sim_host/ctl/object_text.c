#include "sim_host/ctl/object_text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "controller/supervisor/derate.h"
#include "controller/supervisor/supervisor.h"
#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"
#include "sim_host/cli/host_report.h"

enum { DRIVES_INDEX = 0x2021, SPARED_LEFT_SUB = 7, SPARED_RIGHT_SUB = 8, WITHDREW_SUB = 10 };
enum {
    STATE_INDEX = 0x2001,
    STATE_SUB = 1,
    FAULT_SUB = 2,
    STOP_BIT = 0x80,
    WEARER_BIT = 0x40,
    HEX_BYTES_SHOWN = 16
};

/* ---- numbers ------------------------------------------------------------------- */

static bool is_number_type(const struct co_entry *entry)
{
    return co_type_size((enum co_type)entry->type) > 0;
}

static double float_number(const uint8_t *bytes)
{
    const float value = bytes_get_f32(bytes);
    char text[32];
    for (int digits = 6; digits <= 9; digits++) { /* what a person would have written */
        (void)snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value) {
            break;
        }
    }
    return strtod(text, NULL);
}

bool object_number(const struct named_object *object, const struct object_value *value,
                   double *number)
{
    const struct co_entry *entry = object->entry;
    if (!is_number_type(entry) || value->length != entry->size) {
        return false;
    }
    *number = entry->type == CO_REAL32 ? float_number(value->bytes)
                                       : (double)co_od_number(entry, value->bytes) * object->scale;
    return true;
}

static void put_bytes(const struct object_value *value, char text[OBJECT_TEXT_MAX])
{
    size_t used = 0;
    for (size_t i = 0; i < value->length && i < HEX_BYTES_SHOWN; i++) {
        used += (size_t)snprintf(text + used, OBJECT_TEXT_MAX - used, "%s%02x", i > 0 ? " " : "",
                                 value->bytes[i]);
    }
    (void)snprintf(text + used, OBJECT_TEXT_MAX - used, "%s(%zu bytes)",
                   value->length > HEX_BYTES_SHOWN ? " .. "
                   : used > 0                      ? " "
                                                   : "",
                   value->length);
}

void object_value_text(const struct named_object *object, const struct object_value *value,
                       char text[OBJECT_TEXT_MAX])
{
    double number;
    if (object_number(object, value, &number)) {
        const bool is_float = object->entry->type == CO_REAL32;
        (void)snprintf(text, OBJECT_TEXT_MAX, "%.*g", is_float ? 9 : 12, number);
    } else if (object->entry->type == CO_VISIBLE_STRING) {
        const size_t most =
            value->length < OBJECT_TEXT_MAX - 1 ? value->length : OBJECT_TEXT_MAX - 1;
        for (size_t i = 0; i < most; i++) {
            const bool is_plain = value->bytes[i] >= ' ' && value->bytes[i] < 0x7F;
            text[i] = (char)(is_plain ? value->bytes[i] : '?');
        }
        text[most] = '\0';
    } else {
        put_bytes(value, text);
    }
}

/* ---- names of values ------------------------------------------------------------- */

/* The next word of a description: up to a blank, a semicolon or a comma. */
static const char *next_word(const char *at, size_t *length)
{
    while (*at == ' ' || *at == ';' || *at == ',') {
        at++;
    }
    *length = strcspn(at, " ;,");
    return at;
}

static bool whole_number(const char *word, size_t length, long *number)
{
    char *end = NULL;
    *number = strtol(word, &end, 10);
    return length > 0 && end == word + length && isdigit((unsigned char)word[0]) != 0;
}

/* Copies the words up to the next number, semicolon or end; "=" before them is left out. */
static const char *copy_label(const char *at, char *label, size_t size)
{
    size_t used = 0, length;
    long number;
    label[0] = '\0';
    for (;;) {
        const char *word = next_word(at, &length);
        const bool ends = memchr(at, ';', (size_t)(word - at)) != NULL && used > 0;
        if (length == 0 || ends || whole_number(word, length, &number)) {
            return at;
        }
        if (!(length == 1 && *word == '=')) {
            used += (size_t)snprintf(label + used, size - used, "%s%.*s", used > 0 ? " " : "",
                                     (int)length, word);
            used = used < size ? used : size - 1;
        }
        at = word + length;
    }
}

/* Walks through the values that a meaning names: "1 runs 2 done 3 to 5 refused". Numbers behind "bit"
 * are no values. Calls take until it returns true. */
static bool each_label(const char *meaning, bool (*take)(void *, long, long, const char *),
                       void *context)
{
    const char *at = meaning;
    bool is_bit = false;
    size_t length;
    for (const char *word = next_word(at, &length); length > 0; word = next_word(at, &length)) {
        long first, last;
        char label[OBJECT_TEXT_MAX / 2];
        at = word + length;
        if (!whole_number(word, length, &first)) {
            is_bit = length == 3 && strncmp(word, "bit", 3) == 0;
            continue;
        }
        last = first;
        const char *to = next_word(at, &length);
        if (length == 2 && strncmp(to, "to", 2) == 0) {
            const char *end = next_word(to + 2, &length);
            if (whole_number(end, length, &last)) {
                at = end + length;
            }
        }
        at = copy_label(at, label, sizeof label);
        if (!is_bit && label[0] != '\0' && take(context, first, last, label)) {
            return true;
        }
        is_bit = false;
    }
    return false;
}

struct search {
    long value;
    const char *name;
    char *text;
};

static bool take_value(void *context, long first, long last, const char *label)
{
    struct search *search = (struct search *)context;
    if (search->value < first || search->value > last) {
        return false;
    }
    (void)snprintf(search->text, OBJECT_TEXT_MAX, "%s", label);
    return true;
}

static bool take_name(void *context, long first, long last, const char *label)
{
    struct search *search = (struct search *)context;
    if (first != last || strcmp(label, search->name) != 0) {
        return false;
    }
    search->value = first;
    return true;
}

/* Why a drive is spared, and why the assistance was withdrawn: of the controller's 0x2021. */
static bool is_cause(const struct named_object *object)
{
    const struct co_entry *entry = object->entry;
    return entry->index == DRIVES_INDEX && object->leaf > 0 &&
           (entry->sub == SPARED_LEFT_SUB || entry->sub == SPARED_RIGHT_SUB ||
            entry->sub == WITHDREW_SUB);
}

void object_value_name(const struct named_object *object, const struct object_value *value,
                       char text[OBJECT_TEXT_MAX])
{
    double number;
    text[0] = '\0';
    if (!object_number(object, value, &number) || number != floor(number) || fabs(number) > 1e9) {
        return;
    }
    const struct co_entry *entry = object->entry;
    if (entry->index == STATE_INDEX && entry->sub == STATE_SUB && object->leaf > 0) {
        const unsigned bits = (unsigned)number;
        const unsigned state = bits & ~(unsigned)(STOP_BIT | WEARER_BIT);
        (void)snprintf(text, OBJECT_TEXT_MAX, "%s%s%s",
                       host_report_state_name((enum supervisor_state)state),
                       (bits & STOP_BIT) != 0 ? ", emergency stop pressed" : "",
                       (bits & WEARER_BIT) != 0 ? ", wearer's button pressed" : "");
    } else if (entry->index == STATE_INDEX && entry->sub == FAULT_SUB && object->leaf > 0) {
        (void)snprintf(text, OBJECT_TEXT_MAX, "%s",
                       supervisor_fault_name((enum supervisor_fault)(unsigned)number));
    } else if (is_cause(object)) {
        (void)snprintf(text, OBJECT_TEXT_MAX, "%s",
                       derate_cause_name((enum derate_cause)(unsigned)number));
    } else {
        struct search search = {(long)number, NULL, text};
        (void)each_label(object->meaning, take_value, &search);
    }
}

/* ---- writing -------------------------------------------------------------------- */

void object_range_text(const struct named_object *object, char text[OBJECT_TEXT_MAX])
{
    const char *blank = object->unit[0] != '\0' ? " " : "";
    text[0] = '\0';
    if (object->has_range) {
        (void)snprintf(text, OBJECT_TEXT_MAX, "%.9g .. %.9g%s%s", object->low, object->high, blank,
                       object->unit);
    } else {
        (void)snprintf(text, OBJECT_TEXT_MAX, "%s", object->unit);
    }
}

/* The least and the most that an integer of this type holds. */
static void bounds_of(const struct co_entry *entry, double *low, double *high)
{
    const bool is_signed = entry->type == CO_INTEGER8 || entry->type == CO_INTEGER16 ||
                           entry->type == CO_INTEGER24 || entry->type == CO_INTEGER32;
    const double span = ldexp(1.0, 8 * entry->size);
    *low = is_signed ? -span / 2.0 : 0.0;
    *high = (is_signed ? span / 2.0 : span) - 1.0;
}

static int put_integer(const struct named_object *object, const char *text, double number,
                       struct object_value *value, char *message)
{
    const double raw = number / object->scale;
    double low, high;
    bounds_of(object->entry, &low, &high);
    if (fabs(raw - round(raw)) > 1e-6 * fmax(1.0, fabs(raw))) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX, "%s takes whole multiples of %g %s, not %s",
                       object->name, object->scale, object->unit, text);
        return -1;
    }
    if (round(raw) < low || round(raw) > high) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX, "%s holds %.12g .. %.12g, not %s", object->name,
                       low * object->scale, high * object->scale, text);
        return -1;
    }
    value->length = object->entry->size;
    const uint64_t bits = (uint64_t)(int64_t)round(raw);
    for (size_t i = 0; i < value->length; i++) {
        value->bytes[i] = (uint8_t)(bits >> (8 * i) & 0xFFu);
    }
    return 0;
}

int object_value_from_text(const struct named_object *object, const char *text,
                           struct object_value *value, char *message)
{
    const struct co_entry *entry = object->entry;
    struct search search = {0, text, NULL};
    char *end = NULL;
    if ((entry->access & CO_WRITE) == 0) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX, "%s is only shown: it cannot be written",
                       object->name);
        return -1;
    }
    if (!is_number_type(entry)) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX, "%s is no number", object->name);
        return -1;
    }
    double number = strtod(text, &end);
    if (end == text && (text[0] == '0' || !each_label(object->meaning, take_name, &search))) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX, "%s: \"%s\" is no number (%s)", object->name,
                       text, object->meaning);
        return -1;
    }
    if (end == text) {
        number = (double)search.value;
    } else if (*end != '\0' || !isfinite(number)) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX,
                       "%s: \"%s\" is no number; write it without a unit, in %s", object->name,
                       text, object->unit[0] != '\0' ? object->unit : "plain digits");
        return -1;
    }
    if (entry->type != CO_REAL32) {
        return put_integer(object, text, number, value, message);
    }
    value->length = sizeof(float);
    bytes_put_u32(value->bytes, bytes_of_f32((float)number));
    return 0;
}

/* ---- refusals --------------------------------------------------------------------- */

static const struct {
    uint32_t code;
    const char *words, *remedy;
} refusals[] = {
    {CO_ABORT_TOGGLE, "the transfer lost its place",
     "another tool speaks with this node: try again"},
    {CO_ABORT_TIMEOUT, "the node gave the transfer up", "try again"},
    {CO_ABORT_COMMAND, "the node does not know this kind of transfer", "read it in another way"},
    {CO_ABORT_MEMORY, "the node has no memory for it", "nothing can be done from here"},
    {CO_ABORT_ACCESS, "the node does not allow it", "it may be locked: look at its manual"},
    {CO_ABORT_WRITE_ONLY, "it can only be written", "there is nothing to read"},
    {CO_ABORT_READ_ONLY, "it can only be read", "it is measured or fixed"},
    {CO_ABORT_NO_OBJECT, "the node has no such object",
     "is --node right, and the firmware as new as this program?"},
    {CO_ABORT_NO_SUB, "the object has no such sub-index", "read sub-index 0 for how many it has"},
    {CO_ABORT_NOT_MAPPABLE, "it cannot travel in a PDO", "look at the node's EDS"},
    {CO_ABORT_PDO_LENGTH, "the PDO would be longer than 8 bytes", "map less"},
    {CO_ABORT_LENGTH, "the node expects another size", "look at its type in the node's EDS"},
    {CO_ABORT_TOO_LONG, "the value has too many bytes", "look at its type in the node's EDS"},
    {CO_ABORT_TOO_SHORT, "the value has too few bytes", "look at its type in the node's EDS"},
    {CO_ABORT_VALUE, "the value does not fit the other settings", "change the others first"},
    {CO_ABORT_TOO_HIGH, "the value is too high",
     "choose a lower one; a gain must be one that this walker's gaits bear"},
    {CO_ABORT_TOO_LOW, "the value is too low",
     "choose a higher one; a gain must be one that this walker's gaits bear"},
    {CO_ABORT_GENERAL, "the node gives no reason", "try again"},
    {CO_ABORT_NOT_STORED, "the node cannot keep it",
     "a controller on a PC keeps no settings: write them under [prescription] of the person file"},
    {CO_ABORT_LOCAL_CONTROL, "the node is controlled locally", "hand control to the bus first"},
    {CO_ABORT_DEVICE_STATE, "not in this state",
     "stop first (`afo ctl stop'), stand still, and try again"},
};

void object_refusal_text(const struct named_object *object, uint32_t abort_code, bool wrote,
                         char *message)
{
    const char *words = "unknown reason", *remedy = "look the code up in the node's manual";
    char range[OBJECT_TEXT_MAX] = "";
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
        if (refusals[i].code == abort_code) {
            words = refusals[i].words;
            remedy = refusals[i].remedy;
        }
    }
    const bool is_range = abort_code == CO_ABORT_TOO_HIGH || abort_code == CO_ABORT_TOO_LOW ||
                          abort_code == CO_ABORT_VALUE;
    if (object != NULL && object->has_range && is_range) {
        object_range_text(object, range);
    }
    (void)snprintf(message, OBJECT_MESSAGE_MAX, "%s was not %s: %s (0x%08X); %s%s%s",
                   object != NULL ? object->name : "the object", wrote ? "written" : "read", words,
                   (unsigned)abort_code, remedy, range[0] != '\0' ? "; allowed is " : "", range);
}
