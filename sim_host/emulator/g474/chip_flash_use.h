/* Which words of flash a start depends on: those that the core fetches or loads before it writes
 * them itself, or programs without an erase of its own. Of the first bank, a load counts for 4 KiB, as
 * far as the start has not written them by then. So the set may be too large, but not too small.
 *
 * A start from power-on is determined by the flash (RAM holds the same anything after each cut). So two
 * starts from flash that agrees in all these words run alike. Only the bus and its nodes may
 * stand at another point of their period.
 */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_FLASH_USE_H
#define SIM_HOST_EMULATOR_G474_CHIP_FLASH_USE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "sim_host/emulator/g474/chip.h"

enum {
    CHIP_FLASH_WORDS = MODEL_PAGES * MODEL_PAGE_WORDS,
    CHIP_STARTS_MAX = 128 /* kept; a start beyond is run and not kept */
};

/* A set of words of flash. */
struct chip_word_set {
    uint8_t bit[CHIP_FLASH_WORDS / 8];
};

struct chip_flash_use {
    struct chip_word_set read, written;
    uint64_t word[MODEL_PAGES][MODEL_PAGE_WORDS]; /* as found at the start */
    uint8_t state[MODEL_PAGES][MODEL_PAGE_WORDS];
    uint32_t options;
};

/* Starts that ended well: what each read, and a checksum of that. In memory that processes share. */
struct chip_starts {
    atomic_uint count;
    struct {
        atomic_bool whole;
        struct chip_word_set read;
        uint64_t sum;
    } start[CHIP_STARTS_MAX];
};

/* From now on `chip` notes in `use`, which it keeps, what it reads (chip_flash_use_note and what follows
 * in chip.h). Not from a callback of the core. */
void chip_flash_use_begin(struct chip_flash_use *use, struct chip *chip);

/* True when the flash, as it is now, agrees with what one of the starts read. */
bool chip_starts_know(const struct chip_starts *starts, const struct flash_model *flash);
/* Keeps a start that ended well. */
void chip_starts_keep(struct chip_starts *starts, const struct chip_flash_use *use);

#endif
