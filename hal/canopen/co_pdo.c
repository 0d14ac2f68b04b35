#include "hal/canopen/co_pdo.h"

#include <string.h>

#include "hal/canopen/co_defs.h"

enum { DUMMY_INDEX_MAX = 0x1F };

uint32_t co_pdo_check_entry(uint32_t map, const struct co_dictionary *dictionaries,
                            unsigned dictionary_count, enum co_access direction,
                            struct co_pdo_slot *slot)
{
    const uint16_t index = (uint16_t)(map >> 16);
    const uint8_t sub = (uint8_t)(map >> 8 & 0xFFU);
    const unsigned bits = (unsigned)(map & 0xFFU);
    *slot = (struct co_pdo_slot){.entry = NULL};
    if (index <= DUMMY_INDEX_MAX) {
        const unsigned size = sub == 0 ? co_type_size((enum co_type)index) : 0;
        if (direction != CO_MAP_RX || size == 0 || bits != size * 8) {
            return CO_ABORT_NOT_MAPPABLE;
        }
        slot->size = (uint8_t)size;
        return CO_ABORT_NONE;
    }
    uint32_t refused;
    const struct co_entry *entry =
        co_od_find(dictionaries, dictionary_count, index, sub, &slot->base, &refused);
    if (entry == NULL) {
        return refused;
    }
    if ((entry->access & direction) == 0 || bits != entry->size * 8U) {
        return CO_ABORT_NOT_MAPPABLE;
    }
    slot->entry = entry;
    slot->size = entry->size;
    return CO_ABORT_NONE;
}

uint32_t co_pdo_resolve(struct co_pdo *pdo, unsigned count,
                        const struct co_dictionary *dictionaries, unsigned dictionary_count,
                        enum co_access direction)
{
    struct co_pdo_slot slots[CO_PDO_MAP_MAX];
    unsigned length = 0;
    if (count > CO_PDO_MAP_MAX) {
        return CO_ABORT_PDO_LENGTH;
    }
    for (unsigned i = 0; i < count; i++) {
        const uint32_t refused =
            co_pdo_check_entry(pdo->map[i], dictionaries, dictionary_count, direction, &slots[i]);
        if (refused != CO_ABORT_NONE) {
            return refused;
        }
        length += slots[i].size;
    }
    if (length > CAN_FRAME_DATA_MAX) {
        return CO_ABORT_PDO_LENGTH;
    }
    memcpy(pdo->slot, slots, count * sizeof slots[0]);
    pdo->map_count = (uint8_t)count;
    pdo->length = (uint8_t)length;
    return CO_ABORT_NONE;
}

unsigned co_pdo_pack(const struct co_pdo *pdo, uint8_t *out)
{
    uint8_t value[CO_VALUE_MAX];
    unsigned length = 0;
    for (unsigned i = 0; i < pdo->map_count; i++) {
        const struct co_pdo_slot *slot = &pdo->slot[i];
        (void)co_od_load(slot->entry, slot->base, value);
        memcpy(out + length, value, slot->size);
        length += slot->size;
    }
    return length;
}
