/* A Cortex-M4F in QEMU (mps2-an386) as a child process, with two named pipes or with its UART.
 *
 * Over the pipes the image exchanges one struct pil_record per SYNC; without them it looks for
 * an slcan adapter on its UART. Nothing here waits for ever: a dead or silent emulator is an
 * error after a time-out.
 */
#ifndef SIM_HOST_EMULATOR_EMULATOR_H
#define SIM_HOST_EMULATOR_EMULATOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "hal/pil_record.h"

enum { EMULATOR_PATH_MAX = 256, EMULATOR_TIMEOUT_MS = 60000 };

enum emulator_link { EMULATOR_PIPES, EMULATOR_UART };

struct emulator {
    pid_t process; /* 0 = none */
    int to_image, from_image;
    int uart;                          /* EMULATOR_UART: the line's other end */
    char directory[EMULATOR_PATH_MAX]; /* holds the pipes; removed at the end */
};

/* Starts QEMU on an image whose parameter memory holds nv (nv_bytes). Returns 0,
 * or -1 with the reason in message; then nothing is left behind. */
int emulator_start(struct emulator *emulator, enum emulator_link link, const char *image,
                   const uint8_t *nv, size_t nv_bytes, char *message, size_t message_size);

/* Reads the next byte of the UART while the processor runs; it stands still at all other
 * times, so that its clock does not count how long the host takes. Returns the byte, or -1
 * when the emulator died or was silent for EMULATOR_TIMEOUT_MS. */
int emulator_uart_read(struct emulator *emulator);

/* Puts bytes on the line; the processor sees them when it runs. Returns 0 or -1. */
int emulator_uart_write(struct emulator *emulator, const char *bytes, size_t length);

/* Reads the next record. Returns 0, or -1 when the emulator died, was silent for
 * EMULATOR_TIMEOUT_MS, or sent something else. */
int emulator_read(struct emulator *emulator, struct pil_record *record);

/* Writes a record. Returns 0 or -1. */
int emulator_write(struct emulator *emulator, const struct pil_record *record);

/* Ends the emulator, removes its directory. Harmless when nothing runs. */
void emulator_stop(struct emulator *emulator);

#endif
