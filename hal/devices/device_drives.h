/* The drives of a device, each leg's by its own protocol, and its latch, behind one interface.
 *
 * A leg without a drive answers as one that stands at the unloaded spring and does as it is told:
 * the controller loads nothing there.
 */
#ifndef HAL_DEVICES_DEVICE_DRIVES_H
#define HAL_DEVICES_DEVICE_DRIVES_H

#include <stddef.h>

#include "hal/devices/device_description.h"
#include "hal/devices/latch_boards.h"
#include "hal/devices/sea_drive_cansimple.h"
#include "hal/devices/sea_drive_cia402.h"
#include "hal/devices/sea_drive_mit.h"

/* What is known of them: no pointers, the same bytes everywhere (firmware/snapshot.h). */
struct device_drives_state {
    struct cia402_drives cia402;
    struct latch_boards latches;
    uint8_t protocol[SIDE_COUNT];      /* enum device_protocol */
    bool enabled[SIDE_COUNT];          /* as a leg without a drive was told last */
    struct cansimple_drives cansimple; /* from here on of makers' protocols only */
    struct mit_drives mit;
};

struct device_drives {
    struct device_drives_state state;
    struct sea_drives own[DEVICE_MIT + 1]; /* by protocol: of the state above */
    uint32_t rx_malformed;                 /* of all of them up to the last age; saturates */
};

/* How much of the state says anything: without a drive of a maker's protocol, less. O(1). */
size_t device_drives_state_bytes(const struct device_drives *drives);

/* Starts with nothing received. *device must be valid; it is not kept. Do not
 * move the drives afterwards. */
void device_drives_init(struct device_drives *drives, const struct device_description *device);

/* The drives behind the common interface; *drives stays the caller's. */
struct sea_drives device_drives_interface(struct device_drives *drives);

#endif
