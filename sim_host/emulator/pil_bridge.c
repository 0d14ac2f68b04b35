#include "sim_host/emulator/pil_bridge.h"

#include <string.h>

#include "hal/bus/frame_table.h"

void pil_bridge_init(struct pil_bridge *bridge, struct emulator *emulator)
{
    memset(bridge, 0, sizeof *bridge);
    bridge->emulator = emulator;
    bridge->comparing = true;
    bridge->answer.magic = PIL_MAGIC;
}

static void take_hello(struct pil_bridge *bridge, const struct pil_record *record)
{
    bridge->hello = record->body.hello;
    bridge->starts++;
    bridge->ticks = 0;
}

int pil_bridge_greet(struct pil_bridge *bridge)
{
    struct pil_record record;

    if (emulator_read(bridge->emulator, &record) != 0 || record.kind != PIL_HELLO) {
        bridge->failed = true;
        return -1;
    }
    take_hello(bridge, &record);
    return 0;
}

/* ---- comparing --------------------------------------------------------------- */

static bool same(const struct can_msg *a, const struct can_msg *b)
{
    return a->id == b->id && a->length == b->length && a->flags == b->flags &&
           memcmp(a->data, b->data, sizeof a->data) == 0;
}

static void differ(struct pil_bridge *bridge, const struct pil_difference *difference)
{
    if (bridge->differences++ == 0) {
        bridge->first = *difference;
    }
}

static void compare(struct pil_bridge *bridge, struct can_msg *frames, uint32_t count)
{
    const uint32_t longer = count > bridge->expected_count ? count : bridge->expected_count;

    for (uint32_t i = 0; bridge->comparing && i < longer; i++) {
        struct pil_difference difference = {.tick = bridge->ticks,
                                            .place = i,
                                            .missing = i >= count,
                                            .extra = i >= bridge->expected_count};
        bridge->compared++;
        if (!difference.extra) {
            difference.host = bridge->expected[i];
        }
        if (!difference.missing) {
            if (bridge->compared == bridge->corrupt_frame) {
                frames[i].data[0] ^= 1u;
            }
            difference.image = frames[i];
        }
        if (difference.missing || difference.extra || !same(&difference.host, &difference.image)) {
            differ(bridge, &difference);
        }
    }
    bridge->expected_count = 0;
}

/* ---- the image's side --------------------------------------------------------- */

static void watch_state(struct pil_bridge *bridge, const struct can_msg *frame)
{
    if (frame->id == FRAME_CONTROLLER_STATE && frame->length == FRAME_BYTES_CONTROLLER_STATE) {
        bridge->state = frame->data[0] & 0x3Fu;
        bridge->fault = frame->data[1];
    }
}

static void take_costs(struct pil_bridge *bridge, const struct pil_record *record)
{
    if (bridge->costs != NULL) {
        fprintf(bridge->costs, "%u,%u\n", bridge->ticks, record->instructions);
    }
    if (record->sequence > 0 && record->instructions > bridge->worst_instructions) {
        bridge->worst_instructions = record->instructions;
        bridge->worst_tick = bridge->ticks;
    }
    bridge->total_instructions += record->instructions;
    if (record->stack_unused != 0) {
        bridge->stack_unused = record->stack_unused;
    }
}

/* The image's frames of a tick go onto the bus; its SYNC, the last, waits for the
 * host's clock. */
static void take_cycle(struct pil_bridge *bridge, struct pil_record *record)
{
    uint32_t count = record->count;

    if (count == 0 || record->body.frame[count - 1].id != FRAME_SYNC) {
        bridge->failed = true;
        return;
    }
    count--;
    take_costs(bridge, record);
    compare(bridge, record->body.frame, count);
    for (uint32_t i = 0; i < count; i++) {
        watch_state(bridge, &record->body.frame[i]);
        (void)can_bus_send(&bridge->inner, &record->body.frame[i]);
    }
    bridge->ticks++;
}

static void read_cycle(struct pil_bridge *bridge)
{
    struct pil_record record;

    if (emulator_read(bridge->emulator, &record) != 0) {
        bridge->failed = true;
    } else if (record.kind == PIL_HELLO) {
        take_hello(bridge, &record);
        bridge->dead = true;
        bridge->comparing = false;
    } else {
        take_cycle(bridge, &record);
    }
}

static void write_answer(struct pil_bridge *bridge, enum pil_kind kind)
{
    bridge->answer.kind = (uint16_t)kind;
    bridge->answer.inputs = bridge->inputs;
    if (emulator_write(bridge->emulator, &bridge->answer) != 0) {
        bridge->failed = true;
    }
    bridge->answer.sequence++;
    bridge->answer.count = 0;
}

static void collect(struct pil_bridge *bridge, const struct can_msg *message)
{
    if (bridge->answer.count == PIL_FRAMES) {
        write_answer(bridge, PIL_MORE);
    }
    bridge->answer.body.frame[bridge->answer.count++] = *message;
}

/* ---- the host task's side ------------------------------------------------------ */

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct pil_bridge *bridge = context;

    if (message->id != FRAME_SYNC) {
        if (bridge->expected_count < PIL_EXPECTED_MAX) {
            bridge->expected[bridge->expected_count++] = *message;
        }
        return CAN_OK;
    }
    if (!bridge->primed && !bridge->failed && !bridge->dead) {
        bridge->primed = true;
        read_cycle(bridge);
    }
    if (bridge->dead || bridge->failed) {
        bridge->expected_count = 0;
        return CAN_DOWN;
    }
    return can_bus_send(&bridge->inner, message);
}

static enum can_result bus_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct pil_bridge *bridge = context;
    enum can_result result;

    if (bridge->in_tick) { /* the host's task has finished the tick: now the image's turn */
        bridge->in_tick = false;
        write_answer(bridge, PIL_CYCLE);
        read_cycle(bridge);
    }
    result = can_bus_receive(&bridge->inner, message, time_ns);
    if (result == CAN_OK && !bridge->dead && !bridge->failed) {
        collect(bridge, message);
        bridge->in_tick = message->id == FRAME_SYNC && (message->flags & CAN_FRAME_OWN) != 0;
    }
    return result;
}

static void bus_get_status(void *context, struct can_bus_status *status)
{
    struct pil_bridge *bridge = context;
    can_bus_get_status(&bridge->inner, status);
}

static void bus_recover(void *context)
{
    struct pil_bridge *bridge = context;
    can_bus_recover(&bridge->inner);
}

static const struct can_bus_ops bridge_ops = {bus_send, bus_receive, bus_get_status, bus_recover};

struct can_bus pil_bridge_wrap(void *context, struct can_bus inner)
{
    struct pil_bridge *bridge = context;
    const struct can_bus bus = {&bridge_ops, bridge};

    bridge->inner = inner;
    return bus;
}

void pil_bridge_revive(struct pil_bridge *bridge)
{
    bridge->dead = false;
    bridge->primed = false;
    bridge->answer.count = 0;
    bridge->expected_count = 0;
}
