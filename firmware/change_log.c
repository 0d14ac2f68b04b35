#include "firmware/change_log.h"

#include <assert.h>

static_assert(sizeof(struct change_record) == CHANGE_LOG_RECORD_BYTES,
              "the same bytes everywhere: a tool reads them");

void change_log_note(struct change_log *log, const struct change_record *record)
{
    if (log->number < UINT32_MAX) {
        log->number++;
    }
    struct change_record *place = &log->record[(log->number - 1u) % CHANGE_LOG_RECORDS];
    *place = *record;
    place->number = log->number;
}
