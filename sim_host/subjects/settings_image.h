/* The parameter memory of a device as a file would hold it: settings written by the
 * same parameter store that the device reads them with. */
#ifndef SIM_HOST_SUBJECTS_SETTINGS_IMAGE_H
#define SIM_HOST_SUBJECTS_SETTINGS_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/settings.h"
#include "sim_host/subjects/subject.h"

enum { SETTINGS_IMAGE_WORDS = 512, SETTINGS_IMAGE_BYTES = 2 * SETTINGS_IMAGE_WORDS * 8 };

/* Both banks of a memory into which these settings were saved once. Returns 0, or -1 when they do not
 * fit. */
int settings_image(const struct settings *settings, uint8_t image[SETTINGS_IMAGE_BYTES]);

/* The same for a person with a device on. autostart: it assists without being asked. Returns 0, or -1
 * when the firmware would refuse them or they do not fit. */
int settings_image_of(const struct subject *subject, const struct control_params *params,
                      double desired_speed_rad_s, bool autostart,
                      uint8_t image[SETTINGS_IMAGE_BYTES]);

#endif
