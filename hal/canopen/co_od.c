#include "hal/canopen/co_od.h"

#include <stdbool.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"

unsigned co_type_size(enum co_type type)
{
    switch (type) {
    case CO_BOOLEAN:
    case CO_INTEGER8:
    case CO_UNSIGNED8:
        return 1;
    case CO_INTEGER16:
    case CO_UNSIGNED16:
        return 2;
    case CO_INTEGER24:
    case CO_UNSIGNED24:
        return 3;
    case CO_INTEGER32:
    case CO_UNSIGNED32:
    case CO_REAL32:
        return 4;
    case CO_VISIBLE_STRING:
    case CO_DOMAIN:
        return 0;
    }
    return 0;
}

static uint32_t key_of(const struct co_entry *entry)
{
    return (uint32_t)entry->index << 8 | entry->sub;
}

/* Most objects asked for are of one dictionary, and each spans a range of indexes. */
static bool may_hold(const struct co_dictionary *dictionary, uint16_t index)
{
    return dictionary->count > 0 && dictionary->entries[0].index <= index &&
           dictionary->entries[dictionary->count - 1U].index >= index;
}

/* Position of the first entry that is not below `wanted`. */
static unsigned lower_bound(const struct co_dictionary *dictionary, uint32_t wanted)
{
    unsigned low = 0;
    unsigned high = dictionary->count;
    while (low < high) {
        const unsigned middle = (low + high) / 2;
        if (key_of(&dictionary->entries[middle]) < wanted) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

const struct co_entry *co_od_find(const struct co_dictionary *dictionaries, unsigned count,
                                  uint16_t index, uint8_t sub, void **base, uint32_t *abort_code)
{
    *abort_code = CO_ABORT_NO_OBJECT;
    for (unsigned i = 0; i < count; i++) {
        const struct co_dictionary *dictionary = &dictionaries[i];
        const struct co_entry *entries = dictionary->entries;
        if (!may_hold(dictionary, index)) {
            continue;
        }
        const uint32_t wanted = (uint32_t)index << 8 | sub;
        const unsigned at = lower_bound(dictionary, wanted);
        if (at < dictionary->count && key_of(&entries[at]) == wanted) {
            *base = dictionary->base;
            *abort_code = CO_ABORT_NONE;
            return &entries[at];
        }
        /* The other subs of an index stand beside the place of the missing one. */
        if ((at < dictionary->count && entries[at].index == index) ||
            (at > 0 && entries[at - 1U].index == index)) {
            *abort_code = CO_ABORT_NO_SUB;
        }
    }
    return NULL;
}

static uint32_t load_bits(const struct co_entry *entry, const uint8_t *value)
{
    uint32_t bits32;
    uint16_t bits16;
    switch (entry->size) {
    case 1:
        return *value;
    case 2:
        memcpy(&bits16, value, sizeof bits16);
        return bits16;
    default: /* 24-bit values live in 32 bits */
        memcpy(&bits32, value, sizeof bits32);
        return bits32;
    }
}

unsigned co_od_load(const struct co_entry *entry, const void *base, uint8_t *out)
{
    const uint8_t *value = (const uint8_t *)base + entry->offset;
    if (entry->type == CO_VISIBLE_STRING) {
        unsigned length = 0;
        while (length < CO_VALUE_MAX && length < entry->size && value[length] != 0) {
            out[length] = value[length];
            length++;
        }
        return length;
    }
    const uint32_t bits = load_bits(entry, value);
    for (unsigned i = 0; i < entry->size; i++) {
        out[i] = (uint8_t)(bits >> (8 * i) & 0xFFU);
    }
    return entry->size;
}

int64_t co_od_number(const struct co_entry *entry, const uint8_t *bytes)
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < entry->size && i < 4; i++) {
        bits |= (uint32_t)bytes[i] << (8 * i);
    }
    switch (entry->type) {
    case CO_INTEGER8:
        return (int8_t)bits;
    case CO_INTEGER16:
        return (int16_t)bits;
    case CO_INTEGER24:
        return bytes_get_i24(bytes);
    case CO_INTEGER32:
        return (int32_t)bits;
    default:
        return bits;
    }
}

static uint32_t check_limits(const struct co_entry *entry, const uint8_t *bytes)
{
    if (entry->type == CO_REAL32) {
        const uint32_t bits = bytes_get_u32(bytes);
        float value;
        memcpy(&value, &bits, sizeof value);
        if (!(value - value == 0.0f)) {
            return CO_ABORT_VALUE; /* infinite or not a number */
        }
        if (entry->low > entry->high) {
            return CO_ABORT_NONE;
        }
        if (value > (float)entry->high / 1000.0f) {
            return CO_ABORT_TOO_HIGH;
        }
        return value < (float)entry->low / 1000.0f ? CO_ABORT_TOO_LOW : CO_ABORT_NONE;
    }
    const int64_t value = co_od_number(entry, bytes);
    if (entry->type == CO_BOOLEAN && value > 1) {
        return CO_ABORT_TOO_HIGH;
    }
    if (entry->low > entry->high) {
        return CO_ABORT_NONE;
    }
    if (value > entry->high) {
        return CO_ABORT_TOO_HIGH;
    }
    return value < entry->low ? CO_ABORT_TOO_LOW : CO_ABORT_NONE;
}

uint32_t co_od_check(const struct co_entry *entry, const uint8_t *bytes, unsigned length)
{
    if (length > entry->size) {
        return CO_ABORT_TOO_LONG;
    }
    if (entry->type == CO_VISIBLE_STRING) {
        return CO_ABORT_NONE;
    }
    return length < entry->size ? CO_ABORT_TOO_SHORT : check_limits(entry, bytes);
}

static void put_bits(uint8_t *value, unsigned size, uint32_t bits)
{
    const uint16_t bits16 = (uint16_t)bits;
    if (size == 1) {
        *value = (uint8_t)bits;
    } else if (size == 2) {
        memcpy(value, &bits16, sizeof bits16);
    } else { /* 24-bit values live in 32 bits */
        memcpy(value, &bits, sizeof bits);
    }
}

uint32_t co_od_store(const struct co_entry *entry, void *base, const uint8_t *bytes,
                     unsigned length)
{
    const uint32_t refused = co_od_check(entry, bytes, length);
    if (refused != CO_ABORT_NONE) {
        return refused;
    }
    uint8_t *value = (uint8_t *)base + entry->offset;
    if (entry->type == CO_VISIBLE_STRING) {
        /*@ split length; */
        memcpy(value, bytes, length);
        memset(value + length, 0, entry->size - length);
        return CO_ABORT_NONE;
    }
    put_bits(value, entry->size, (uint32_t)co_od_number(entry, bytes));
    return CO_ABORT_NONE;
}
