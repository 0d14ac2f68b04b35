/* Whether a description of a device fits: each key in its range, and the keys to each other.
 *
 *     struct device_description device;
 *     struct device_refusal refusal;
 *     device_description_default(&device);
 *     device.leg[SIDE_RIGHT].direction = -1;
 *     if (device_check(&device, &refusal) != DEVICE_OK) { ... refusal.key ... }
 */
#ifndef HAL_DEVICES_DEVICE_CHECK_H
#define HAL_DEVICES_DEVICE_CHECK_H

#include "hal/devices/device_description.h"
#include "hal/devices/device_verdict.h"

/* Checks one value against its row: DEVICE_OK, DEVICE_BAD_RANGE,
 * DEVICE_BAD_NOT_FINITE or DEVICE_BAD_OBJECT. */
enum device_verdict device_key_check(const struct device_key *row, float value);

/* Checks every key that applies against its range, and the keys against each other. Returns
 * DEVICE_OK, or the verdict, with *refusal telling which key of which leg. Pure; bounded: the number
 * of keys, and the square of the number of nodes. */
enum device_verdict device_check(const struct device_description *device,
                                 struct device_refusal *refusal);

/* The same for a device that a person is to wear: besides, every driven leg needs a latch that
 * reports that it holds, and something that makes its spring safe when the link is lost. */
enum device_verdict device_check_person(const struct device_description *device,
                                        struct device_refusal *refusal);

#endif
