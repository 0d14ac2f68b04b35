/* The actuators of a device file: sections [plant] (both legs), [left.plant] and [right.plant].
 *
 * Their keys are in sim_host/plant/sea_keys.h. What a leg's own section says goes before what [plant]
 * says. All other sections of the file are somebody else's, and are read over.
 */
#ifndef SIM_HOST_SUBJECTS_ACTUATOR_FILE_H
#define SIM_HOST_SUBJECTS_ACTUATOR_FILE_H

#include "model/side.h"
#include "sim_host/plant/sea_config.h"

enum { ACTUATOR_MESSAGE_MAX = 768 };

struct actuators {
    struct sea_config leg[SIDE_COUNT];
};

/* Reads path and checks both legs. Returns 0, or -1 with file, leg, key and what is allowed in message
 * (ACTUATOR_MESSAGE_MAX bytes); a file without one of the sections is an error. */
int actuators_read(struct actuators *actuators, const char *path, char *message);

#endif
