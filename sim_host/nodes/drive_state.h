/* The CiA 402 state machine of a drive node; used by drive_node.c only. */
#ifndef SIM_HOST_NODES_DRIVE_STATE_H
#define SIM_HOST_NODES_DRIVE_STATE_H

#include "sim_host/nodes/drive_node_type.h"

/* Start of the device: torque off, switch on disabled. */
void drive_state_power_on(struct drive_node *node);

/* objects.controlword was written: obey it. */
void drive_state_controlword(struct drive_node *node);

/* The master cannot be relied on any more (0x6007); error_code is what a fault is
 * reported as. Without effect while the power stage is off. */
void drive_state_connection_lost(struct drive_node *node, uint16_t error_code);

/* Once a period: faults of the axis, end of unloading. */
void drive_state_supervise(struct drive_node *node, uint64_t now_ns);

void drive_state_update_statusword(struct drive_node *node);

/* The hardware has taken the torque: a fault of a drive that had it, told by EMCY and left by a reset. */
void drive_state_lose_torque(struct drive_node *node);

/* Whether an enabled drive follows its target: in interpolated position only while the controlword's bit 4 is set. */
bool drive_state_follows(const struct drive_node *node);

#endif
