/* Sends a program to the controller over CAN (CiA 302-3) and waits until it runs. */
#ifndef SIM_HOST_LOG_PROGRAM_SEND_H
#define SIM_HOST_LOG_PROGRAM_SEND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/storage/program_image.h"
#include "sim_host/log/sdo_upload.h"

enum { PROGRAM_SEND_MESSAGE_MAX = 256 };

struct program_send {
    struct sdo_upload *tool;
    bool allow_older;
    void (*told)(void *context, size_t done); /* NULL: nobody is told how far it is */
    void *told_context;
    unsigned restart_waits; /* so many of the tool's waits at most until the new program answers */
    char message[PROGRAM_SEND_MESSAGE_MAX]; /* what went wrong, and what to do */
};

/* Finds the program in a file's bytes: an image as make firmware makes it, with the starter before
 * it, or without. Returns where it begins, or NULL; *length and *header are the program's. */
const uint8_t *program_send_find(const uint8_t *file, size_t bytes, size_t *length,
                                 struct program_header *header);

/* Sends it, orders it, waits until the node identifies itself with its CRC. Returns 0, or -1 with
 * the message. */
int program_send(struct program_send *send, const uint8_t *program, size_t length, uint32_t crc);

/* The second half of it: what was sent already is ordered, and waited for. */
int program_send_start(struct program_send *send, uint32_t crc);

/* The CRC of the program that runs now. Returns 0, or -1 with the message. */
int program_send_identify(struct program_send *send, uint32_t *crc);

#endif
