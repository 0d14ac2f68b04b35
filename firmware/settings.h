/* What is set up once per device and wearer and kept over power cycles: the
 * controller's parameters, and what hangs on the bus. */
#ifndef FIRMWARE_SETTINGS_H
#define FIRMWARE_SETTINGS_H

#include <stdint.h>

#include "controller/control_params.h"
#include "hal/devices/device_description.h"
#include "hal/storage/param_store.h"

enum { SETTINGS_VERSION = 6 }; /* another layout of struct settings_record is another number */

struct settings {
    struct control_params control; /* its branch lies elsewhere and is only pointed to */
    struct device_description device;
    float desired_speed_rad_s; /* at the start, forward apex speed, > 0 */
    uint32_t walk_at_start;    /* 0 or 1: assist without being asked over the bus */
};

/* The same as it is kept: no pointers, the same bytes on every machine. */
struct settings_values {
    real control[CONTROL_PARAM_COUNT]; /* in the order of CONTROL_PARAM_TABLE */
    struct speed_table table;
    struct device_description device;
    float desired_speed_rad_s;
    uint32_t walk_at_start;
};

struct settings_record {
    struct settings_values values;
    struct gait_branch branch; /* count 0 when there is none; read in place */
};

enum settings_result {
    SETTINGS_OK = 0,
    SETTINGS_BAD_CONTROL = -1, /* control_params_validate says what */
    SETTINGS_BAD_DEVICE = -2,  /* device_check says what, and for a person device_check_person */
    SETTINGS_BAD_STROKE = -3,  /* the law may ask a motor for more than its stroke */
    SETTINGS_BAD_SPEED = -4
};

/* Settings that pass the check and are nobody's: the paper's walker. A device that
 * has no others must not walk. All bytes are defined, padding included. Pure. */
void settings_default(struct settings *settings);

/* Checks every field. Pure, bounded. */
enum settings_result settings_check(const struct settings *settings);

/* Opens the store on `nv` and reads the settings; control.branch then points into the
 * memory. On any result but PARAM_STORE_OK *settings are the default ones. Not
 * checked: see settings_check. Start-up only; needs 200 bytes of stack. */
enum param_store_result settings_load(struct settings *settings, struct param_store *store,
                                      const struct nv_store *nv);

/* The same where it lies while it is in force; all stay the caller's. */
struct settings_parts {
    const struct control_params *control;
    const struct device_description *device;
    float desired_speed_rad_s;
    uint32_t walk_at_start;
};

/* Saves the parts, the branch pointed to included. `standstill` and results as of
 * param_store_save. Loop only; needs 250 bytes of stack. */
enum param_store_result settings_save_parts(const struct settings_parts *parts,
                                            struct param_store *store, bool standstill);

/* Where the branch of the settings kept last lies; NULL when they have none. O(1). */
const struct gait_branch *settings_branch(const struct param_store *store);

/* Saves *settings, the branch pointed to included. `standstill` and results as of
 * param_store_save. On success moves control.branch to the new copy. Loop only. */
enum param_store_result settings_save(struct settings *settings, struct param_store *store,
                                      bool standstill);

#endif
