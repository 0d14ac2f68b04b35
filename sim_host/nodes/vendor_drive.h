/* A virtual SEA drive with its maker's own protocol.
 *
 * The protocols are ODrive's (CANSimple) and CubeMars AK's (MIT mode), by the makers' descriptions, which
 * hal/devices/sea_drive_cansimple.h and hal/devices/sea_drive_mit.h name. Its latch is on a board of its
 * own (latch_node.h).
 * Used like a drive_node: measure, receive and process, command.
 */
#ifndef SIM_HOST_NODES_VENDOR_DRIVE_H
#define SIM_HOST_NODES_VENDOR_DRIVE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/devices/device_keys.h"
#include "model/side.h"
#include "sim_host/nodes/drive_node.h"

/* Half widths of the MIT fields, as set in the motor. */
struct vendor_ranges {
    double position_rad, velocity_rad_s, torque_Nm;
};

struct vendor_drive_config {
    enum device_protocol protocol; /* DEVICE_CANSIMPLE or DEVICE_MIT */
    uint8_t drive_id;              /* CANSimple node, or MIT motor id */
    uint16_t answer_id;            /* MIT: identifier of the answers */
    double units_per_m;            /* turns or radians of the motor per metre of spring, > 0 */
    double zero_units;             /* reading at the unloaded spring */
    bool inverted;                 /* and it falls with compression */
    double stroke_m;
    struct vendor_ranges ranges; /* MIT */
    uint32_t watchdog_ms;        /* without a command for so long: idle; 0 = off */
};

struct vendor_drive {
    struct vendor_drive_config config;
    struct can_bus bus;
    struct drive_axis_feedback feedback;
    bool closed_loop;
    bool position_mode; /* CANSimple: controller mode was set */
    bool error;
    bool commanded;     /* a command has come since power-on: the watchdog runs */
    double input_units; /* the last position command */
    double stiffness;   /* MIT: kp of the last command; 0 = no position loop */
    uint64_t now_ns, last_command_ns, next_estimate_ns, next_heartbeat_ns;
};

/* Prepares the drive on `bus` (kept by value). Returns 0, or -1 when a config
 * value is out of range. Do not move *drive afterwards. */
int vendor_drive_init(struct vendor_drive *drive, const struct vendor_drive_config *config,
                      struct can_bus bus, uint64_t now_ns);

void vendor_drive_measure(struct vendor_drive *drive, const struct drive_axis_feedback *feedback);

/* One frame from the bus, whoever it is for. */
void vendor_drive_receive(struct vendor_drive *drive, const struct can_msg *message,
                          uint64_t now_ns);

/* What is due by time: estimates and heartbeats. */
void vendor_drive_process(struct vendor_drive *drive, uint64_t now_ns);

/* What the axis shall do in the coming period; of the latch it knows nothing. */
void vendor_drive_command(struct vendor_drive *drive, struct drive_axis_command *command);

/* The hardware has taken the torque: an error of an axis that had it. */
void vendor_drive_lose_torque(struct vendor_drive *drive);

/* Identifiers the drive half listens to, appended to ids (room for at least 4).
 * Returns the new count. */
unsigned vendor_drive_ids(const struct vendor_drive *drive, uint16_t *ids, unsigned count);

#endif
