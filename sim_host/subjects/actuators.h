/* The actuators of a device file's sections [plant] (both legs), [left.plant] and [right.plant]: what the
 * simulated device is made of, which the controller does not know.
 *
 * Their keys are in sim_host/plant/sea_keys.h. What a leg's own section says goes before what [plant]
 * says. A file without them has idealised actuators, by its description.
 */
#ifndef SIM_HOST_SUBJECTS_ACTUATORS_H
#define SIM_HOST_SUBJECTS_ACTUATORS_H

#include <stdbool.h>

#include "model/side.h"
#include "sim_host/devices/device_file.h"
#include "sim_host/plant/sea_config.h"

enum { ACTUATORS_MESSAGE_MAX = DEVICE_MESSAGE_MAX };

struct actuators {
    bool as_built; /* else idealised: config says nothing */
    struct sea_config config[SIDE_COUNT];
};

/* From what the file says; path is for the message. Returns 0, or -1 with line, key and what is allowed in
 * message (ACTUATORS_MESSAGE_MAX bytes). */
int actuators_of(const struct device_file *file, const char *path, struct actuators *actuators,
                 char *message);

#endif
