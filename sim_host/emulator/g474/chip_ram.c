/* What RAM holds that nobody has written, and first stores that are lost. */
#include "sim_host/emulator/g474/chip.h"

#define RAM_BASE 0x20000000u
enum { PROGRAM_RAM_BYTES = 32 * 1024 /* which the starter tests, and leaves empty */ };

void chip_fill_ram(struct chip *chip, uint32_t bytes)
{
    uint32_t state = 0x2545F491u + chip->resets;

    for (uint32_t i = 0; i < bytes / 4; i++) {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        ((uint32_t *)(void *)chip->ram)[i] = state;
    }
}

void chip_begin_program(struct chip *chip)
{
    chip_flash_forget(chip);
    if (chip->dirty_ram) {
        chip_fill_ram(chip, PROGRAM_RAM_BYTES);
    }
}

/* RM0440, memory map: SRAM1 of 32, 32 and 16 KiB, SRAM2, CCM SRAM. */
static const uint32_t ram_end[CHIP_RAMS] = {0x8000, 0x10000, 0x14000, 0x18000, CHIP_RAM_BYTES};

static void on_access(void *context, uint32_t address, bool is_store)
{
    struct chip *chip = context;
    struct chip_first_stores *first = &chip->first_stores;
    const uint32_t offset = (address - RAM_BASE) & ~3u;
    unsigned ram = 0;

    while (offset >= ram_end[ram]) {
        ram++;
    }
    if (!first->touched[ram]) {
        first->touched[ram] = true;
        first->lost[ram] = is_store;
        first->offset[ram] = offset;
        first->word[ram] = *(const uint32_t *)(const void *)(chip->ram + offset);
    }
}

void chip_lose_first_stores(struct chip *chip)
{
    chip->first_stores = (struct chip_first_stores){.watched = true};
    core_watch_accesses(&chip->core, RAM_BASE, CHIP_RAM_BYTES, on_access);
}

bool chip_first_stores_are_over(struct chip *chip)
{
    struct chip_first_stores *first = &chip->first_stores;
    bool over = true;

    for (unsigned ram = 0; ram < CHIP_RAMS; ram++) {
        if (first->lost[ram]) {
            *(uint32_t *)(void *)(chip->ram + first->offset[ram]) = first->word[ram];
        }
        first->lost[ram] = false;
        over = over && first->touched[ram];
    }
    return over;
}

void chip_first_stores_end(struct chip *chip)
{
    chip->first_stores.watched = false;
    core_watch_accesses(&chip->core, RAM_BASE, CHIP_RAM_BYTES, NULL);
}
