/* What a core tests of itself while it runs, in the sense of IEC 60730-1, annex H, class B: its
 * registers, RAM by a march in slices, both stacks' margins. firmware/README.md has the times.
 */
#ifndef HAL_PORT_CORTEX_M_SELF_TESTS_H
#define HAL_PORT_CORTEX_M_SELF_TESTS_H

#include <stdint.h>

#include "hal/storage/crash_record.h"

struct self_tests {
    uint32_t *ram; /* what is tested of it */
    uint32_t ram_words;
    uint32_t turn;
    uint32_t ram_word;   /* where the next slice begins */
    uint32_t ram_rounds; /* through all of it; saturates */
};

/* Begins; `ram` to `ram` + `words` (above 8) is memory that nothing but the core reads or writes.
 * Start-up only. */
void self_tests_init(struct self_tests *tests, uint32_t *ram, uint32_t words);

/* Goes on by one small test. Returns CRASH_NONE, or what has failed, with *detail for the crash
 * record. Loop, in ticks that have little else to do; below 320 instructions. */
enum crash_cause self_tests_go_on(struct self_tests *tests, uint32_t *detail);

#endif
