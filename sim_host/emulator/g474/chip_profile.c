#include "sim_host/emulator/g474/chip_profile.h"

void chip_profile_note(struct chip_profile *profile, uint32_t address, uint32_t instructions)
{
    if (profile->blocks < CHIP_PROFILE_BLOCKS) {
        profile->block[profile->blocks++] = (struct chip_profile_block){address, instructions};
    }
}

void chip_profile_end_tick(struct chip_profile *profile, uint32_t tick, int worst)
{
    for (uint32_t i = 0; worst && i < profile->blocks; i++) {
        fprintf(profile->out, "%u,%#x,%u\n", tick, profile->block[i].address,
                profile->block[i].instructions);
    }
    profile->blocks = 0;
}
