/* What is written to a node, and read from it, step by step (node_setup.h goes through them).
 *
 * A node's steps are computed from the configuration, not stored: which objects there are, the device's
 * description says.
 */
#ifndef HAL_DEVICES_SETUP_STEPS_H
#define HAL_DEVICES_SETUP_STEPS_H

#include "hal/devices/device_keys.h"
#include "hal/devices/setup_config.h"

#define SETUP_ALL_BITS UINT32_C(0xFFFFFFFF)

/* STEP_TRY: a write that a node without the object may refuse. STEP_SKIP: nothing to do. */
enum step_kind {
    STEP_EXPECT,
    STEP_AWAIT,
    STEP_SPEED,
    STEP_WRITE,
    STEP_TRY,
    STEP_SCALING,
    STEP_SKIP,
    STEP_END
};

struct setup_step {
    enum step_kind kind;
    uint16_t index;
    uint8_t sub;
    uint8_t bytes;
    uint32_t value;
    uint32_t mask; /* of the comparison */
};

/* Which step of which node. */
struct setup_place {
    uint8_t role, node; /* enum network_role; its number */
    bool with_rtr;      /* it refused a PDO without remote requests */
    uint16_t step;      /* from 0 */
};

/* The step at a place. Pure, O(1). */
struct setup_step setup_step_at(const struct node_setup_config *config,
                                const struct setup_place *place);

/* Whose leg a role is at. */
static inline enum side setup_leg(uint8_t role)
{
    return role % 2 == 0 ? SIDE_LEFT : SIDE_RIGHT;
}

static inline bool setup_lacks(const struct node_setup_config *config, enum side leg,
                               enum device_lack what)
{
    return (config->lacks[leg] >> (unsigned)what & 1u) != 0;
}

#endif
