/* The controller as a node of its own (16): what a person or a tool can read and
 * change over CAN while it walks. Object dictionary: controller_objects.c.
 *
 * It is the network's master, so it starts itself and NMT commands do not stop
 * its control loop. A value written over SDO takes effect at the next tick, or is
 * refused (write_rules.h). What it sends of itself: telemetry.h.
 * Everything here is driven by frames and ticks, so a log replays it.
 */
#ifndef FIRMWARE_CONTROLLER_NODE_H
#define FIRMWARE_CONTROLLER_NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/controller.h"
#include "firmware/controller_objects.h"
#include "firmware/params_guard.h"
#include "firmware/telemetry.h"
#include "firmware/write_rules.h"
#include "hal/bus/can_bus.h"
#include "hal/canopen/co_device.h"

/* Object 0x1009: the revision of what the orthosis's node has at its ends (drives, sensors, stop). */
#define CONTROLLER_HARDWARE_VERSION "1"

struct controller_node {
    struct co_device device;
    struct controller_comm comm;
    struct controller_objects objects;
    struct write_rules rules;
    struct telemetry telemetry;
    struct params_guard guard; /* of objects.params */
};

/* Prepares the node with these parameters (copied; from now on
 * node->objects.params are the ones in force) and sends its boot-up message.
 * Do not move the node afterwards. Returns 0, or -1 for an unusable dictionary. */
int controller_node_init(struct controller_node *node, const struct control_params *params,
                         float desired_speed_rad_s, bool walk_requested, struct can_bus bus);

/* Lets *settings_store be asked to keep the settings, the black box and the crash record be read
 * over SDO, and a program be received; each may be NULL. All stay the caller's. Start-up only. */
void controller_node_attach(struct controller_node *node,
                            const struct controller_settings_store_ops *settings_store,
                            void *settings_store_context, struct black_box *black_box,
                            struct crash_record *crash, struct program_update *update);

/* Takes a frame if it is for this node and says whether it did. */
bool controller_node_receive(struct controller_node *node, const struct can_msg *message,
                             uint64_t now_ns);

/* Once a tick: shows what the controller did, sends what is due (heartbeat, state
 * on change, step, emergencies). */
void controller_node_update(struct controller_node *node, const struct controller *controller,
                            const struct controller_output *output, bool emergency_stop,
                            uint64_t now_ns);

#endif
