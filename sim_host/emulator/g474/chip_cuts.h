/* Power that fails while the image writes its flash: at one operation, or at many of them.
 *
 * For many, the session runs through what is asked of the image once. Before each of the chosen
 * operations the process forks, and in the copy power fails in that very operation. So the time
 * before it is simulated once, and each copy goes on from the same state.
 */
#ifndef SIM_HOST_EMULATOR_G474_CHIP_CUTS_H
#define SIM_HOST_EMULATOR_G474_CHIP_CUTS_H

#include <stdbool.h>
#include <stdint.h>

struct chip_session;

struct chip_cuts {
    uint32_t every;      /* cut in each so many-th operation in a copy; 0: only in `at`, here */
    uint32_t at;         /* the operation, counted from 0 */
    bool in_copy;        /* this process is the copy whose power fails */
    bool hit;            /* power failed */
    uint32_t operations; /* erases and words of what was asked, when nothing cuts it */
    uint32_t tried, bad; /* copies, and those that did not end as they must */
    uint32_t params_crc; /* of the settings in force before */
};

/* Asks the image, at standstill, to save or to forget its settings, and cuts its power. Then power
 * comes back. What the image made of it: the caller judges; a copy ends in chip_cuts_end. */
void chip_cuts_run(struct chip_session *session);

/* Whether the settings in force now are those before the cut. */
bool chip_cuts_kept_settings(struct chip_session *session);

/* Ends a copy: tells what is wrong on standard error. Returns in the first process. */
void chip_cuts_end(struct chip_session *session);

#endif
