/* A virtual leg sensor: CANopen encoder of profile CiA 406 which measures the leg
 * angle and the ankle's extension and answers every SYNC with TPDO2 (0x280+node,
 * 5 bytes: 0x6020:01 leg angle INTEGER24, 0x6020:02 ankle INTEGER16).
 *
 * Knows a `struct can_bus` and the time it is told, nothing else. Noise,
 * resolution and latency of the sensor presets are the plant's; the node converts
 * to the counts of hal/frame_table.h (rounded to nearest, saturated).
 */
#ifndef SIM_HOST_NODES_LEG_SENSOR_NODE_H
#define SIM_HOST_NODES_LEG_SENSOR_NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/can_bus.h"
#include "model/side.h"

struct leg_sensor_node_config {
    enum side side;
    uint8_t node_id;     /* 1..127 */
    bool ankle_is_lever; /* ankle in radians (counts 2*pi/2^16) instead of metres (10 um) */
};

struct leg_sensor_node;

/* Prepares the node and sends its boot-up message. Returns 0, or -1 when a config
 * value is out of range. `bus` is kept by value; its context must outlive the node. */
int leg_sensor_node_init(struct leg_sensor_node *node,
                         const struct leg_sensor_node_config *config, struct can_bus bus,
                         uint64_t now_ns);

/* What the sensor measures from now on: leg angle in rad (signed, within one turn)
 * and ankle extension in m, or rad with a lever. A value that is not finite raises
 * the device's error (EMCY 0x5000) and the last value stays. */
void leg_sensor_node_measure(struct leg_sensor_node *node, double leg_angle_rad, double ankle);

/* Handles waiting frames and everything due by now_ns. */
void leg_sensor_node_poll(struct leg_sensor_node *node, uint64_t now_ns);

#include "sim_host/nodes/leg_sensor_node_type.h"

#endif
