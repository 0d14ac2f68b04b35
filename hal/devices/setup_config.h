/* What the nodes are told when they are set up, and must be like (node_setup.h). Made from a device's
 * description by device_config.h.
 */
#ifndef HAL_DEVICES_SETUP_CONFIG_H
#define HAL_DEVICES_SETUP_CONFIG_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/canopen/network.h"
#include "model/side.h"

/* What the nodes must be told and must be like. */
struct node_setup_config {
    uint8_t node[NETWORK_NODES]; /* numbers, by role; all 0: those of NODE_TABLE, and no boards */
    uint32_t counts_per_m[SIDE_COUNT];    /* motor counts per metre of spring, expected */
    int32_t limit_min_counts[SIDE_COUNT]; /* software position limits, 0x607D */
    int32_t limit_max_counts[SIDE_COUNT];
    uint32_t following_error_counts[SIDE_COUNT]; /* 0x6065 */
    float rated_force_N
        [SIDE_COUNT]; /* of the spring, at the motor's rated torque 0x6076; 0 = unknown */
    bool ankle_is_lever[SIDE_COUNT];
    /* 0x6080, in the drive's unit, counts/s: a slower motor would lag behind its target; 0 = not
     * checked. A drive that says 0 has no limit. */
    uint32_t speed_needed_counts_s[SIDE_COUNT];
    /* What a node has otherwise than the virtual one; 0 and false: it is like that. */
    uint32_t lacks[SIDE_COUNT];       /* bits of enum device_lack: objects left alone */
    bool interpolated[SIDE_COUNT];    /* mode 7 with 0x60C1:01 instead of mode 8 with 0x607A */
    bool own_target[SIDE_COUNT];      /* the target PDO has this drive's alone */
    bool has_others_pdos[SIDE_COUNT]; /* the drive's other PDOs are switched off */
    bool sensor_has_others_pdos
        [SIDE_COUNT];             /* its cyclic one is switched off, its foot switch's moved */
    bool foot_switch[SIDE_COUNT]; /* to its place here; without one, switched off */
    uint32_t leg_object[SIDE_COUNT],
        ankle_object[SIDE_COUNT];                         /* index << 8 | sub; 0: 0x2020:01, :02 */
    uint8_t leg_bits[SIDE_COUNT], ankle_bits[SIDE_COUNT]; /* 0: 24, 16 */
    uint32_t leg_counts_per_turn[SIDE_COUNT];             /* 0: 2^24 */
    uint32_t latch_object[SIDE_COUNT]; /* of a latch board's state, a byte; 0: it does not tell */
    uint32_t rated_torque_mNm
        [SIDE_COUNT]; /* as a data sheet has it, where scaling is lacking; 0: not told */
};

#endif
