/* A virtual SEA drive: a CANopen device of profile CiA 402 that behaves on the bus like an EPOS drive.
 *
 * It has a spring, a latch and a safe reaction of its own. It knows a `struct can_bus` and the time it
 * is told, nothing else. So the same node runs on the in-process bus and on SocketCAN. The
 * mechanics are outside: the owner passes in what the axis measures, and gets what the axis shall do.
 *
 * At SYNC k (t = k ms):
 *     drive_node_measure(node, &feedback);     state of the plant at t
 *     drive_node_poll(node, now_ns);           sees SYNC: applies the synchronous
 *                                              RPDOs of the cycle before, answers
 *     drive_node_command(node, period, &cmd);  then the plant advances one period
 * Without SYNC (controller dead) the owner keeps calling all three by the clock.
 *
 * Power-on mapping; all of it can be changed by SDO:
 *     RPDO1  0x201 for both drives: target position 0x607A left, then right, the other drive's half
 *            as dummy INTEGER32; transmission type 1, timeout 50 ms
 *     RPDO2  0x300 + node: controlword and 0x60FE:01; type 255
 *     TPDO1  0x180 + node: statusword and position; type 1
 *     TPDO3  0x380 + node: torque, temperature, DC link voltage; type 100
 * Heartbeat 100 ms; the node consumes the controller's (node 16) with 250 ms. Mode 8 (cyclic
 * synchronous position) is the only one; others are refused.
 *
 * Safe reaction: the drive disarms the latch, moves its motor to zero spring at
 * config.unload_rate_m_per_s, and then switches its torque off. Causes: the master's heartbeat, the
 * target RPDO or the SYNC (50 ms) fails, or the node leaves NMT operational (0x6007); a fault (0x605E);
 * quick stop (0x605A); an orderly shutdown (0x605B, 0x605C). Disable voltage switches the torque off at
 * once, as the profile demands.
 *
 * Statusword bits besides the state. CiA 402-2: 4 voltage, 9 remote (operational), 11 a limit acts,
 * 12 follows the target, 13 following error. Of the maker: 14 latch closed, 15 motor at zero spring.
 */
#ifndef SIM_HOST_NODES_DRIVE_NODE_H
#define SIM_HOST_NODES_DRIVE_NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "sim_host/nodes/drive_node_type.h"

/* Prepares the node and sends its boot-up message. The struct is the caller's and
 * must not move afterwards; `bus` is kept by value, its context must outlive the
 * node. Returns 0, or -1 when a config value is out of range. */
int drive_node_init(struct drive_node *node, const struct drive_node_config *config,
                    struct can_bus bus, uint64_t now_ns);

/* What the axis measures from now on. */
void drive_node_measure(struct drive_node *node, const struct drive_axis_feedback *feedback);

/* Handles waiting frames and everything due by now_ns (heartbeats, time-outs).
 * Returns true when a SYNC was among them. Cost: about 0.1 us a frame. */
bool drive_node_poll(struct drive_node *node, uint64_t now_ns);

/* The same for one frame which the owner received on a shared interface. */
bool drive_node_receive(struct drive_node *node, const struct can_msg *message, uint64_t now_ns);

/* Advances the drive's own trajectory and supervision by period_ns (0.1..10 ms) and
 * says what the axis shall do during it. The period starts at the node's newest time
 * (of _init, _poll or _receive). */
void drive_node_command(struct drive_node *node, uint32_t period_ns,
                        struct drive_axis_command *command);

/* As if the device noticed an internal fault with this CiA 402 error code (0x603F),
 * e.g. 0x4310 over-temperature, 0x7305 encoder. It stays until called again with 0
 * and reset by the master. For tests and fault injection. */
void drive_node_inject_fault(struct drive_node *node, uint16_t error_code);

#endif
