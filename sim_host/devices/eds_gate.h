/* What a node of a maker's data sheet refuses over SDO: objects that it does not have, writes to what can only be
 * read or beyond limits, and mappings that its rules do not allow. Set before a virtual drive it makes that
 * one obey the sheet strictly.
 */
#ifndef SIM_HOST_DEVICES_EDS_GATE_H
#define SIM_HOST_DEVICES_EDS_GATE_H

#include "hal/bus/can_frame.h"
#include "sim_host/devices/eds_file.h"

/* Whether the sheet refuses a request to a node (identifier 0x600 + node): then *answer is the abort. A request
 * that is no beginning of a transfer is never refused. Pure. */
bool eds_gate_refuses(const struct eds_file *eds, const struct can_msg *request,
                      struct can_msg *answer);

#endif
