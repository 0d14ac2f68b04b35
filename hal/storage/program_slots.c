#include "hal/storage/program_slots.h"

#include <string.h>

#include "hal/bus/bytes.h"

static bool is_erased(const uint8_t *word)
{
    for (uint32_t i = 0; i < PROGRAM_WORD_BYTES; i++) {
        if (word[i] != 0xFFU) {
            return false;
        }
    }
    return true;
}

static bool write_mark(const struct program_slots *slots, uint32_t place, uint32_t magic,
                       uint32_t crc)
{
    uint8_t word[PROGRAM_WORD_BYTES];

    bytes_put_u32(word, magic);
    bytes_put_u32(word + 4, crc);
    return slots->memory.write(slots->memory.context, slots->mark + place, word);
}

enum program_verdict program_slots_check_stage(const struct program_slots *slots,
                                               struct program_header *header)
{
    return program_check(&slots->memory, slots->stage, slots->room, slots->hardware, header);
}

enum program_verdict program_slots_check(const struct program_slots *slots,
                                         struct program_header *header)
{
    return program_check(&slots->memory, slots->slot, slots->room, slots->hardware, header);
}

bool program_slots_commit(const struct program_slots *slots, uint32_t crc)
{
    return slots->memory.erase(slots->memory.context, slots->mark) &&
           write_mark(slots, 0, PROGRAM_COMMIT, crc);
}

/* The CRC of the image that is ordered; false without an order. */
static bool read_order(const struct program_slots *slots, uint32_t *crc)
{
    uint8_t commit[PROGRAM_WORD_BYTES], done[PROGRAM_WORD_BYTES];

    if (!slots->memory.read(slots->memory.context, slots->mark, commit) ||
        bytes_get_u32(commit) != (uint32_t)PROGRAM_COMMIT ||
        !slots->memory.read(slots->memory.context, slots->mark + PROGRAM_WORD_BYTES, done)) {
        return false;
    }
    *crc = bytes_get_u32(commit + 4);
    return is_erased(done);
}

bool program_slots_is_ordered(const struct program_slots *slots)
{
    uint32_t crc;
    return read_order(slots, &crc);
}

static bool copy_word(const struct program_slots *slots, uint32_t offset)
{
    const struct program_memory *memory = &slots->memory;
    uint8_t word[PROGRAM_WORD_BYTES];

    return memory->read(memory->context, slots->stage + offset, word) &&
           memory->write(memory->context, slots->slot + offset, word);
}

static bool copy(const struct program_slots *slots, uint32_t length)
{
    const struct program_memory *memory = &slots->memory;

    for (uint32_t offset = 0; offset < length; offset += PROGRAM_WORD_BYTES) {
        if (offset % memory->page_bytes == 0U &&
            !memory->erase(memory->context, slots->slot + offset)) {
            return false;
        }
        if (!copy_word(slots, offset)) {
            return false;
        }
    }
    return true;
}

bool program_slots_install(const struct program_slots *slots)
{
    struct program_header header;
    uint32_t crc;

    if (!read_order(slots, &crc) || program_slots_check_stage(slots, &header) != PROGRAM_GOOD ||
        header.crc != crc || !copy(slots, header.length)) {
        return false;
    }
    return program_slots_check(slots, &header) == PROGRAM_GOOD && header.crc == crc &&
           write_mark(slots, PROGRAM_WORD_BYTES, PROGRAM_DONE, crc);
}
