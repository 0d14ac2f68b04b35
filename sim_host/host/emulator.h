/* A Cortex-M4F in QEMU (mps2-an386) as a child process, with two named pipes.
 *
 * The image exchanges one struct pil_record per SYNC over the pipes. Nothing here
 * waits for ever: a dead or silent emulator is an error after a time-out.
 */
#ifndef SIM_HOST_HOST_EMULATOR_H
#define SIM_HOST_HOST_EMULATOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "hal/pil_record.h"

enum { EMULATOR_PATH_MAX = 256, EMULATOR_TIMEOUT_MS = 60000 };

struct emulator {
    pid_t process; /* 0 = none */
    int to_image, from_image;
    char directory[EMULATOR_PATH_MAX]; /* holds the pipes; removed at the end */
};

/* Starts QEMU on an image whose parameter memory holds nv (nv_bytes). Returns 0,
 * or -1 with the reason in message; then nothing is left behind. */
int emulator_start(struct emulator *emulator, const char *image, const uint8_t *nv, size_t nv_bytes,
                   char *message, size_t message_size);

/* Reads the next record. Returns 0, or -1 when the emulator died, was silent for
 * EMULATOR_TIMEOUT_MS, or sent something else. */
int emulator_read(struct emulator *emulator, struct pil_record *record);

/* Writes a record. Returns 0 or -1. */
int emulator_write(struct emulator *emulator, const struct pil_record *record);

/* Ends the emulator, removes its directory. Harmless when nothing runs. */
void emulator_stop(struct emulator *emulator);

#endif
