#include "sim_host/faults/injector_shot.h"

#include "hal/bus/frame_table.h"
#include "sim_host/nodes/walker_nodes.h"

double injector_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

double injector_between(struct shot_state *state, double low, double high)
{
    return low + (high - low) * injector_random(&state->rng);
}

enum side injector_side(const struct fault_shot *shot)
{
    return shot->node < WALKER_DRIVE_RIGHT ? SIDE_LEFT : SIDE_RIGHT;
}

static bool is_drive(const struct fault_shot *shot)
{
    return shot->node == WALKER_DRIVE_LEFT || shot->node == WALKER_DRIVE_RIGHT;
}

uint32_t injector_by_side(const struct fault_shot *shot, uint32_t left)
{
    return left + (uint32_t)injector_side(shot);
}

uint32_t injector_node_id(const struct fault_shot *shot)
{
    return injector_by_side(shot, is_drive(shot) ? NODE_DRIVE_LEFT : NODE_SENSOR_LEFT);
}
