#include "sim_host/ctl/object_list.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "controller/control_params.h"
#include "firmware/controller_objects.h"
#include "hal/canopen/co_device.h"
#include "sim_host/nodes/drive_node_type.h"
#include "sim_host/nodes/leg_sensor_node_type.h"
#include "sim_host/text/nearest.h"

enum { WORD_MAX = 48, PROFILE_FIRST = 0x6000, MAKERS_FIRST = 0x2000 };

/* Units that the dictionaries' names end with, and what is shown instead. */
static const struct {
    const char *text, *shown;
    double factor;
} units[] = {
    {"rad/s", "rad/s", 1.0}, {"mrad/s", "rad/s", 1e-3}, {"rad", "rad", 1.0},
    {"m", "m", 1.0},         {"um", "m", 1e-6},         {"nm", "m", 1e-9},
    {"mm", "m", 1e-3},       {"N", "N", 1.0},           {"degC", "degC", 1.0},
    {"V", "V", 1.0},         {"mV", "V", 1e-3},         {"A", "A", 1.0},
    {"mA", "A", 1e-3},       {"s", "s", 1.0},           {"ms", "s", 1e-3},
    {"us", "s", 1e-6},       {"mNm", "Nm", 1e-3},       {"counts/s", "counts/s", 1.0},
    {"%", "%", 1.0},         {"Hz", "Hz", 1.0},
};

/* ---- names --------------------------------------------------------------------- */

struct words {
    char word[12][WORD_MAX];
    size_t count;
};

/* Up to a comma, a parenthesis or the end. */
static void split(const char *text, struct words *words)
{
    const size_t length = strcspn(text, ",(;");
    size_t at = 0;
    words->count = 0;
    while (at < length && words->count < sizeof words->word / sizeof words->word[0]) {
        const size_t blanks = strspn(text + at, " ");
        const size_t letters = strcspn(text + at + blanks, " ");
        const size_t rest = length - at > blanks ? length - at - blanks : 0;
        const size_t taken = letters < rest ? letters : rest;
        if (taken > 0) {
            (void)snprintf(words->word[words->count++], WORD_MAX, "%.*s", (int)taken,
                           text + at + blanks);
        }
        at += blanks + letters;
    }
}

static bool begins_with_digit(const char *word)
{
    return isdigit((unsigned char)word[0]) != 0;
}

/* Takes "0.1 mrad/s" off the end of the words; what is shown is the number times *scale. */
static void take_unit(struct words *words, const char **unit, double *scale)
{
    for (size_t i = 0; i < sizeof units / sizeof units[0] && words->count > 1; i++) {
        const char *before = words->word[words->count - 2];
        char *end = NULL;
        if (strcmp(words->word[words->count - 1], units[i].text) != 0) {
            continue;
        }
        const double number = strtod(before, &end);
        if (begins_with_digit(before) && *end != '\0') {
            return; /* "2pi/2^16 rad": no unit of ours */
        }
        words->count -= begins_with_digit(before) ? 2 : 1;
        *unit = units[i].shown;
        *scale = units[i].factor * (begins_with_digit(before) ? number : 1.0);
        return;
    }
}

/* Small letters, digits and underscores; words up to the first that is a number. */
static void put_slug(const struct words *words, char *out, size_t size)
{
    size_t used = 0;
    for (size_t w = 0; w < words->count && (w == 0 || !begins_with_digit(words->word[w])); w++) {
        for (const char *c = words->word[w]; *c != '\0' && used + 2 < size; c++) {
            const bool is_plain = isalnum((unsigned char)*c) != 0;
            if (c == words->word[w] && w > 0 && used > 0 && out[used - 1] != '_') {
                out[used++] = '_';
            }
            if (is_plain) {
                out[used++] = (char)tolower((unsigned char)*c);
            } else if (used > 0 && out[used - 1] != '_') {
                out[used++] = '_';
            }
        }
    }
    while (used > 0 && out[used - 1] == '_') {
        used--;
    }
    out[used] = '\0';
}

static const struct control_param_descriptor *parameter_named(const char *name)
{
    for (size_t i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (strcmp(control_param_descriptors[i].name, name) == 0) {
            return &control_param_descriptors[i];
        }
    }
    return NULL;
}

/* The number that a person would have written for this float. */
static double plain(float value)
{
    char text[32];
    for (int digits = 6; digits <= 9; digits++) {
        (void)snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value) {
            break;
        }
    }
    return strtod(text, NULL);
}

static void describe(struct named_object *object, const struct words *leaf_words)
{
    const struct co_entry *entry = object->entry;
    struct words words = *leaf_words;
    object->unit = "";
    object->scale = 1.0;
    object->meaning = entry->name;
    take_unit(&words, &object->unit, &object->scale);
    const double step = entry->type == CO_REAL32 ? 1e-3 : object->scale;
    object->has_range = entry->low <= entry->high && (entry->access & CO_WRITE) != 0;
    object->low = entry->low * step;
    object->high = entry->high * step;
    const struct control_param_descriptor *parameter =
        entry->type == CO_REAL32 ? parameter_named(entry->name) : NULL;
    if (parameter != NULL) {
        object->unit = strcmp(parameter->unit, "-") == 0 ? "" : parameter->unit;
        object->has_range = true;
        object->low = plain(parameter->minimum);
        object->high = plain(parameter->maximum);
        object->meaning = parameter->meaning;
    }
}

static void add(struct object_list *list, const char *group, const struct co_entry *entry)
{
    struct named_object *object = &list->object[list->count];
    struct words words;
    char leaf[OBJECT_NAME_MAX / 2];
    const char *unit = "";
    double scale = 1.0;
    if (list->count == OBJECT_LIST_MAX) {
        return;
    }
    split(entry->name, &words);
    object->entry = entry;
    describe(object, &words);
    take_unit(&words, &unit, &scale);
    put_slug(&words, leaf, sizeof leaf);
    (void)snprintf(object->name, sizeof object->name, "%s%s%s", group, group[0] != '\0' ? "." : "",
                   leaf);
    object->leaf = group[0] != '\0' ? strlen(group) + 1 : 0;
    list->count++;
}

/* One object: a variable, or a group with its sub-indices but for their count. */
static void add_object(struct object_list *list, const struct co_entry *entry, size_t size)
{
    struct words words;
    char group[OBJECT_NAME_MAX / 2];
    if (size == 1 && entry->sub == 0) {
        add(list, "", entry);
        return;
    }
    split(entry->name, &words);
    put_slug(&words, group, sizeof group);
    for (size_t i = 0; i < size; i++) {
        if (entry[i].sub != 0) {
            add(list, group, &entry[i]);
        }
    }
}

static void add_table(struct object_list *list, const struct co_entry *table, size_t count,
                      uint16_t first_index)
{
    size_t at = 0;
    while (at < count) {
        size_t size = 1;
        while (at + size < count && table[at + size].index == table[at].index) {
            size++;
        }
        if (table[at].index >= first_index) {
            add_object(list, &table[at], size);
        }
        at += size;
    }
}

/* Names that two objects have get the sub-index behind them, or the index where that is the same. */
static void part_equal_names(struct object_list *list)
{
    static bool is_double[OBJECT_LIST_MAX];
    memset(is_double, 0, sizeof is_double);
    for (size_t i = 0; i < list->count; i++) {
        for (size_t k = i + 1; k < list->count; k++) {
            if (strcmp(list->object[i].name, list->object[k].name) == 0) {
                is_double[i] = is_double[k] = true;
            }
        }
    }
    for (size_t i = 0; i < list->count; i++) {
        struct named_object *object = &list->object[i];
        const size_t used = strlen(object->name);
        if (is_double[i]) {
            (void)snprintf(object->name + used, sizeof object->name - used, "_%04x_%u",
                           object->entry->index, object->entry->sub);
        }
    }
}

static int by_address(const void *a, const void *b)
{
    const struct co_entry *left = ((const struct named_object *)a)->entry;
    const struct co_entry *right = ((const struct named_object *)b)->entry;
    return ((int)left->index << 8 | left->sub) - ((int)right->index << 8 | right->sub);
}

void object_list_make(struct object_list *list, enum object_list_kind kind)
{
    list->count = 0;
    add_table(list, co_comm_objects, co_comm_object_count, 0);
    switch (kind) {
    case OBJECTS_OF_CONTROLLER:
        add_table(list, controller_comm_table, controller_comm_count, 0);
        add_table(list, controller_object_table, controller_object_count, 0);
        break;
    case OBJECTS_OF_DRIVE:
        add_table(list, drive_object_table, drive_object_count, MAKERS_FIRST);
        break;
    case OBJECTS_OF_ANY_DRIVE:
        add_table(list, drive_object_table, drive_object_count, PROFILE_FIRST);
        break;
    case OBJECTS_OF_LEG_SENSOR:
        add_table(list, leg_sensor_object_table, leg_sensor_object_count, MAKERS_FIRST);
        break;
    case OBJECTS_OF_ANY_NODE:
        break;
    }
    qsort(list->object, list->count, sizeof list->object[0], by_address);
    part_equal_names(list);
}

/* ---- finding --------------------------------------------------------------------- */

bool object_address_from_text(const char *text, uint16_t *index, uint8_t *sub)
{
    char *end = NULL;
    if (text[0] != '0' || (text[1] != 'x' && text[1] != 'X')) {
        return false;
    }
    const unsigned long number = strtoul(text + 2, &end, 16);
    unsigned long below = 0;
    if (end == text + 2 || number > UINT16_MAX) {
        return false;
    }
    if (*end == ':') {
        const char *begin = end + 1;
        below = strtoul(begin, &end, 16);
        if (end == begin || below > UINT8_MAX) {
            return false;
        }
    }
    *index = (uint16_t)number;
    *sub = (uint8_t)below;
    return *end == '\0';
}

static const struct named_object *at_address(const struct object_list *list, const char *text,
                                             char *message)
{
    uint16_t index;
    uint8_t sub;
    if (!object_address_from_text(text, &index, &sub)) {
        (void)snprintf(message, OBJECT_MESSAGE_MAX,
                       "\"%s\" is no address; write 0xINDEX:SUB, both hexadecimal", text);
        return NULL;
    }
    for (size_t i = 0; i < list->count; i++) {
        if (list->object[i].entry->index == index && list->object[i].entry->sub == sub) {
            return &list->object[i];
        }
    }
    (void)snprintf(message, OBJECT_MESSAGE_MAX, "0x%04X:%02X is not in this node's dictionary",
                   index, sub);
    return NULL;
}

static const char *leaf_of(const struct named_object *object)
{
    return object->name + object->leaf;
}

/* The only object of which `part` of its name is text, or begins with it; *count: how many are. */
static const struct named_object *only_one(const struct object_list *list, const char *text,
                                           bool whole, size_t *count)
{
    const size_t length = strlen(text);
    const struct named_object *found = NULL;
    *count = 0;
    for (size_t i = 0; i < list->count; i++) {
        const struct named_object *object = &list->object[i];
        const bool is_it = whole ? strcmp(leaf_of(object), text) == 0
                                 : strncmp(leaf_of(object), text, length) == 0 ||
                                       strncmp(object->name, text, length) == 0;
        if (is_it) {
            found = object;
            (*count)++;
        }
    }
    return *count == 1 ? found : NULL;
}

/* Text where several objects are meant, or none: those that begin so, else the nearest. */
static void refuse(const struct object_list *list, const char *text, char *message)
{
    size_t shown = 0, count = 0;
    (void)only_one(list, text, false, &count);
    if (count > 1) {
        size_t used = (size_t)snprintf(message, OBJECT_MESSAGE_MAX,
                                       "\"%s\" is one of %zu names:", text, count);
        for (size_t i = 0; i < list->count && shown < 5 && used < OBJECT_MESSAGE_MAX; i++) {
            if (object_is_meant(&list->object[i], text)) {
                used += (size_t)snprintf(message + used, OBJECT_MESSAGE_MAX - used, "%s %s",
                                         shown > 0 ? "," : "", list->object[i].name);
                shown++;
            }
        }
        return;
    }
    static const char *candidates[2 * OBJECT_LIST_MAX];
    for (size_t i = 0; i < list->count; i++) {
        candidates[2 * i] = list->object[i].name;
        candidates[2 * i + 1] = leaf_of(&list->object[i]);
    }
    const char *nearest =
        count == 1 ? NULL : nearest_name(text, candidates, 2 * list->count, sizeof candidates[0]);
    if (count == 1) {
        for (size_t i = 0; i < list->count; i++) {
            nearest = object_is_meant(&list->object[i], text) ? list->object[i].name : nearest;
        }
    }
    (void)snprintf(message, OBJECT_MESSAGE_MAX, "there is no object \"%s\"%s%s", text,
                   nearest != NULL ? "; nearest: " : "; `afo ctl names' lists all",
                   nearest != NULL ? nearest : "");
}

const struct named_object *object_list_find(const struct object_list *list, const char *text,
                                            bool may_complete, char *message)
{
    size_t count;
    if (text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
        return at_address(list, text, message);
    }
    for (size_t i = 0; i < list->count; i++) {
        if (strcmp(list->object[i].name, text) == 0) {
            return &list->object[i];
        }
    }
    const struct named_object *found = only_one(list, text, true, &count);
    if (found == NULL && count == 0 && may_complete && text[0] != '\0') {
        found = only_one(list, text, false, &count);
    }
    if (found == NULL) {
        refuse(list, text, message);
    }
    return found;
}

bool object_is_meant(const struct named_object *object, const char *word)
{
    const size_t length = strlen(word);
    return strncmp(object->name, word, length) == 0 ||
           (object->leaf > 0 && strncmp(leaf_of(object), word, length) == 0);
}
