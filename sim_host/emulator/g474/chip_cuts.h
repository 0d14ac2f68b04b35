/* Power that fails while the image writes its flash: at one operation, or at many of them.
 *
 * For many, what is asked of the image runs through once. Before each of the chosen operations the
 * process forks, and in the copy power fails in that very operation. So the time before it is
 * simulated once, and each copy goes on from the same state.
 *
 * With `alike`, a copy ends as soon as its power has failed, if it would start from flash that reads the
 * same as in a copy that ended well (chip_flash_use.h). So each operation is cut, and each
 * different start is run to its end once.
 */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_CUTS_H
#define SIM_HOST_EMULATOR_G474_CHIP_CUTS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/emulator/g474/chip_flash_use.h"

struct chip_cuts {
    uint32_t every; /* cut in each so many-th operation in a copy; 0: only in `at`, here */
    uint32_t at;    /* the operation, counted from 0 */
    bool alike;     /* starts that read the same flash are run once */
    struct chip *chip;
    bool in_copy;               /* this process is the copy whose power fails */
    bool hit;                   /* power failed */
    uint32_t operations;        /* erases and words so far, counted from chip_cuts_begin on */
    unsigned under_way;         /* copies, one a processor of this machine */
    uint32_t tried, ran;        /* copies, and those that ran to their end */
    uint32_t bad;               /* those that did not end as they must */
    uint32_t first, resets;     /* the chip's counts at the beginning */
    struct chip_starts *starts; /* NULL: each copy runs to its end */
    struct chip_flash_use use;  /* the copy's */
};

/* From now on: power fails as `every` and `at` say. Returns NULL, or what is missing. */
const char *chip_cuts_begin(struct chip_cuts *cuts, struct chip *chip);

/* What was asked is over. Without a cut, power goes and comes back now. */
void chip_cuts_finish(struct chip_cuts *cuts);

/* Ends a copy, and tells on standard error what is wrong with it (NULL: nothing). Returns in the
 * first process. */
void chip_cuts_end(struct chip_cuts *cuts, const char *trouble);

#endif
