/* A virtual leg sensor: a CANopen encoder of profile CiA 406 for the leg angle and the ankle's extension.
 *
 * It answers every SYNC with TPDO2 (0x280 + node): 0x2020:01 leg angle (INTEGER24) and 0x2020:02 ankle
 * (INTEGER16), 5 bytes. It knows a `struct can_bus` and the time it is told, nothing else. Noise,
 * resolution and latency are the plant's. The node converts to the counts of hal/bus/frame_table.h,
 * rounded to nearest and saturated.
 * The profile's multi-sensor positions 0x6020 are 32 bits wide (manuals of TR-Electronic LA-46 and
 * Pepperl+Fuchs encoders agree). The maker's 0x2020 has the same values in the widths that fit the cycle
 * on the bus.
 * With a foot switch it also sends TPDO3 (0x380 + node): 0x2022 foot contact (UNSIGNED8, bit 0 down,
 * bit 1 fault), on change, and every 50 ms. Without one this PDO is switched off.
 */
#ifndef SIM_HOST_NODES_LEG_SENSOR_NODE_H
#define SIM_HOST_NODES_LEG_SENSOR_NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "model/foot_contact.h"
#include "model/side.h"

struct leg_sensor_node_config {
    enum side side;
    uint8_t node_id;     /* 1..127 */
    bool ankle_is_lever; /* ankle in radians instead of metres */
    /* How it is mounted, and its scale; a 0 stands for that of hal/bus/frame_table.h. The count is
     * (direction * true value + zero) * scale. */
    double leg_counts_per_turn, leg_zero_rad;
    double ankle_counts_per_unit, ankle_zero; /* of a metre, or with a lever of a turn */
    bool leg_reversed, ankle_reversed;
    bool has_foot_switch;
};

struct leg_sensor_node;

/* Prepares the node and sends its boot-up message. Returns 0, or -1 when a config
 * value is out of range. The struct must not move afterwards; `bus` is kept by value,
 * its context must outlive the node. */
int leg_sensor_node_init(struct leg_sensor_node *node, const struct leg_sensor_node_config *config,
                         struct can_bus bus, uint64_t now_ns);

/* What the sensor measures from now on: leg angle in rad (signed, within one turn)
 * and ankle extension in m, or rad with a lever. A value that is not finite raises
 * the position alarm (0x6503 bit 0, EMCY 0x5000) and the last value stays. */
void leg_sensor_node_measure(struct leg_sensor_node *node, double leg_angle_rad, double ankle);

/* What the foot switch says from now on. Nothing is sent by a node without one. */
void leg_sensor_node_measure_foot(struct leg_sensor_node *node, enum foot_contact foot);

/* Handles waiting frames and everything due by now_ns; true when a SYNC was among
 * them. */
bool leg_sensor_node_poll(struct leg_sensor_node *node, uint64_t now_ns);

/* The same for one frame which the owner received on a shared interface. */
bool leg_sensor_node_receive(struct leg_sensor_node *node, const struct can_msg *message,
                             uint64_t now_ns);

/* With silent = true the node misses its samples: SYNCs stay unanswered, as when an
 * encoder has no valid position; all else goes on. For fault injection and presets
 * that drop samples. */
void leg_sensor_node_silence(struct leg_sensor_node *node, bool silent);

#include "sim_host/nodes/leg_sensor_node_type.h"

#endif
