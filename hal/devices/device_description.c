#include "hal/devices/device_description.h"

#include <assert.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"

#ifdef PARAMS_WITHOUT_TEXT
#define ROW_TEXT(field, unit, meaning)
#else
#define ROW_TEXT(field, unit, meaning) , #field, unit, meaning
#endif

#define COMMON_ROW(field, type, unit, low, high, fallback, when, meaning) \
    {low,           high,                                                 \
     fallback,      offsetof(struct device_common, field),                \
     DEVICE_##type, DEVICE_##when ROW_TEXT(field, unit, meaning)},
const struct device_key device_common_keys[DEVICE_COMMON_COUNT] = {DEVICE_COMMON_KEYS(COMMON_ROW)};
#define LEG_ROW(field, type, unit, low, high, fallback, when, meaning) \
    {low,           high,                                              \
     fallback,      offsetof(struct device_leg, field),                \
     DEVICE_##type, DEVICE_##when ROW_TEXT(field, unit, meaning)},
const struct device_key device_leg_keys[DEVICE_LEG_COUNT] = {DEVICE_LEG_KEYS(LEG_ROW)};

static_assert(sizeof(struct device_leg) == DEVICE_LEG_COUNT * 4 &&
                  sizeof(struct device_common) == DEVICE_COMMON_COUNT * 4,
              "every key is one 32-bit number: no padding, the same bytes everywhere");
static_assert((1 << DEVICE_LACKS_COUNT) - 1 == 524287, "the largest value of the key lacks");

const struct device_key *device_key_row(int leg, unsigned key)
{
    return leg < 0 ? &device_common_keys[key] : &device_leg_keys[key];
}

static float value_at(const void *owner, const struct device_key *row)
{
    const uint8_t *field = (const uint8_t *)owner + row->offset;
    float number;
    int32_t whole;
    if (row->type == DEVICE_FLOAT) {
        memcpy(&number, field, sizeof number);
        return number;
    }
    memcpy(&whole, field, sizeof whole);
    return (float)whole;
}

float device_value(const struct device_description *device, int leg, unsigned key)
{
    const void *owner = leg < 0 ? (const void *)&device->common : (const void *)&device->leg[leg];
    return value_at(owner, device_key_row(leg, key));
}

bool device_key_applies(const struct device_leg *leg, unsigned key)
{
    switch ((enum device_key_when)device_leg_keys[key].when) {
    case DEVICE_WHEN_DRIVEN:
        return device_leg_is_driven(leg);
    case DEVICE_WHEN_CIA402:
        return leg->protocol == DEVICE_CIA402;
    case DEVICE_WHEN_CANSIMPLE:
        return leg->protocol == DEVICE_CANSIMPLE;
    case DEVICE_WHEN_MIT:
        return leg->protocol == DEVICE_MIT;
    case DEVICE_WHEN_LATCH_DRIVE:
        return device_leg_is_driven(leg) && leg->latch == DEVICE_LATCH_DRIVE;
    case DEVICE_WHEN_LATCH_BOARD:
        return device_leg_is_driven(leg) && leg->latch == DEVICE_LATCH_BOARD;
    case DEVICE_WHEN_LINEAR:
        return leg->ankle == DEVICE_ANKLE_LINEAR;
    case DEVICE_WHEN_LEVER:
        return leg->ankle == DEVICE_ANKLE_LEVER;
    default:
        return true;
    }
}

static void set_default(void *owner, const struct device_key *rows, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        const float fallback =
            rows[i].fallback == DEVICE_ASKED ? rows[i].minimum : rows[i].fallback;
        const uint32_t bits =
            rows[i].type == DEVICE_FLOAT ? bytes_of_f32(fallback) : (uint32_t)(int32_t)fallback;
        memcpy((uint8_t *)owner + rows[i].offset, &bits, sizeof bits);
    }
}

void device_description_default(struct device_description *device)
{
    set_default(&device->common, device_common_keys, DEVICE_COMMON_COUNT);
    device->common.tick_us = TICK_PERIOD_US;
    device->common.bitrate_bit_s = BUS_BITRATE;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct device_leg *own = &device->leg[leg];
        set_default(own, device_leg_keys, DEVICE_LEG_COUNT);
        own->protocol = DEVICE_CIA402;
        own->drive_node = NODE_DRIVE_LEFT + leg;
        own->leg_sensor_node = NODE_SENSOR_LEFT + leg;
        own->counts_per_m = 13107200.0f; /* 65536 counts a turn on a 5 mm screw */
        own->rated_force_N = 35.0f;
        own->spring_N_per_m = 100.0f;
        own->stroke_max_m = 0.35f;
        own->speed_max_m_s = 1.9f;
        own->force_max_N = 90.0f;
        own->latch = DEVICE_LATCH_DRIVE;
        own->unload = DEVICE_UNLOAD_DRIVE;
    }
}
