#include "sim_host/faults/strange_tool.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"

enum { CONTROLLER = WALKER_NODES, EXPEDITED_BYTES = 4, VALUES = 6 };

static const struct co_device *device_of(const struct loop *loop, unsigned node)
{
    switch (node) {
    case WALKER_DRIVE_LEFT:
        return &loop->nodes.drive[SIDE_LEFT].device;
    case WALKER_DRIVE_RIGHT:
        return &loop->nodes.drive[SIDE_RIGHT].device;
    case WALKER_SENSOR_LEFT:
        return &loop->nodes.sensor[SIDE_LEFT].device;
    case WALKER_SENSOR_RIGHT:
        return &loop->nodes.sensor[SIDE_RIGHT].device;
    default:
        return &loop->rig.task.node.device;
    }
}

static bool is_writable_at_once(const struct co_entry *entry)
{
    return entry->size >= 1 && entry->size <= EXPEDITED_BYTES;
}

/* The `wanted`-th object, counted from 0; NULL and *count = how many there are when it has not so many. */
static const struct co_entry *nth_object(const struct co_device *device, unsigned wanted,
                                         void **base, unsigned *count)
{
    *count = 0;
    for (unsigned i = 0; i < CO_DICTIONARIES; i++) {
        const struct co_dictionary *dictionary = &device->dictionaries[i];
        for (unsigned entry = 0; entry < dictionary->count; entry++) {
            if (!is_writable_at_once(&dictionary->entries[entry])) {
                continue;
            }
            if (*count == wanted) {
                *base = dictionary->base;
                return &dictionary->entries[entry];
            }
            (*count)++;
        }
    }
    return NULL;
}

unsigned strange_tool_objects(const struct loop *loop, unsigned node)
{
    void *base;
    unsigned count;
    (void)nth_object(device_of(loop, node), UINT32_MAX, &base, &count);
    return count;
}

static unsigned node_of(const struct fault_shot *shot)
{
    return shot->kind == FAULT_FOREIGN_SDO_CONTROLLER ? (unsigned)CONTROLLER : shot->node;
}

static const struct co_entry *entry_of(const struct loop *loop, const struct fault_shot *shot,
                                       void **base)
{
    unsigned count;
    const unsigned objects = strange_tool_objects(loop, node_of(shot));
    const unsigned wanted = (unsigned)(shot->magnitude * (double)objects);
    return nth_object(device_of(loop, node_of(shot)), wanted < objects ? wanted : objects - 1, base,
                      &count);
}

uint32_t strange_tool_object(const struct loop *loop, const struct fault_shot *shot)
{
    void *base;
    const struct co_entry *entry = entry_of(loop, shot, &base);
    return (uint32_t)entry->index << 8 | entry->sub;
}

static uint32_t value_for(struct shot_state *state, uint32_t now)
{
    const uint32_t any = (uint32_t)(injector_random(&state->rng) * 0x1p32);
    switch ((unsigned)(injector_random(&state->rng) * (double)VALUES)) {
    case 0:
        return 0;
    case 1:
        return 1;
    case 2:
        return UINT32_MAX;
    case 3:
        return now ^ UINT32_C(1) << (any >> 27);
    case 4:
        return now;
    default:
        return any;
    }
}

struct can_msg strange_tool_frame(struct shot_state *state, const struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    void *base = NULL;
    uint8_t bytes[CO_VALUE_MAX] = {0};
    const struct co_entry *entry = entry_of(loop, shot, &base);
    const uint32_t node =
        node_of(shot) == CONTROLLER ? (uint32_t)NODE_CONTROLLER : injector_node_id(shot);
    struct can_msg message = {.id = CO_COB_SDO_REQUEST + node, .length = 8};
    (void)co_od_load(entry, base, bytes);
    message.data[0] = (uint8_t)(0x23u | (EXPEDITED_BYTES - (unsigned)entry->size) << 2);
    bytes_put_u16(message.data + 1, entry->index);
    message.data[3] = entry->sub;
    bytes_put_u32(message.data + 4, value_for(state, bytes_get_u32(bytes)));
    return message;
}
