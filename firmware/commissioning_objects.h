/* Objects 0x2060 to 0x2062: what a commissioning tool asks of the controller, and what it is shown. */
#ifndef FIRMWARE_COMMISSIONING_OBJECTS_H
#define FIRMWARE_COMMISSIONING_OBJECTS_H

#include "controller/commissioning/motion.h"
#include "firmware/controller_objects.h"
#include "hal/devices/leg_sensors.h"
#include "hal/devices/sea_drives.h"

/* The request as the objects hold it now; pure. O(1). */
struct motion_request commissioning_request(const struct controller_objects *objects);

/* Brings the shown values up to date; sensors and drives as they were last heard. O(1), loop only. */
void commissioning_show(struct controller_objects *objects, const struct motion *motion,
                        const struct leg_sensors *sensors, const struct sea_drives *drives);

#endif
