/* A program and its successor in flash, so that power may fail at any word of an update.
 *
 * The program runs from its slot. A new one is received into the stage, another part of the flash,
 * and stays there until it is whole. Then one word commits it. At the next start the starter, which
 * no update ever touches, copies it into the slot and marks it done. Cut short, the copying begins
 * anew at the next start: the stage still holds all of it.
 *
 * The mark has a page of its own behind the stage: word 0 commits (magic, CRC of the image), word 1
 * says that the copying is done. Anything else than a commit without anything in word 1 is no order:
 * a commit that was cut short leaves the old program, a done mark that was cut short either way a
 * program that is whole.
 */
#ifndef HAL_STORAGE_PROGRAM_SLOTS_H
#define HAL_STORAGE_PROGRAM_SLOTS_H

#include "hal/storage/program_image.h"

enum { PROGRAM_COMMIT = 0x4D4F4341, /* "ACOM" */ PROGRAM_DONE = 0x4E4F4441 /* "ADON" */ };

struct program_slots {
    struct program_memory memory;
    uint32_t slot, stage; /* where each begins, at a page's beginning */
    uint32_t room;        /* of each, in bytes, whole pages */
    uint32_t mark;        /* the page of the mark */
    uint32_t hardware;
};

/* Judges what is in the stage. */
enum program_verdict program_slots_check_stage(const struct program_slots *slots,
                                               struct program_header *header);

/* Judges what is in the slot. */
enum program_verdict program_slots_check(const struct program_slots *slots,
                                         struct program_header *header);

/* Orders what is in the stage into the slot at the next start. The mark's page is erased. Returns
 * false when the memory refuses. */
bool program_slots_commit(const struct program_slots *slots, uint32_t crc);

/* True when there is such an order. */
bool program_slots_is_ordered(const struct program_slots *slots);

/* The starter's part: carries an order out, if there is one and the stage is good. Returns true
 * when it did; the slot is then as the stage. false: nothing was to be done, or the memory refused
 * (the next start tries again). May take seconds. */
bool program_slots_install(const struct program_slots *slots);

#endif
