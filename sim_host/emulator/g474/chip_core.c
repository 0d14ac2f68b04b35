/* What every part of the chip stands on: its time, what it found, and the wish to be looked at. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "sim_host/emulator/g474/chip.h"

void chip_find(struct chip *chip, const char *format, ...)
{
    char text[CHIP_FINDING_BYTES - 48];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    chip->finding_count++;
    for (unsigned i = 0; i < CHIP_FINDINGS_MAX; i++) {
        char *slot = chip->findings[i];
        if (strncmp(slot, text, strlen(text)) == 0) {
            return; /* told already */
        }
        if (slot[0] == '\0') {
            snprintf(slot, CHIP_FINDING_BYTES, "%s (near %#x, %.3f ms)", text,
                     core_get(&chip->core, CORE_PC), (double)chip_now_ns(chip) / 1e6);
            return;
        }
    }
}

uint64_t chip_now_ns(const struct chip *chip)
{
    return chip->base_ns + (chip->cycles - chip->base_cycles) * 1000000u / chip->clocks.core_khz;
}

uint64_t chip_cycle_of(const struct chip *chip, uint64_t time_ns)
{
    const uint64_t khz = chip->clocks.core_khz;

    if (time_ns == CHIP_NEVER) {
        return CHIP_NEVER;
    }
    if (time_ns <= chip->base_ns) {
        return chip->base_cycles;
    }
    return chip->base_cycles + ((time_ns - chip->base_ns) * khz + 999999u) / 1000000u;
}

void chip_update(struct chip *chip)
{
    chip->due = 0; /* the next block looks around */
}

void chip_stop(struct chip *chip)
{
    chip->stop_asked = true;
    chip->due = 0;
}

void chip_can_changed(struct chip *chip)
{
    chip->stop_asked = true;
    chip_update(chip);
}
