#include "firmware/program_update.h"

#include <string.h>

#include "hal/canopen/co_defs.h"

void program_update_init(struct program_update *update, const struct program_slots *slots)
{
    struct program_scan scan;

    memset(update, 0, sizeof *update);
    update->slots = slots;
    update->status = PROGRAM_STATUS_NONE;
    if (slots != NULL) {
        /* The starter has checked all of it. */
        program_scan_begin(&scan, &slots->memory, slots->slot, slots->room, slots->hardware);
        update->identification = scan.header.crc;
        update->version = scan.header.version;
    }
}

/* An order is in the mark's page, a header in the stage's first. */
static bool forget(struct program_update *update)
{
    const struct program_slots *slots = update->slots;

    update->status = PROGRAM_STATUS_NONE;
    update->received = update->filled = 0;
    update->restart_in = 0;
    return slots->memory.erase(slots->memory.context, slots->mark);
}

static uint32_t fail(struct program_update *update, uint32_t status, uint32_t abort_code)
{
    update->status = status;
    return abort_code;
}

uint32_t program_update_begin(struct program_update *update, uint32_t total)
{
    if (update->slots == NULL) {
        return CO_ABORT_DEVICE_STATE;
    }
    if (total > update->slots->room) {
        return CO_ABORT_TOO_LONG;
    }
    if (!forget(update)) {
        return fail(update, PROGRAM_STATUS_WRITE, CO_ABORT_NOT_STORED);
    }
    update->status = PROGRAM_STATUS_BUSY;
    return CO_ABORT_NONE;
}

static bool put_word(struct program_update *update)
{
    const struct program_memory *memory = &update->slots->memory;
    const uint32_t address = update->slots->stage + update->received;

    if (update->received >= update->slots->room ||
        (update->received % memory->page_bytes == 0U && !memory->erase(memory->context, address)) ||
        !memory->write(memory->context, address, update->word)) {
        return false;
    }
    update->received += PROGRAM_WORD_BYTES;
    update->filled = 0;
    return true;
}

static uint32_t status_of(enum program_verdict verdict)
{
    switch (verdict) {
    case PROGRAM_GOOD:
        return PROGRAM_STATUS_GOOD;
    case PROGRAM_NO_HEADER:
        return PROGRAM_STATUS_FORMAT;
    case PROGRAM_OTHER_HARDWARE:
        return PROGRAM_STATUS_OTHER_BOARD;
    default:
        return PROGRAM_STATUS_DAMAGED;
    }
}

/* A sealed image is whole words, so none is left over. */
static uint32_t finish(struct program_update *update)
{
    const enum program_verdict verdict = program_slots_check_stage(update->slots, &update->staged);
    const bool whole = update->filled == 0U && update->staged.length == update->received;

    update->status =
        verdict == PROGRAM_GOOD && !whole ? (uint32_t)PROGRAM_STATUS_DAMAGED : status_of(verdict);
    return update->status == (uint32_t)PROGRAM_STATUS_GOOD ? CO_ABORT_NONE : CO_ABORT_VALUE;
}

uint32_t program_update_take(struct program_update *update, const uint8_t *bytes, unsigned length,
                             bool last)
{
    if (update->slots == NULL || update->status != (uint32_t)PROGRAM_STATUS_BUSY) {
        return CO_ABORT_DEVICE_STATE;
    }
    for (unsigned i = 0; i < length; i++) {
        update->word[update->filled++] = bytes[i];
        if (update->filled == (uint32_t)PROGRAM_WORD_BYTES && !put_word(update)) {
            return fail(update, PROGRAM_STATUS_WRITE, CO_ABORT_NOT_STORED);
        }
    }
    return last ? finish(update) : CO_ABORT_NONE;
}

static uint32_t order(struct program_update *update, bool also_older)
{
    if (update->status != (uint32_t)PROGRAM_STATUS_GOOD &&
        update->status != (uint32_t)PROGRAM_STATUS_OLDER) {
        return CO_ABORT_DEVICE_STATE;
    }
    if (update->staged.version < update->version && !also_older) {
        return fail(update, PROGRAM_STATUS_OLDER, CO_ABORT_DEVICE_STATE);
    }
    if (!program_slots_commit(update->slots, update->staged.crc)) {
        return fail(update, PROGRAM_STATUS_WRITE, CO_ABORT_NOT_STORED);
    }
    update->restart_in = PROGRAM_RESTART_TICKS;
    return CO_ABORT_NONE;
}

uint32_t program_update_control(struct program_update *update, uint8_t control)
{
    if (update->slots == NULL) {
        return CO_ABORT_DEVICE_STATE;
    }
    switch (control) {
    case PROGRAM_CONTROL_START:
    case PROGRAM_CONTROL_START_OLDER:
        return order(update, control == (uint8_t)PROGRAM_CONTROL_START_OLDER);
    case PROGRAM_CONTROL_CLEAR:
        return forget(update) ? CO_ABORT_NONE
                              : fail(update, PROGRAM_STATUS_WRITE, CO_ABORT_NOT_STORED);
    default:
        return CO_ABORT_VALUE;
    }
}

void program_update_tick(struct program_update *update)
{
    if (update->restart_in > 0U) {
        update->restart_in--;
        update->restart_now = update->restart_in == 0U;
    }
}
