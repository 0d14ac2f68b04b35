/* From a device's description to what its sensors' and its nodes' set-up are told.
 */
#ifndef HAL_DEVICES_DEVICE_CONFIG_H
#define HAL_DEVICES_DEVICE_CONFIG_H

#include "hal/devices/device_description.h"
#include "hal/devices/leg_sensors.h"
#include "hal/devices/node_setup.h"

/* The leg sensors: SIDE_COUNT entries. Pure. *device must be valid. */
void device_leg_sensors(const struct device_description *device,
                        struct leg_sensor_config config[SIDE_COUNT]);

/* What the nodes are told and must be like. leg_length_m: a following error of a tenth of it is the limit
 * where the description names none; speed_needed_m_s: what the law will ask of a motor. Pure. */
void device_node_setup(const struct device_description *device, float leg_length_m,
                       float speed_needed_m_s, struct node_setup_config *config);

/* Whether every node on the bus is a CANopen node that the controller sets up. */
bool device_is_canopen(const struct device_description *device);

#endif
