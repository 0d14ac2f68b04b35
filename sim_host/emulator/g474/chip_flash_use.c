#include "sim_host/emulator/g474/chip_flash_use.h"

#include <string.h>

#define FLASH_BASE 0x08000000u

static bool has(const struct chip_word_set *set, uint32_t word)
{
    return ((unsigned)set->bit[word / 8] >> word % 8 & 1u) != 0;
}

static void add(struct chip_word_set *set, uint32_t word)
{
    set->bit[word / 8] = (uint8_t)(set->bit[word / 8] | 1u << word % 8);
}

void chip_flash_use_begin(struct chip_flash_use *use, struct chip *chip)
{
    const struct flash_model *flash = &chip->flash_registers;

    memset(&use->read, 0, sizeof use->read);
    memset(&use->written, 0, sizeof use->written);
    memcpy(use->word, flash->word, sizeof use->word);
    memcpy(use->state, flash->state, sizeof use->state);
    use->options = flash->optr_stored;
    chip->flash_use = use;
    chip_flash_use_note(chip, 0, CHIP_STARTER_BYTES); /* always open */
    core_close_pages(&chip->core);
}

void chip_flash_use_note(struct chip *chip, uint32_t offset, uint32_t bytes)
{
    struct chip_flash_use *use = chip->flash_use;

    if (use == NULL || offset >= (uint32_t)CHIP_FLASH_BYTES) {
        return;
    }
    for (uint32_t word = offset / 8; word <= (offset + bytes - 1) / 8; word++) {
        if (word < (uint32_t)CHIP_FLASH_WORDS && !has(&use->written, word)) {
            add(&use->read, word);
        }
    }
}

void chip_flash_use_load(struct chip *chip, uint32_t address)
{
    chip_flash_use_note(chip, (address - FLASH_BASE) & ~(uint32_t)(CORE_PAGE_BYTES - 1),
                        CORE_PAGE_BYTES);
    core_open_page(&chip->core, address);
}

void chip_flash_use_change(struct chip *chip, uint32_t offset, uint32_t bytes)
{
    struct chip_flash_use *use = chip->flash_use;

    if (use == NULL) {
        return;
    }
    if (bytes == 8) { /* a word can be programmed only if it was erased */
        chip_flash_use_note(chip, offset, bytes);
    }
    for (uint32_t word = offset / 8; word < (offset + bytes) / 8; word++) {
        add(&use->written, word);
    }
}

/* FNV-1a, a word and its state at a time. */
static uint64_t sum_of(const struct chip_word_set *read, const uint64_t *word, const uint8_t *state,
                       uint32_t options)
{
    uint64_t sum = UINT64_C(0xCBF29CE484222325) ^ options;

    for (uint32_t i = 0; i < (uint32_t)CHIP_FLASH_WORDS; i++) {
        if (i % 8 == 0 && read->bit[i / 8] == 0) {
            i += 7;
        } else if (has(read, i)) {
            sum = (sum ^ i) * UINT64_C(0x100000001B3);
            sum = (sum ^ state[i]) * UINT64_C(0x100000001B3);
            sum = (sum ^ (uint32_t)word[i]) * UINT64_C(0x100000001B3);
            sum = (sum ^ word[i] >> 32) * UINT64_C(0x100000001B3);
        }
    }
    return sum;
}

bool chip_starts_know(const struct chip_starts *starts, const struct flash_model *flash)
{
    const unsigned count = atomic_load(&starts->count);

    for (unsigned i = 0; i < count && i < (unsigned)CHIP_STARTS_MAX; i++) {
        if (atomic_load(&starts->start[i].whole) &&
            starts->start[i].sum == sum_of(&starts->start[i].read, &flash->word[0][0],
                                           &flash->state[0][0], flash->optr_stored)) {
            return true;
        }
    }
    return false;
}

void chip_starts_keep(struct chip_starts *starts, const struct chip_flash_use *use)
{
    const unsigned place = atomic_fetch_add(&starts->count, 1u);

    if (place < (unsigned)CHIP_STARTS_MAX) {
        starts->start[place].read = use->read;
        starts->start[place].sum =
            sum_of(&use->read, &use->word[0][0], &use->state[0][0], use->options);
        atomic_store(&starts->start[place].whole, true);
    }
}
