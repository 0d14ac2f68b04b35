/* How a device was put together, and what has come loose since: between the plant and its nodes.
 *
 * walker_nodes_init() makes it right: all zeros, gains of 1. Each field may change at any time.
 */
#ifndef SIM_HOST_NODES_ASSEMBLY_H
#define SIM_HOST_NODES_ASSEMBLY_H

#include <stdbool.h>
#include <stdint.h>

#include "model/side.h"

enum { ASSEMBLY_LATE_MOST = 31, ASSEMBLY_NODES = 4 };

struct assembly {
    bool legs_swapped;   /* left and right leg sensor exchanged, without their foot switches */
    bool feet_swapped;   /* the foot switches of both sensors exchanged */
    bool drives_crossed; /* each drive, with its latch, at the other leg */
    double leg_gain[SIDE_COUNT];     /* of the leg's angle; -1: mounted backwards */
    double ankle_gain[SIDE_COUNT];   /* of the ankle's extension */
    double ankle_slip_m[SIDE_COUNT]; /* added to it: the sensor has slipped in its cuff */
    bool ankle_stuck[SIDE_COUNT];    /* it stays at ankle_stuck_m */
    double ankle_stuck_m[SIDE_COUNT];
    double motor_scale[SIDE_COUNT]; /* the drive's metre: it reports this times the true position */
    uint8_t late_ticks[SIDE_COUNT]; /* age of the leg sensor's values, at most ASSEMBLY_LATE_MOST */
    double clock_skew[ASSEMBLY_NODES];  /* the node's clock runs faster by this share, */
    uint64_t skewed_ns[ASSEMBLY_NODES]; /* from here on */
};

#endif
