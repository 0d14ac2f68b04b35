/* What the board tests of itself while it runs, in the sense of IEC 60730-1, annex H, class B: the
 * core's registers, RAM by a march in slices, both stacks' margins, its two oscillators against each
 * other. The program's CRC is the orthosis's (program_scan). firmware/README.md has the times.
 */
#ifndef FIRMWARE_BOARDS_NUCLEO_G474RE_SELF_TESTS_H
#define FIRMWARE_BOARDS_NUCLEO_G474RE_SELF_TESTS_H

#include <stdint.h>

#include "hal/port_stm32g474/lsi_meter.h"
#include "hal/storage/crash_record.h"

struct self_tests {
    uint32_t turn;
    uint32_t ram_word;   /* of the program's RAM, where the next slice begins */
    uint32_t ram_rounds; /* through all of it; saturates */
    struct lsi_meter lsi;
};

/* Begins; starts the oscillator's counter. Returns 0, or a register that lost what was written.
 * Start-up only. */
uint32_t self_tests_init(struct self_tests *tests);

/* Goes on by one small test. Returns CRASH_NONE, or what has failed, with *detail for the crash
 * record. Loop, in ticks that have little else to do; below 320 instructions. */
enum crash_cause self_tests_go_on(struct self_tests *tests, uint32_t now_us, uint32_t *detail);

#endif
