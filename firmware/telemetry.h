/* What the controller tells of itself over CAN: its state and fault on change, a record of every
 * step, an emergency for a latched fault and for a node that was refused at the start.
 */
#ifndef FIRMWARE_TELEMETRY_H
#define FIRMWARE_TELEMETRY_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/controller.h"
#include "firmware/controller_objects.h"
#include "hal/canopen/co_device.h"
#include "hal/devices/node_setup.h"

/* Emergency codes of the controller's node (CiA 301: 0xFF00.. are the device's own). The
 * vendor bytes are state, fault, and for a refused node: node, index, sub; after crashes, how
 * many. */
enum controller_emcy {
    CONTROLLER_EMCY_FAULT = 0xFF10,         /* the supervisor latched a fault */
    CONTROLLER_EMCY_SETUP_REFUSED = 0x6320, /* a node's parameters are not as expected */
    CONTROLLER_EMCY_SPARED = 0xFF11, /* a drive bears less than was prescribed: drive_care.h */
    CONTROLLER_EMCY_CRASHES = 0x6100 /* internal software: settings not read after crashes */
};

enum { TELEMETRY_TPDOS = 2 };

struct telemetry {
    uint8_t sent_state, sent_fault; /* as sent last */
};

/* Starts with nothing sent. */
void telemetry_init(struct telemetry *telemetry);

/* Identifiers, periods and contents of the two PDOs, as delivered. */
void telemetry_default_pdos(struct co_comm *comm);

/* Once a tick: brings the objects up to what the controller did, and queues what there is to
 * tell: state and fault on change, a new step. Loop only; O(1). */
void telemetry_update(struct telemetry *telemetry, struct controller_objects *objects,
                      struct co_device *device, const struct controller *controller,
                      const struct controller_output *output, bool emergency_stop);

/* So many crashes since a SYNC last came back: shows it (0x2032:3), and from
 * CRASH_STREAK_LIMIT on raises the emergency, which stays until the next start. O(1). */
void telemetry_report_crashes(struct controller_objects *objects, struct co_device *device,
                              uint32_t streak);

/* A node was refused at start: raises the emergency and keeps the reason. O(1). */
void telemetry_report_refused_node(struct controller_objects *objects, struct co_device *device,
                                   const struct setup_failure *failure);

/* This node is set up: takes back what was said about it, if it had been refused. O(1). */
void telemetry_clear_refused_node(struct controller_objects *objects, struct co_device *device,
                                  uint8_t node);

#endif
