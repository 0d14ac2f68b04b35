/* Spares the drives: what they tell of temperature, supply and warnings reaches the controller, against
 * the limits of the device's description, now and then and in quiet ticks; and what comes of it is shown
 * (0x2021) and told (an emergency).
 */
#ifndef FIRMWARE_DRIVE_CARE_H
#define FIRMWARE_DRIVE_CARE_H

#include "controller/controller.h"
#include "firmware/controller_objects.h"
#include "hal/canopen/co_device.h"
#include "hal/devices/sea_drives.h"
#include "model/tick.h"

/* Between two looks; a busy tick puts one off, for up to as long again. */
enum { DRIVE_CARE_TICKS = TICKS_OF_MS(100) };
/* The first look, between two telegrams of the state, which come as often. */
enum { DRIVE_CARE_PHASE_TICKS = DRIVE_CARE_TICKS / 2 };

/* The limits that hold, and which springs nothing unloads on link loss, by a description that was
 * checked. Start-up only; O(1). */
void drive_care_init(struct derate_limits limit[SIDE_COUNT], struct controller_objects *objects,
                     const struct device_description *device);

/* Once a tick; busy: the tick has more to do than others. Loop only; O(1), 2 drives read in one tick of
 * DRIVE_CARE_TICKS, nothing in the others. */
void drive_care_update(struct controller *controller, const struct derate_limits limit[SIDE_COUNT],
                       const struct sea_drives *drives, uint32_t tick, bool busy,
                       struct co_device *device);

/* Brings 0x2021 up to now. O(1). */
void drive_care_show(struct controller_objects *objects, const struct derate *derate,
                     const struct sea_drives *drives);

#endif
