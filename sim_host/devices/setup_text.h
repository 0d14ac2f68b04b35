/* Why a node was refused when it was set up, in words: which leg's what, which object, what was found and expected,
 * and which key of the device file says so. */
#ifndef SIM_HOST_DEVICES_SETUP_TEXT_H
#define SIM_HOST_DEVICES_SETUP_TEXT_H

#include <stddef.h>

#include "hal/devices/device_description.h"
#include "hal/devices/node_setup.h"

enum { SETUP_TEXT_MAX = 400 };

/* "left drive", "right latch board" and so on; "node" for one that this device does not have. A static string. */
const char *setup_node_name(const struct device_description *device, uint8_t node);

/* One sentence. failure->verdict is negative. */
void setup_refusal_text(const struct device_description *device,
                        const struct setup_failure *failure, char *text, size_t size);

#endif
