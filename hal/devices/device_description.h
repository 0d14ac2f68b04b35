/* What hangs on the bus: per leg a drive, a spring, a latch and sensors, each by its own data sheet.
 *
 * The two legs are described apart and may differ in everything that is not said to be common. One
 * description serves all who need to know the device: the file's reader and writer, this validator,
 * the controller's object dictionary, and what the board stores.
 * Every number is a float or a 32-bit integer, so that the bytes in flash are the same everywhere.
 * Whether a description fits is device_check.h's.
 */
#ifndef HAL_DEVICES_DEVICE_DESCRIPTION_H
#define HAL_DEVICES_DEVICE_DESCRIPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/devices/device_keys.h"
#include "model/side.h"

#define DEVICE_FIELD_FLOAT float
#define DEVICE_FIELD_INT int32_t
#define DEVICE_FIELD_WORD int32_t
#define DEVICE_FIELD_FLAGS int32_t
#define DEVICE_FIELD_OBJECT int32_t
#define DEVICE_FIELD(field, type, unit, low, high, fallback, when, meaning) \
    DEVICE_FIELD_##type field;

struct device_common {
    DEVICE_COMMON_KEYS(DEVICE_FIELD)
};
struct device_leg {
    DEVICE_LEG_KEYS(DEVICE_FIELD)
};
#undef DEVICE_FIELD

struct device_description {
    struct device_common common;
    struct device_leg leg[SIDE_COUNT];
};

/* Numbers of the keys: DEVICE_COMMON_tick_us, DEVICE_LEG_protocol and so on, from 0. Sub-index
 * number + 1 of 0x2050 (common), 0x2051 (left leg) and 0x2052 (right leg) of the controller's node. */
#define DEVICE_COMMON_NUMBER(field, type, unit, low, high, fallback, when, meaning) \
    DEVICE_COMMON_##field,
enum device_common_key { DEVICE_COMMON_KEYS(DEVICE_COMMON_NUMBER) DEVICE_COMMON_COUNT };
#undef DEVICE_COMMON_NUMBER
#define DEVICE_LEG_NUMBER(field, type, unit, low, high, fallback, when, meaning) DEVICE_LEG_##field,
enum device_leg_key { DEVICE_LEG_KEYS(DEVICE_LEG_NUMBER) DEVICE_LEG_COUNT };
#undef DEVICE_LEG_NUMBER

/* The objects of the controller's node that hold the description. */
enum { DEVICE_INDEX_COMMON = 0x2050, DEVICE_INDEX_LEFT = 0x2051, DEVICE_INDEX_RIGHT = 0x2052 };

enum device_key_type {
    DEVICE_FLOAT,
    DEVICE_INT,
    DEVICE_WORD,  /* one of the words in `unit`; its value is the word's place, from 0 */
    DEVICE_FLAGS, /* any of the words in `unit`; bit i is word i */
    DEVICE_OBJECT /* index << 8 | sub-index; 0 = none. In a file 0x2101:00 */
};

/* A key's row. Texts are for the host; a board is built without them (PARAMS_WITHOUT_TEXT). */
struct device_key {
    float minimum, maximum;
    float fallback;  /* what a description has that does not say it */
    uint16_t offset; /* of the field in struct device_common or device_leg, bytes */
    uint8_t type;    /* enum device_key_type */
    uint8_t when;    /* enum device_key_when */
#ifndef PARAMS_WITHOUT_TEXT
    const char *name, *unit, *meaning;
#endif
};

extern const struct device_key device_common_keys[DEVICE_COMMON_COUNT];
extern const struct device_key device_leg_keys[DEVICE_LEG_COUNT];

/* Every key at its fallback, and the node numbers of the virtual device: drives 1 and 2, sensors 3
 * and 4. Passes the check. Pure. */
void device_description_default(struct device_description *device);

/* The key's row and its value in a description. leg -1: the common ones. Pure, O(1). */
const struct device_key *device_key_row(int leg, unsigned key);
float device_value(const struct device_description *device, int leg, unsigned key);

/* Whether a key says anything about this leg: what concerns a lever says nothing of a linear ankle.
 * Pure, O(1). */
bool device_key_applies(const struct device_leg *leg, unsigned key);

/* Whether the leg has a drive; whether its latch tells that it is closed. Pure, O(1). */
static inline bool device_leg_is_driven(const struct device_leg *leg)
{
    return leg->protocol != DEVICE_NO_DRIVE_PROTOCOL;
}

/* Whether the ankle's sensor is a node of its own. Pure, O(1). */
static inline bool device_leg_ankle_is_apart(const struct device_leg *leg)
{
    return leg->ankle_sensor_node != 0 && leg->ankle_sensor_node != leg->leg_sensor_node;
}

static inline bool device_leg_reports_latch(const struct device_leg *leg)
{
    return leg->latch == DEVICE_LATCH_DRIVE ||
           (leg->latch == DEVICE_LATCH_BOARD && leg->latch_object != 0);
}

static inline bool device_leg_lacks(const struct device_leg *leg, enum device_lack what)
{
    return ((uint32_t)leg->lacks >> (unsigned)what & 1u) != 0;
}

#endif
