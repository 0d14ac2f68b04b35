/* The walker's nodes: the drives, latch boards and leg sensors of a device, and the plant behind them.
 *
 * They are the same on the in-process bus (a port per node) and on SocketCAN (one interface for all,
 * frame by frame). A tick, from SYNC k to SYNC k+1:
 *   - frames go to the nodes as they come. At the SYNC the nodes apply the commands of the cycle
 *     before, and answer with what walker_nodes_measure() gave them;
 *   - walker_nodes_advance() passes the drives' commands to the plant and advances it;
 *   - walker_nodes_measure() reads the plant for the next SYNC.
 */
#ifndef SIM_HOST_NODES_WALKER_NODES_H
#define SIM_HOST_NODES_WALKER_NODES_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "hal/devices/device_description.h"
#include "sim_host/nodes/assembly.h"
#include "sim_host/nodes/drive_node.h"
#include "sim_host/nodes/latch_node.h"
#include "sim_host/nodes/leg_sensor_node.h"
#include "sim_host/nodes/vendor_drive.h"
#include "sim_host/plant/plant.h"

enum { WALKER_NODES = 4, WALKER_NODES_IDS_MAX = 64 };

/* Order of node busses: drive left, sensor left, drive right, sensor right. A latch board shares its drive's,
 * an ankle sensor of its own the leg sensor's. */
enum walker_node {
    WALKER_DRIVE_LEFT = 0,
    WALKER_SENSOR_LEFT = 1,
    WALKER_DRIVE_RIGHT = 2,
    WALKER_SENSOR_RIGHT = 3
};

enum { FOREIGN_WATCHDOG_MS = 50 };

/* Stands before a CiA 402 drive: what the drive of a maker would refuse over SDO (eds_gate.h). */
struct walker_gate {
    /* Whether it refuses the request: then *answer goes out in the drive's place. */
    bool (*refuses)(const void *context, const struct can_msg *request, struct can_msg *answer);
    const void *context;
};

struct walker_nodes {
    struct plant plant;
    struct device_description device;       /* what is played */
    struct drive_node drive[SIDE_COUNT];    /* of the legs with a CiA 402 drive */
    struct vendor_drive vendor[SIDE_COUNT]; /* of those with another protocol */
    struct latch_node latch[SIDE_COUNT];    /* of those whose latch is on a board */
    struct leg_sensor_node sensor[SIDE_COUNT];
    struct leg_sensor_node ankle[SIDE_COUNT]; /* of those whose ankle sensor is a node of its own */
    struct can_bus drive_bus[SIDE_COUNT], sensor_bus[SIDE_COUNT];
    struct walker_gate gate[SIDE_COUNT]; /* refuses NULL: there is none; set it behind the init */
    struct sensor_sample sample[SIDE_COUNT];
    struct assembly assembly;
    bool
        torque_is_off; /* the hardware takes the drives' torque, whatever they do; may change at any time */
    struct walker_reading {
        double leg_angle_rad, ankle;
        bool sent;
    } reading[SIDE_COUNT][ASSEMBLY_LATE_MOST + 1]; /* the newest ones, by tick */
    uint32_t readings;
};

/* The nodes are those of *device (copied), which must be valid. Builds the plant (its heap is given back by
 * walker_nodes_free), boots the nodes on their busses and measures for the first SYNC. Returns 0, or -1 with the reason in message
 * (PLANT_ERROR_MAX bytes); then nothing is held. *nodes must not move afterwards. */
int walker_nodes_init(struct walker_nodes *nodes, const struct plant_config *plant,
                      const struct device_description *device,
                      const struct can_bus bus[WALKER_NODES], uint64_t now_ns, char *message);
void walker_nodes_free(struct walker_nodes *nodes);

/* Gives one frame to all nodes: for an interface they share. True for a SYNC. */
bool walker_nodes_receive(struct walker_nodes *nodes, const struct can_msg *message,
                          uint64_t now_ns);

/* What is due by time, without receiving: heartbeats, time-outs. */
void walker_nodes_process(struct walker_nodes *nodes, uint64_t now_ns);

/* Polls one node on its own bus; true when it saw a SYNC. */
bool walker_nodes_poll(struct walker_nodes *nodes, enum walker_node node, uint64_t now_ns);

/* The drives' commands to the plant, and the plant one tick on. */
void walker_nodes_advance(struct walker_nodes *nodes);

/* An ankle's extension in the unit that a side's leg sensor has: m, or with a lever rad (small angles). */
double walker_nodes_ankle(const struct walker_nodes *nodes, enum side side, double extension_m);

/* The plant's state to the nodes, once a tick (the sensors' noise moves on here). */
void walker_nodes_measure(struct walker_nodes *nodes);

/* Identifiers any of the nodes listens to, without repetition, as their object
 * dictionaries have them now. Returns how many; ids holds WALKER_NODES_IDS_MAX. */
unsigned walker_nodes_ids(const struct walker_nodes *nodes, uint16_t *ids);

/* Number of SDO requests so far: after a change walker_nodes_ids() may differ. */
uint32_t walker_nodes_sdo_requests(const struct walker_nodes *nodes);

#endif
