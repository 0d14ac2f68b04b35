/* Reads the drives' safety objects back while they run, one after the other, and compares.
 *
 * What is expected is what the drive itself said when it was set up: the answers to the set-up's
 * read-backs pass by here. An object that a drive lacks was never read back and is not asked for. A round
 * of both drives takes less than DRIVE_AUDIT_ROUND_S. It asks at fixed ticks, one object at a time, after
 * everything else of the bus (SDO has the lowest urgency but the heartbeats). Nothing is asked while a node is set
 * up, nor for a moment while somebody else talks to the drive: one request more would cut their transfer short.
 * A request that is not answered is counted and is no deviation; that a drive is alive its heartbeat shows.
 */
#ifndef FIRMWARE_DRIVE_AUDIT_H
#define FIRMWARE_DRIVE_AUDIT_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/bring_up.h"
#include "hal/bus/can_bus.h"
#include "hal/canopen/co_sdo_client.h"
#include "hal/canopen/network.h"
#include "hal/devices/node_setup.h"
#include "model/side.h"
#include "model/tick.h"

enum {
    DRIVE_AUDIT_OBJECTS = 26, /* of each drive; the table is in drive_audit.c */
    DRIVE_AUDIT_TICKS = TICKS_OF_MS(90),
    DRIVE_AUDIT_ROUND_S = 5,
    DRIVE_AUDIT_QUIET_TICKS = TICKS_OF_MS(50), /* after somebody else's request */
    DRIVE_AUDIT_SKIPS = 10,                    /* so often in a row it gives way, no oftener */
    DRIVE_AUDIT_TIMEOUT_MS = 60
};

/* What is remembered from one request to the next; no pointer may be in it (snapshot.c). */
struct drive_audit_memory {
    uint32_t expected[SIDE_COUNT][DRIVE_AUDIT_OBJECTS];
    uint32_t known[SIDE_COUNT]; /* bit i: object i was read back */
    uint8_t quiet_ticks, skips;
    bool waits;         /* for a quiet tick, to ask for the next object */
    uint8_t busy_ticks; /* left of those that do what a busy one has put off */
    uint8_t deviates;   /* legs (bit 1 << side) whose drive is not as it was set up */
};

struct drive_audit {
    struct drive_audit_memory memory;
    struct co_sdo_client client; /* of the request under way */
    uint8_t leg, object;         /* what it asks for */
    bool under_way;
};

/* Takes a frame: an answer to the request under way, and says whether it is one; or an answer to the set-up of
 * a drive, of which it takes note. Loop only; O(DRIVE_AUDIT_OBJECTS). */
bool drive_audit_receive(struct drive_audit *audit, const struct bring_up *bring_up,
                         const struct can_msg *message, uint64_t now_ns);

/* Somebody else talks to a drive or a sensor. O(1). */
void drive_audit_give_way(struct drive_audit *audit);

/* Once a tick, numbered `tick`; busy: the controller has much to do in it. A request waits for a tick
 * without gait event, heartbeat or telemetry: question and answer would add to these. Returns true when
 * an object is found to be not as it was set up; *failure then says which, and its leg's bit is in
 * memory.deviates until the drive is set up anew. *unanswered counts requests without an answer
 * (saturates). Loop only; O(NETWORK_NODES). */
bool drive_audit_update(struct drive_audit *audit, const struct bring_up *bring_up,
                        const struct network *network, const struct can_bus *bus, uint32_t tick,
                        bool busy, uint64_t now_ns, struct setup_failure *failure,
                        uint32_t *unanswered);

#endif
