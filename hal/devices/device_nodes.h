/* The units that a device has on its bus, and whether their identifiers keep clear of each other.
 *
 * CANopen nodes (CiA 402 drives, latch boards, sensors) have the identifiers that CiA 301, 7.3.5
 * gives to their number. A CANSimple drive has the 32 identifiers from 32 times its axis number on
 * (sea_drive_cansimple.h); a motor in MIT mode listens to its number and answers with answer_id.
 */
#ifndef HAL_DEVICES_DEVICE_NODES_H
#define HAL_DEVICES_DEVICE_NODES_H

#include "hal/devices/device_description.h"
#include "hal/devices/device_verdict.h"

/* Drive, latch board, leg sensor, ankle sensor of either leg. */
enum { DEVICE_UNITS_MAX = 4 * SIDE_COUNT };

/* One unit: where its number stands in the description. */
struct device_unit {
    int leg;
    unsigned key;     /* enum device_leg_key of its number */
    uint8_t protocol; /* DEVICE_CIA402 stands for every CANopen node */
    uint8_t number;
    uint8_t answer_id; /* MIT mode */
};

/* Lists the units, left leg first. A sensor that measures both angle and ankle is one unit. Returns how many. O(1). */
unsigned device_units(const struct device_description *device,
                      struct device_unit units[DEVICE_UNITS_MAX]);

struct device_node_clash {
    int leg;
    unsigned key;
    float id; /* the number or identifier that two of them claim */
};

/* DEVICE_OK, DEVICE_BAD_NODE_TAKEN or DEVICE_BAD_ID_TAKEN with the later one of the two. Bounded: each pair of
 * units once. */
enum device_verdict device_nodes_check(const struct device_description *device,
                                       struct device_node_clash *clash);

#endif
