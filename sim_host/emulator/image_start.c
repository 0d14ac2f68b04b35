#include "sim_host/emulator/image_start.h"

#include <stdio.h>

#include "sim_host/subjects/settings_image.h"

int image_start(struct emulator *emulator, enum emulator_link link, const char *image,
                const struct loop *loop, bool damaged, char *message, size_t message_size)
{
    uint8_t nv[SETTINGS_IMAGE_BYTES];

    if (settings_image_of(&loop->config.subject, &loop->config.params,
                          loop->config.desired_speed_rad_s, true, nv) != 0) {
        snprintf(message, message_size, "the firmware would refuse these settings");
        return -1;
    }
    if (damaged) {
        nv[100] ^= 0x10; /* its CRC must tell */
    }
    return emulator_start(emulator, link, image, nv, sizeof nv, message, message_size);
}
