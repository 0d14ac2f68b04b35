/* Faults of frames. Ports: 0 the controller, 1 + enum walker_node the nodes. */
#include <string.h>

#include "hal/bytes.h"
#include "hal/canopen/co_defs.h"
#include "hal/frame_table.h"
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

static uint32_t by_side(const struct fault_shot *shot, uint32_t left)
{
    return left + (uint32_t)injector_side(shot);
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

static uint32_t node_id_of(const struct fault_shot *shot)
{
    return by_side(shot, injector_is_drive(shot) ? NODE_DRIVE_LEFT : NODE_SENSOR_LEFT);
}

struct sim_bus_fault injector_on_frame(struct shot_state *state, const struct can_msg *message,
                                       unsigned sender)
{
    const struct fault_shot *shot = &state->shot;
    const uint32_t id = message->id;
    const uint32_t sensor = by_side(shot, FRAME_LEG_STATE_LEFT);
    const uint32_t drive = by_side(shot, FRAME_DRIVE_STATE_LEFT);
    const uint32_t command = by_side(shot, FRAME_DRIVE_COMMAND_LEFT);
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
        return id == by_side(shot, FRAME_DRIVE_SLOW_LEFT) ? lost() : nothing;
    case FAULT_NODE_HEARTBEAT_LOST:
        return id == CO_COB_HEARTBEAT + node_id_of(shot) ? lost() : nothing;
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
    case FAULT_DUPLICATED:
        return chance(state) ? (struct sim_bus_fault){.kind = SIM_BUS_FAULT_DUPLICATE} : nothing;
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

/* ---- a foreign node ----------------------------------------------------------- */

static void send(struct loop *loop, struct shot_state *state, const struct can_msg *message)
{
    const struct can_bus bus = sim_bus_port(&loop->bus, INJECTOR_PORT_INTRUDER);
    if (can_bus_send(&bus, message) == CAN_OK) {
        state->changed++;
    }
}

static void send_sensor(struct shot_state *state, struct loop *loop)
{
    struct can_msg message = {.id = by_side(&state->shot, FRAME_LEG_STATE_LEFT),
                              .length = FRAME_BYTES_LEG_STATE_LEFT};
    const int32_t counts = (int32_t)(state->shot.magnitude / 6.283185307179586 * 16777216.0);
    message.data[0] = (uint8_t)((uint32_t)counts & 0xFFu);
    message.data[1] = (uint8_t)((uint32_t)counts >> 8 & 0xFFu);
    message.data[2] = (uint8_t)((uint32_t)counts >> 16 & 0xFFu);
    send(loop, state, &message);
}

static int32_t counts_of(const struct loop *loop, double metres)
{
    return (int32_t)(metres * loop->config.subject.counts_per_m);
}

static void send_drive(struct shot_state *state, struct loop *loop)
{
    struct can_msg message = {.id = by_side(&state->shot, FRAME_DRIVE_STATE_LEFT),
                              .length = FRAME_BYTES_DRIVE_STATE_LEFT};
    bytes_put_u16(message.data, 0x5237); /* enabled, latch closed */
    bytes_put_u32(message.data + 2, (uint32_t)counts_of(loop, state->shot.magnitude));
    send(loop, state, &message);
}

static void send_targets(struct shot_state *state, struct loop *loop)
{
    struct can_msg message = {.id = FRAME_DRIVE_TARGETS, .length = FRAME_BYTES_DRIVE_TARGETS};
    const uint32_t counts = (uint32_t)counts_of(loop, state->shot.magnitude);
    bytes_put_u32(message.data, counts);
    bytes_put_u32(message.data + 4, counts);
    send(loop, state, &message);
}

static void send_command(struct shot_state *state, struct loop *loop)
{
    struct can_msg message = {.id = by_side(&state->shot, FRAME_DRIVE_COMMAND_LEFT),
                              .length = FRAME_BYTES_DRIVE_COMMAND_LEFT};
    /* One half of them enables and arms, the other switches off. */
    const bool arms = state->shot.magnitude < 0.5;
    bytes_put_u16(message.data, arms ? 0x000F : 0x0006);
    bytes_put_u32(message.data + 2, arms ? (uint32_t)DRIVE_OUTPUT_LATCH_ARMED : 0);
    send(loop, state, &message);
}

static void send_nmt(struct shot_state *state, struct loop *loop)
{
    static const uint8_t commands[] = {CO_NMT_STOP, CO_NMT_ENTER_PRE_OPERATIONAL, CO_NMT_RESET_NODE};
    const struct can_msg message = {.id = FRAME_NMT,
                                    .length = 2,
                                    .data = {commands[(unsigned)state->shot.magnitude % 3u],
                                             (uint8_t)node_id_of(&state->shot)}};
    send(loop, state, &message);
}

void injector_send_foreign(struct shot_state *state, struct loop *loop)
{
    switch (state->shot.kind) {
    case FAULT_FOREIGN_SENSOR:
        send_sensor(state, loop);
        break;
    case FAULT_FOREIGN_DRIVE:
        send_drive(state, loop);
        break;
    case FAULT_FOREIGN_TARGETS:
        send_targets(state, loop);
        break;
    case FAULT_FOREIGN_COMMAND:
        send_command(state, loop);
        break;
    case FAULT_FOREIGN_SYNC: {
        const struct can_msg sync = {.id = FRAME_SYNC};
        send(loop, state, &sync);
        break;
    }
    case FAULT_FOREIGN_NMT:
        send_nmt(state, loop);
        break;
    default:
        break;
    }
}
