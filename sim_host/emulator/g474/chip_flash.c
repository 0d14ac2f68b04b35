/* What the core fetches from the first bank, kept as the flash model holds it. */
#include <string.h>

#include "sim_host/emulator/g474/chip.h"

/* The core reads the new bytes at once. What it has translated of the old ones is forgotten later:
 * nobody runs what is being written. */
void chip_flash_changed(void *context, uint32_t offset, uint32_t bytes)
{
    struct chip *chip = context;
    const bool none = chip->changed_from == chip->changed_to;

    chip_flash_use_change(chip, offset, bytes);
    if (offset < (uint32_t)CHIP_BANK_BYTES) {
        memcpy(chip->flash + offset, (const uint8_t *)chip->flash_registers.word + offset, bytes);
        chip->changed_from = none || offset < chip->changed_from ? offset : chip->changed_from;
        chip->changed_to =
            none || offset + bytes > chip->changed_to ? offset + bytes : chip->changed_to;
    }
}

void chip_erase(struct chip *chip, uint32_t offset, uint32_t bytes)
{
    memset((uint8_t *)chip->flash_registers.word + offset, 0xFF, bytes);
    chip_flash_changed(chip, offset & ~7u, bytes);
    chip_flash_forget(chip);
}

void chip_damage(struct chip *chip, uint32_t offset)
{
    chip->flash_registers.word[offset / 2048][offset % 2048 / 8] ^= 4;
    chip_flash_changed(chip, offset, 8);
    chip_flash_forget(chip);
}

void chip_flash_forget(struct chip *chip)
{
    const uint32_t from = chip->changed_from, count = chip->changed_to - from;

    if (count > 0) {
        chip->changed_from = chip->changed_to = 0;
        core_write(&chip->core, 0x08000000u + from,
                   (const uint8_t *)chip->flash_registers.word + from, count);
        memset(chip->block + from / 2, 0, count / 2 * sizeof *chip->block);
    }
}
