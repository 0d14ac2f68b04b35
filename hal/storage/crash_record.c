#include "hal/storage/crash_record.h"

#include <stddef.h>
#include <string.h>

#include "hal/storage/crc.h"

static uint32_t crc_of(const struct crash_record *record)
{
    return crc32_update(CRC32_INIT, record, offsetof(struct crash_record, crc));
}

static bool is_sealed(const struct crash_record *record)
{
    return record->magic == (uint32_t)CRASH_RECORD_MAGIC && record->crc == crc_of(record);
}

enum crash_cause crash_cause_of_reset(bool by_watchdog, bool by_supply, bool memory_kept)
{
    if (by_watchdog) {
        return CRASH_WATCHDOG;
    }
    return by_supply && memory_kept ? CRASH_SUPPLY : CRASH_NONE;
}

void crash_record_begin(struct crash_record *record)
{
    const uint32_t count = crash_record_count(record);

    memset(record, 0, sizeof *record);
    record->count = count;
}

void crash_record_seal(struct crash_record *record)
{
    record->magic = (uint32_t)CRASH_RECORD_MAGIC;
    if (record->count < UINT32_MAX) {
        record->count++;
    }
    record->crc = crc_of(record);
}

bool crash_record_is_valid(const struct crash_record *record)
{
    return is_sealed(record) && record->cause != (uint32_t)CRASH_NONE;
}

uint32_t crash_record_count(const struct crash_record *record)
{
    return is_sealed(record) ? record->count : 0U;
}

void crash_record_acknowledge(struct crash_record *record)
{
    if (is_sealed(record)) {
        record->cause = (uint32_t)CRASH_NONE;
        record->crc = crc_of(record);
    }
}
