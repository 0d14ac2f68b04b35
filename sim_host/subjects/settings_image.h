/* The parameter memory of a device as a file would hold it: settings written by the
 * same parameter store that the device reads them with. */
#ifndef SIM_HOST_SUBJECTS_SETTINGS_IMAGE_H
#define SIM_HOST_SUBJECTS_SETTINGS_IMAGE_H

#include <stdint.h>

#include "firmware/settings.h"
#include "sim_host/subjects/host_task.h"

enum { SETTINGS_IMAGE_WORDS = 512, SETTINGS_IMAGE_BYTES = 2 * SETTINGS_IMAGE_WORDS * 8 };

/* The settings of a device that is set up like this rig's control task. */
void settings_of_rig(struct settings *settings, const struct host_task *rig,
                     double desired_speed_rad_s, bool walk_at_start);

/* Both banks of a memory into which the settings were saved once. Returns 0, or -1
 * when they do not fit. */
int settings_image(const struct settings *settings, uint8_t image[SETTINGS_IMAGE_BYTES]);

#endif
