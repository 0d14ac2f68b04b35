/* Where the instructions of the worst tick go, by blocks of instructions. scripts/tick-profile names
 * the functions. */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_PROFILE_H
#define SIM_HOST_EMULATOR_G474_CHIP_PROFILE_H

#include <stdint.h>
#include <stdio.h>

enum { CHIP_PROFILE_BLOCKS = 16384 }; /* a tick runs some 3,000 of them; more are left out */

struct chip_profile {
    struct chip_profile_block {
        uint32_t address, instructions;
    } block[CHIP_PROFILE_BLOCKS];
    uint32_t blocks;
    FILE *out; /* the caller's */
};

/* A block of instructions runs. O(1). */
void chip_profile_note(struct chip_profile *profile, uint32_t address, uint32_t instructions);

/* A tick is over. Worse than all before it (`worst`), it is written: a line "tick,address,instructions" a block. */
void chip_profile_end_tick(struct chip_profile *profile, uint32_t tick, int worst);

#endif
