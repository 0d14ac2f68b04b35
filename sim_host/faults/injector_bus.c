/* Faults of frames. Ports: 0 the controller, 1 + enum walker_node the nodes. */
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "sim_host/faults/injector_internal.h"

static const struct sim_bus_fault nothing = {.kind = SIM_BUS_FAULT_NONE};

static struct sim_bus_fault lost_to(uint32_t receivers)
{
    return (struct sim_bus_fault){.kind = SIM_BUS_FAULT_DROP, .receivers = receivers};
}

static struct sim_bus_fault lost(void)
{
    return lost_to(0);
}

static bool chance(struct shot_state *state)
{
    return injector_random(&state->rng) < state->shot.magnitude;
}

static struct sim_bus_fault flipped(struct shot_state *state, const struct can_msg *message)
{
    struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_ALTER};
    if (message->length == 0 || !chance(state)) {
        return nothing;
    }
    const unsigned flips = 1 + (unsigned)(injector_random(&state->rng) * 3.0);
    for (unsigned i = 0; i < flips; i++) {
        const unsigned bit = (unsigned)(injector_random(&state->rng) * 8.0 * message->length);
        fault.flip[bit / 8] ^= (uint8_t)(1u << (bit % 8));
    }
    return fault;
}

static struct sim_bus_fault destroyed(struct shot_state *state)
{
    struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_DESTROY};
    fault.bit = (uint16_t)(1.0 + injector_random(&state->rng) * 90.0);
    return fault;
}

/* The latch bit: byte 4 of a drive's command, bit 0. */
static struct sim_bus_fault with_latch(const struct can_msg *message, bool armed)
{
    struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_ALTER};
    if (((message->data[4] & 1u) != 0) == armed) {
        return nothing;
    }
    fault.flip[4] = 1;
    return fault;
}

struct sim_bus_fault injector_on_frame(struct shot_state *state, const struct can_msg *message,
                                       unsigned sender)
{
    const struct fault_shot *shot = &state->shot;
    const uint32_t id = message->id;
    const uint32_t sensor = injector_by_side(shot, FRAME_LEG_STATE_LEFT);
    const uint32_t drive = injector_by_side(shot, FRAME_DRIVE_STATE_LEFT);
    const uint32_t command = injector_by_side(shot, FRAME_DRIVE_COMMAND_LEFT);
    const unsigned drive_port =
        INJECTOR_PORT_FIRST_NODE +
        (injector_side(shot) == SIDE_LEFT ? WALKER_DRIVE_LEFT : WALKER_DRIVE_RIGHT);
    const unsigned node_port = INJECTOR_PORT_FIRST_NODE + shot->node;
    switch (shot->kind) {
    case FAULT_SENSOR_FRAMES_LOST:
        return id == sensor ? lost() : nothing;
    case FAULT_DRIVE_FRAMES_LOST:
        return id == drive ? lost() : nothing;
    case FAULT_TARGETS_LOST:
        return id == FRAME_DRIVE_TARGETS ? lost_to(1u << drive_port) : nothing;
    case FAULT_COMMANDS_LOST:
        return id == command ? lost() : nothing;
    case FAULT_SLOW_LOST:
        return id == injector_by_side(shot, FRAME_DRIVE_SLOW_LEFT) ? lost() : nothing;
    case FAULT_NODE_HEARTBEAT_LOST:
        return id == CO_COB_HEARTBEAT + injector_node_id(shot) ? lost() : nothing;
    case FAULT_MASTER_HEARTBEAT_LOST:
        return id == FRAME_HEARTBEAT_CONTROLLER ? lost() : nothing;
    case FAULT_SYNC_LOST:
        return id == FRAME_SYNC ? lost_to(1u << node_port) : nothing;
    case FAULT_RANDOM_LOSS:
        return chance(state) ? lost() : nothing;
    case FAULT_DELAYED: {
        struct sim_bus_fault fault = {.kind = SIM_BUS_FAULT_DELAY};
        fault.delay_ns = (uint32_t)(shot->magnitude * 1e6 * injector_random(&state->rng));
        return id == sensor ? fault : nothing;
    }
    case FAULT_DUPLICATED: {
        const struct sim_bus_fault twice = {.kind = SIM_BUS_FAULT_DUPLICATE};
        return chance(state) ? twice : nothing;
    }
    case FAULT_CORRUPT_ANGLE:
        return id == sensor ? flipped(state, message) : nothing;
    case FAULT_CORRUPT_DRIVE:
        return id == drive ? flipped(state, message) : nothing;
    case FAULT_CORRUPT_TARGETS:
        return id == FRAME_DRIVE_TARGETS ? flipped(state, message) : nothing;
    case FAULT_CORRUPT_COMMAND:
        return id == command ? flipped(state, message) : nothing;
    case FAULT_CORRUPT_ANY:
        return id != FRAME_SYNC ? flipped(state, message) : nothing;
    case FAULT_ERROR_BURSTS:
        return chance(state) ? destroyed(state) : nothing;
    case FAULT_BUS_OFF:
        return sender == node_port ? destroyed(state) : nothing;
    case FAULT_CONTROLLER_BUS_OFF:
        return sender == INJECTOR_PORT_CONTROLLER ? destroyed(state) : nothing;
    case FAULT_DRIVE_DEAF:
        return sender == 0 && id != FRAME_SYNC ? lost_to(1u << drive_port) : nothing;
    case FAULT_LATCH_STUCK_ARMED:
        return id == command ? with_latch(message, true) : nothing;
    case FAULT_LATCH_NEVER_ARMED:
        return id == command ? with_latch(message, false) : nothing;
    default:
        return nothing;
    }
}
