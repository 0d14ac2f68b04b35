/* What RAM holds that nobody has written. */
#include "sim_host/emulator/g474/chip.h"

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
