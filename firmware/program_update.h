/* A new program over CAN: CiA 302-3, objects 0x1F50 (program data), 0x1F51 (control), 0x1F56
 * (identification: the CRC of the program that runs) and 0x1F57 (flash status).
 *
 * The image is received into the stage, a page erased whenever it reaches one. It is checked as a
 * whole: header, board, CRC. Control value 1 orders it, and the node restarts into the starter,
 * which puts it into the program's place. An image older than the running program is ordered by
 * value 0x80 only. Nothing of the running program is touched before, and power may fail at any word
 * (hal/storage/program_slots.h).
 *
 * No authenticity is claimed: whoever can send frames on this bus can put any program here.
 */
#ifndef FIRMWARE_PROGRAM_UPDATE_H
#define FIRMWARE_PROGRAM_UPDATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/storage/program_slots.h"

/* 0x1F51: what can be asked. Stopping (0) and resetting (2) the running program cannot. */
enum program_control {
    PROGRAM_CONTROL_START = 1,
    PROGRAM_CONTROL_CLEAR = 3,         /* forgets what was received, and an order */
    PROGRAM_CONTROL_START_OLDER = 0x80 /* as START, also when it is older */
};

/* 0x1F57: bit 0 while a transfer is under way, then the standard's numbers of errors from bit 1 on;
 * this device's own from bit 16 on. */
enum program_status {
    PROGRAM_STATUS_GOOD = 0,
    PROGRAM_STATUS_BUSY = 1,
    PROGRAM_STATUS_NONE = 1 << 1,    /* nothing valid was received */
    PROGRAM_STATUS_FORMAT = 2 << 1,  /* no image */
    PROGRAM_STATUS_DAMAGED = 3 << 1, /* CRC or length */
    PROGRAM_STATUS_WRITE = 5 << 1,   /* the memory refused */
    PROGRAM_STATUS_OTHER_BOARD = 1 << 16,
    PROGRAM_STATUS_OLDER = 2 << 16 /* START was refused for it */
};

enum { PROGRAM_RESTART_TICKS = 20 /* the answer leaves before */ };

struct program_update {
    const struct program_slots *slots; /* NULL: this device cannot be updated */
    uint32_t identification;           /* 0x1F56: the CRC of the running program, 0 without */
    uint32_t version;                  /* of the running program */
    uint32_t status;                   /* 0x1F57 */
    uint32_t received;                 /* bytes in the stage */
    uint8_t word[PROGRAM_WORD_BYTES];  /* those of a word that is not complete */
    uint32_t filled;
    struct program_header staged; /* while status is PROGRAM_STATUS_GOOD */
    uint32_t restart_in;          /* ticks; 0 = nobody asked for it */
    bool restart_now;
};

/* Reads the running program's header; *slots stays the caller's, NULL: no update. Start-up only. */
void program_update_init(struct program_update *update, const struct program_slots *slots);

/* Each returns CO_ABORT_NONE, or the abort code of the SDO. The caller has seen to it that the
 * device stands still without torque. Loop only; begin and take block for a page's erase (25 ms)
 * at most, the last take for 30 ms. */
uint32_t program_update_begin(struct program_update *update, uint32_t total);
uint32_t program_update_take(struct program_update *update, const uint8_t *bytes, unsigned length,
                             bool last);
uint32_t program_update_control(struct program_update *update, uint8_t control);

/* Once a tick, when its SYNC came back (the answer was sent before it); then restart_now says whether the main must reset. O(1). */
void program_update_tick(struct program_update *update);

#endif
