/* Watches for SDO requests to the drives and sensors that somebody else sends: a commissioning tool, a
 * gateway, a second controller.
 *
 * Once the nodes are set up only the controller configures them. A download (CiA 301, 7.2.4.3.3,
 * 7.2.4.3.4, 7.2.4.3.9 to 11) is a fault, whatever it writes and whether the node takes it. The links are
 * alive then, so the controller unloads the springs by its own targets. It stops no node that follows
 * them: what was written may be the very object that says what a drive does when it is stopped
 * (0x6007). A drive that does not follow is stopped by NMT; where 0x6007 may have been written it is shut
 * down by its controlword instead. Afterwards the node is set up anew. Uploads change nothing and
 * are counted.
 * The controller does not hear its own requests (can_bus.h), so what it hears is somebody else's.
 */
#ifndef FIRMWARE_TOOL_WATCH_H
#define FIRMWARE_TOOL_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/signals.h"
#include "firmware/bring_up.h"
#include "firmware/controller_objects.h"
#include "hal/bus/can_bus.h"
#include "hal/canopen/network.h"
#include "hal/devices/sea_drives.h"

/* A written-to drive that is so far behind its target for so long does not follow it. */
#define TOOL_WATCH_BEHIND_RATIO 0.02f /* of the leg's length */
enum { TOOL_WATCH_BEHIND_TICKS = TICKS_OF_MS(30) };

struct tool_watch {
    uint8_t written;     /* in this tick: bit i, somebody wrote to node i of the network */
    uint8_t distrusted;  /* written to since they were set up */
    uint8_t unstoppable; /* of those, to 0x6007, or it is not known to what */
    uint8_t
        shut_down; /* legs (bit 1 << side) whose drive is not to be enabled until it is set up anew */
    uint8_t behind_ticks[SIDE_COUNT];
};

/* Takes a frame that is an SDO request to one of the network's nodes, whatever their numbers, and says
 * whether it is one. Shows it in objects (0x2020, 0x2022). Loop only; O(NETWORK_NODES). */
bool tool_watch_receive(struct tool_watch *watch, const struct network *network,
                        const struct bring_up *bring_up, const struct can_msg *message,
                        struct controller_objects *objects);

/* Node `index` of the network is no longer as it was set up: its object `changed` is not (0: it is not known
 * which). It is set up anew when nothing can be loaded any more. O(1). */
void tool_watch_distrust(struct tool_watch *watch, unsigned index, uint16_t changed);

/* Once a tick, behind the controller's decision, while it unloads: request is what it asks of the drives
 * (SIDE_COUNT), leg_length_m the person's. Returns the legs (bit 1 << side) whose drive does not follow and is to
 * be stopped by NMT; others that do not follow go into watch->shut_down. Loop only; O(1). */
unsigned tool_watch_find_stuck(struct tool_watch *watch, const struct sea_drives *drives,
                               const struct sea_request *request, float leg_length_m);

/* Once a tick, behind the controller's decision: sets those nodes up anew that were written to, where
 * nothing can be loaded any more: with the torque off by the supervisor's word (powered is false) and
 * by the drives' own. Forgets `written`. Loop only; O(NETWORK_NODES). */
void tool_watch_end_tick(struct tool_watch *watch, struct bring_up *bring_up,
                         const struct sea_drives *drives, bool powered);

/* Somebody wrote to a set-up node in this tick. */
static inline bool tool_watch_is_written(const struct tool_watch *watch)
{
    return watch->written != 0;
}

#endif
