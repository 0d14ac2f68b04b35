/* Every frame on the bus of a device: what `scripts/bus-budget --frames` judges. */
#ifndef SIM_HOST_DEVICES_DEVICE_FRAMES_H
#define SIM_HOST_DEVICES_DEVICE_FRAMES_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/devices/device_description.h"

enum { DEVICE_FRAMES_MAX = 80, DEVICE_FRAME_NAME_MAX = 64 };

/* A row as in hal/bus/frame_table.h. */
struct device_frame {
    char name[DEVICE_FRAME_NAME_MAX];
    uint32_t id;
    uint8_t bytes;
    bool in_ticks; /* period and deadline are in ticks, else in us */
    uint32_t period, deadline;
    uint8_t node; /* sender */
    char kind;    /* S, N, E or A */
};

/* Lists the frames of a valid device into frames, ordered by identifier. Returns how many. */
unsigned device_frames(const struct device_description *device,
                       struct device_frame frames[DEVICE_FRAMES_MAX]);

#endif
