/* An image that starts with the settings of a loop's control task in its parameter memory. */
#ifndef SIM_HOST_EMULATOR_IMAGE_START_H
#define SIM_HOST_EMULATOR_IMAGE_START_H

#include <stdbool.h>
#include <stddef.h>

#include "sim_host/emulator/emulator.h"
#include "sim_host/loop/loop.h"

/* damaged: one bit of the settings is wrong, so that the image must refuse them. Returns 0, or -1 with
 * the reason in message; then nothing is left behind. */
int image_start(struct emulator *emulator, enum emulator_link link, const char *image,
                const struct loop *loop, bool damaged, char *message, size_t message_size);

#endif
