#include "sim_host/faults/foreign_node.h"

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "sim_host/faults/strange_tool.h"

enum rhythm { FIXED_PHASE, DRIFTING, FAST, SLOW, SPORADIC, ONCE, RHYTHMS };

static const double TICK_NS = TICK_PERIOD_US * 1e3;
static const double CLOCK_OFF = 0.01;
static const double PI = 3.14159265358979323846;

void foreign_node_begin(struct shot_state *state, uint64_t now_ns)
{
    if (!fault_kind_is_foreign(state->shot.kind)) {
        return;
    }
    const unsigned rhythm = (unsigned)(injector_random(&state->rng) * (double)RHYTHMS);
    double period_ns = TICK_NS;
    switch (rhythm) {
    case DRIFTING:
        period_ns *= 1.0 + injector_between(state, -CLOCK_OFF, CLOCK_OFF);
        break;
    case FAST:
        period_ns *= injector_between(state, 0.15, 1.0);
        break;
    case SLOW:
        period_ns *= injector_between(state, 1.0, 20.0);
        break;
    case SPORADIC:
        period_ns *= injector_between(state, 5.0, 100.0);
        break;
    case ONCE:
        period_ns = 1e15;
        break;
    default:
        break;
    }
    state->sporadic = rhythm == SPORADIC;
    state->period_ns = (uint64_t)period_ns;
    state->next_ns = now_ns + (uint64_t)injector_between(state, 0.0, TICK_NS - 1.0);
}

/* ---- what it sends --------------------------------------------------------------- */

static int32_t counts_of(const struct loop *loop, double metres)
{
    return (int32_t)(metres *
                     (double)loop->config.subject.device.description.leg[SIDE_LEFT].counts_per_m);
}

static struct can_msg sensor_frame(const struct fault_shot *shot)
{
    struct can_msg message = {.id = injector_by_side(shot, FRAME_LEG_STATE_LEFT),
                              .length = FRAME_BYTES_LEG_STATE_LEFT};
    const double turns = shot->magnitude / (2.0 * PI);
    const uint32_t counts = (uint32_t)(int32_t)(turns * (double)LEG_ANGLE_COUNTS_PER_TURN);
    message.data[0] = (uint8_t)(counts & 0xFFu);
    message.data[1] = (uint8_t)(counts >> 8 & 0xFFu);
    message.data[2] = (uint8_t)(counts >> 16 & 0xFFu);
    return message;
}

static struct can_msg drive_frame(const struct fault_shot *shot, const struct loop *loop)
{
    struct can_msg message = {.id = injector_by_side(shot, FRAME_DRIVE_STATE_LEFT),
                              .length = FRAME_BYTES_DRIVE_STATE_LEFT};
    bytes_put_u16(message.data, 0x5237); /* enabled, latch closed */
    bytes_put_u32(message.data + 2, (uint32_t)counts_of(loop, shot->magnitude));
    return message;
}

static struct can_msg targets_frame(const struct fault_shot *shot, const struct loop *loop)
{
    struct can_msg message = {.id = FRAME_DRIVE_TARGETS, .length = FRAME_BYTES_DRIVE_TARGETS};
    const uint32_t counts = (uint32_t)counts_of(loop, shot->magnitude);
    bytes_put_u32(message.data, counts);
    bytes_put_u32(message.data + 4, counts);
    return message;
}

/* Half of them enable and arm; the others switch off, stop, disable, or reset a fault. */
static struct can_msg command_frame(const struct fault_shot *shot)
{
    static const uint16_t others[] = {0x0006, 0x0002, 0x0007, 0x0000, 0x0080};
    struct can_msg message = {.id = injector_by_side(shot, FRAME_DRIVE_COMMAND_LEFT),
                              .length = FRAME_BYTES_DRIVE_COMMAND_LEFT};
    const bool arms = shot->magnitude < 0.5;
    const unsigned other = arms ? 0u : (unsigned)((shot->magnitude - 0.5) * 10.0) % 5u;
    bytes_put_u16(message.data, arms ? 0x000F : others[other]);
    bytes_put_u32(message.data + 2, arms ? (uint32_t)DRIVE_OUTPUT_LATCH_ARMED : 0);
    return message;
}

static struct can_msg nmt_frame(const struct fault_shot *shot)
{
    static const uint8_t commands[] = {CO_NMT_STOP, CO_NMT_ENTER_PRE_OPERATIONAL,
                                       CO_NMT_RESET_NODE};
    return (struct can_msg){
        .id = FRAME_NMT,
        .length = 2,
        .data = {commands[(unsigned)shot->magnitude % 3u], (uint8_t)injector_node_id(shot)}};
}

static struct can_msg frame_of(struct shot_state *state, const struct loop *loop)
{
    const struct fault_shot *shot = &state->shot;
    switch (shot->kind) {
    case FAULT_FOREIGN_SENSOR:
        return sensor_frame(shot);
    case FAULT_FOREIGN_DRIVE:
        return drive_frame(shot, loop);
    case FAULT_FOREIGN_TARGETS:
        return targets_frame(shot, loop);
    case FAULT_FOREIGN_COMMAND:
        return command_frame(shot);
    case FAULT_FOREIGN_NMT:
        return nmt_frame(shot);
    case FAULT_FOREIGN_SDO:
    case FAULT_FOREIGN_SDO_CONTROLLER:
        return strange_tool_frame(state, loop);
    default:
        return (struct can_msg){.id = FRAME_SYNC};
    }
}

void foreign_node_send(struct shot_state *state, struct loop *loop)
{
    struct sim_bus_port *port = &loop->bus.ports[INJECTOR_PORT_FOREIGN];
    const struct can_bus bus = sim_bus_port(&loop->bus, INJECTOR_PORT_FOREIGN);
    const struct can_msg message = frame_of(state, loop);
    can_bus_recover(&bus);
    /* One mailbox: while the last frame waits there is no other. */
    if (port->tx_count == 0 && can_bus_send(&bus, &message) == CAN_OK) {
        state->changed++;
    }
    const double factor = state->sporadic ? 0.1 + 1.8 * injector_random(&state->rng) : 1.0;
    state->next_ns += (uint64_t)(factor * (double)state->period_ns);
}
