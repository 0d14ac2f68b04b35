/* What a drive of a maker's data sheet offers, and what its device file therefore says.
 *
 * Needed objects: without one of them the drive is refused by name. Wanted ones: a drive that lacks them is
 * used without, at a cost that is told.
 */
#ifndef SIM_HOST_DEVICES_DEVICE_IMPORT_H
#define SIM_HOST_DEVICES_DEVICE_IMPORT_H

#include "hal/devices/device_description.h"
#include "sim_host/devices/eds_file.h"

enum { DEVICE_IMPORT_REASON_MAX = 160 };

struct device_import {
    bool fits;
    char reason[DEVICE_IMPORT_REASON_MAX]; /* why not */
    enum device_mode mode;
    uint32_t lacks; /* bits of enum device_lack */
};

/* Judges a data sheet. */
void device_import_judge(const struct eds_file *eds, struct device_import *import);

/* What a lack costs, in a sentence; what it is in objects. Static strings. */
const char *device_lack_cost(enum device_lack lack);
const char *device_lack_objects(enum device_lack lack);

#endif
