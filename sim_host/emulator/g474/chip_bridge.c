#include "sim_host/emulator/g474/chip_bridge.h"

#include <string.h>

#include "hal/bus/frame_table.h"

enum {
    PERIOD_NS = TICK_PERIOD_US * 1000,
    SYNC_PATIENCE_NS = PERIOD_NS + PERIOD_NS / 2,
    PERMIT_PATIENCE_TICKS = 50, /* without an edge on PC1 while the drives work */
    CCCR = 0x18 / 4,
    TXBC = 0xC0 / 4,
    CCCR_INIT = 1,
    TXBC_QUEUE = 1 << 24,
    PORT = LOOP_PORT_CONTROLLER,
    PORT_C = 2,
    CUT_PIN = 5
};

void chip_bridge_init(struct chip_bridge *bridge, struct chip *chip)
{
    memset(bridge, 0, sizeof *bridge);
    bridge->chip = chip;
    bridge->comparing = true;
}

/* ---- FDCAN1 and the bus ------------------------------------------------------------------------ */

static uint32_t start_bits(const struct loop *loop, const struct can_msg *message, uint64_t end_ns)
{
    const unsigned bits = frame_bits_stuffed(&loop->bus.bits, message) + FRAME_BITS_TAIL;
    return (uint32_t)(end_ns / loop->bus.bit_ns) - bits;
}

static int buffer_of(const struct chip_bridge *bridge, uint32_t id)
{
    for (int i = 0; i < 3; i++) {
        if ((bridge->submitted >> i & 1u) != 0 && bridge->submitted_id[i] == id) {
            return i;
        }
    }
    return -1;
}

static void watch_image(struct chip_bridge *bridge, const struct can_msg *message)
{
    bridge->heard = true;
    chip_bridge_compare(bridge, message);
    if (message->id == FRAME_CONTROLLER_STATE && message->length == FRAME_BYTES_CONTROLLER_STATE) {
        bridge->state = message->data[0] & 0x3Fu;
        bridge->fault = message->data[1];
    }
}

static void end_own(struct chip_bridge *bridge, const struct sim_bus_event *event)
{
    struct fdcan_model *can = &bridge->chip->can;
    const int buffer = buffer_of(bridge, event->message.id);

    if (buffer < 0) {
        return; /* repeated by the bus after the chip had left it */
    }
    can->on_wire = buffer;
    if (event->kind == SIM_BUS_FRAME) {
        can->time_bits = start_bits(bridge->loop, &event->message, event->time_ns);
        fdcan_model_end_good(can);
        bridge->submitted &= ~(1u << buffer);
        watch_image(bridge, &event->message);
    } else {
        /* ISO 11898-1, exception A: a passive node that only misses the acknowledge. */
        if (bridge->loop->bus.outcome == SIM_BUS_ENDS_UNHEARD && can->tec >= 128) {
            can->tec -= 8;
        }
        fdcan_model_end_disturbed(can);
    }
}

static void on_event(void *context, const struct sim_bus_event *event)
{
    struct chip_bridge *bridge = context;
    struct fdcan_model *can = &bridge->chip->can;

    if (bridge->tap != NULL) {
        bridge->tap(bridge->tap_context, event);
    }
    switch (event->kind) {
    case SIM_BUS_FRAME:
        if (event->port == PORT) {
            end_own(bridge, event);
        } else if (event->message.id == (uint32_t)FRAME_SDO_REQUEST_CONTROLLER) {
            bridge->asked_ns = event->time_ns;
        }
        break;
    case SIM_BUS_ERROR_FRAME:
        if (event->port == PORT) {
            end_own(bridge, event);
        } else if (bridge->joined && !can->bus_off) { /* in bus-off it hears nothing */
            fdcan_model_receive_error(can);
        }
        break;
    case SIM_BUS_NODE_BUS_OFF:
        if (event->port == PORT) {
            bridge->submitted = 0;
        }
        break;
    case SIM_BUS_NODE_RECOVERED:
        while (event->port == PORT && can->bus_off && (can->reg[CCCR] & CCCR_INIT) == 0) {
            fdcan_model_recessive(can);
        }
        break;
    }
}

static struct sim_bus_fault on_frame(void *context, const struct can_msg *message, unsigned sender,
                                     uint64_t time_ns)
{
    const struct chip_bridge *bridge = context;

    if (time_ns >= bridge->destroy_from_ns && time_ns < bridge->destroy_until_ns) {
        return (struct sim_bus_fault){.kind = SIM_BUS_FAULT_DESTROY, .bit = 20};
    }
    return bridge->hook(bridge->hook_context, message, sender, time_ns);
}

static struct can_msg frame_in(const struct fdcan_model *can, int buffer)
{
    const uint32_t *element = &can->ram[28 + 16 + 2 * 54 + 6 + buffer * 18];
    struct can_msg message = {.id = element[0] >> 18 & 0x7FF,
                              .length = (uint8_t)(element[1] >> 16 & 0xF)};

    for (unsigned i = 0; i < 8; i++) {
        message.data[i] = (uint8_t)(element[2 + i / 4] >> (8 * (i % 4)));
    }
    return message;
}

static void join_or_leave(struct chip_bridge *bridge)
{
    struct chip *chip = bridge->chip;
    struct fdcan_model *can = &chip->can;
    const bool runs = (can->reg[CCCR] & CCCR_INIT) == 0;
    const bool joined = chip_can_is_on_bus(chip);

    if (joined != bridge->joined && !can->bus_off) {
        bridge->joined = joined;
        if (!joined) {
            sim_bus_reset_port(&bridge->loop->bus, PORT);
            bridge->submitted = 0;
        }
        sim_bus_connect(&bridge->loop->bus, PORT, joined);
    }
    if (runs && !joined && can->pending != 0 && chip->clocks.crystal_works) {
        chip_find(chip, "FDCAN1 sends, but is no node of a bus at 1 Mbit/s: pins, clock or "
                        "bit timing");
    }
    if (can->bus_off && runs) {
        can_bus_recover(&bridge->inner);
    }
}

/* What the program asked for and took back goes to and from the port's queue. */
static void exchange_requests(struct chip_bridge *bridge)
{
    struct chip *chip = bridge->chip;
    struct fdcan_model *can = &chip->can;

    for (int i = 0; i < 3 && bridge->joined; i++) {
        const uint32_t bit = 1u << i;
        const struct can_msg message = frame_in(can, i);
        if ((bridge->submitted & bit) != 0 && (can->pending & bit) == 0) {
            (void)sim_bus_withdraw(&bridge->loop->bus, PORT, bridge->submitted_id[i]);
            bridge->submitted &= ~bit;
        } else if ((bridge->submitted & bit) == 0 && (can->pending & bit) != 0) {
            if ((can->reg[TXBC] & TXBC_QUEUE) == 0) {
                chip_find(chip, "the transmit buffers are no queue");
            }
            if (message.id == FRAME_SYNC && !bridge->sync_held) {
                bridge->sync_held = true;
                continue;
            }
            if (can_bus_send(&bridge->inner, &message) == CAN_OK) {
                bridge->submitted |= bit;
                bridge->submitted_id[i] = message.id;
            }
        }
    }
    const struct sim_bus *bus = &bridge->loop->bus;
    can->on_wire = bus->phase == SIM_BUS_TRANSMIT && (bus->contenders >> PORT & 1u) != 0
                       ? buffer_of(bridge, bus->wire.message.id)
                       : -1;
}

static void look_at_can(struct chip_bridge *bridge)
{
    join_or_leave(bridge);
    exchange_requests(bridge);
    chip_update(bridge->chip);
}

/* Chip and bus go on, at most to `until_ns`. */
static void step(struct chip_bridge *bridge, uint64_t until_ns)
{
    struct chip *chip = bridge->chip;
    struct sim_bus *bus = &bridge->loop->bus;
    const uint64_t next_ns = sim_bus_next_ns(bus);
    const uint64_t target_ns = next_ns < until_ns ? next_ns : until_ns;

    if (target_ns > chip_now_ns(chip)) {
        chip_run(chip, target_ns);
    }
    sim_bus_run_until(bus, chip_now_ns(chip));
    if (chip->flash_registers.power_off) {
        chip_power_cycle(chip);
    }
    if (chip->resets != bridge->resets_seen) {
        if (bridge->resets_seen != 0) {
            chip_bridge_stop_comparing(bridge);
        }
        bridge->resets_seen = chip->resets;
        bridge->heard = false;
        bridge->sync_held = false;
    }
    look_at_can(bridge);
}

/* ---- The host task's side ------------------------------------------------------------------------- */

static enum can_result bus_send(void *context, const struct can_msg *message)
{
    struct chip_bridge *bridge = context;

    if (bridge->comparing && bridge->expected_count < CHIP_EXPECTED_MAX) {
        bridge->expected[bridge->expected_count++] =
            (struct chip_expected){*message, bridge->ticks};
    }
    return CAN_OK;
}

static bool give_to_fdcan(struct chip_bridge *bridge, const struct can_msg *message,
                          uint64_t end_ns)
{
    struct model_frame frame = {.id = message->id, .length = message->length};

    memcpy(frame.data, message->data, sizeof frame.data);
    return bridge->joined && fdcan_model_receive(&bridge->chip->can, &frame,
                                                 (message->flags & CAN_FRAME_EXTENDED) != 0,
                                                 (message->flags & CAN_FRAME_REMOTE) != 0,
                                                 start_bits(bridge->loop, message, end_ns));
}

static enum can_result bus_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct chip_bridge *bridge = context;
    uint64_t end_ns = 0;

    for (;;) {
        const enum can_result result = can_bus_receive(&bridge->inner, message, &end_ns);
        if (time_ns != NULL) {
            *time_ns = end_ns;
        }
        if (result != CAN_OK || (message->flags & CAN_FRAME_OWN) != 0 ||
            ((message->flags & CAN_FRAME_ERROR) == 0 && give_to_fdcan(bridge, message, end_ns))) {
            return result;
        }
    }
}

static void bus_get_status(void *context, struct can_bus_status *status)
{
    struct chip_bridge *bridge = context;
    can_bus_get_status(&bridge->inner, status);
}

static void bus_recover(void *context)
{
    (void)context; /* the port is the image's */
}

static const struct can_bus_ops bridge_ops = {bus_send, bus_receive, bus_get_status, bus_recover};

struct can_bus chip_bridge_wrap(void *context, struct can_bus inner)
{
    struct chip_bridge *bridge = context;
    const struct can_bus bus = {&bridge_ops, bridge};

    bridge->inner = inner;
    return bus;
}

void chip_bridge_connect(struct chip_bridge *bridge, struct loop *loop)
{
    bridge->loop = loop;
    bridge->tap = loop->bus.tap;
    bridge->tap_context = loop->bus.tap_context;
    bridge->hook = loop->bus.fault_hook;
    bridge->hook_context = loop->bus.fault_context;
    sim_bus_set_tap(&loop->bus, on_event, bridge);
    sim_bus_set_fault_hook(&loop->bus, on_frame, bridge);
    sim_bus_connect(&loop->bus, PORT, false);
    drive_power_init(&loop->rig.drive_power, NULL); /* end_period() holds the relay */
}

/* ---- A period ---------------------------------------------------------------------------------------- */

/* Of a period, or of as much of it as passed until the bridge saw that no SYNC comes. A start is no tick. */
static void note_instructions(struct chip_bridge *bridge)
{
    struct chip *chip = bridge->chip;
    const uint32_t cost = (uint32_t)(chip->instructions - bridge->tick_began_instructions);
    const bool counts = bridge->ticks > 0 && chip->resets == bridge->tick_began_resets;
    const bool worst = counts && cost > bridge->worst_instructions;

    if (counts && bridge->costs != NULL) {
        fprintf(bridge->costs, "%u,%u\n", bridge->ticks, cost);
    }
    if (worst) {
        bridge->worst_instructions = cost;
        bridge->worst_tick = bridge->ticks;
    }
    if (chip->profile != NULL) {
        chip_profile_end_tick(chip->profile, bridge->ticks, worst);
    }
    bridge->tick_began_instructions = chip->instructions;
    bridge->tick_began_resets = chip->resets;
}

static void note_lateness(struct chip_bridge *bridge)
{
    const uint64_t now_ns = chip_now_ns(bridge->chip);
    const uint64_t took_ns = now_ns - bridge->sync_ns;
    const uint64_t late_ns = took_ns > PERIOD_NS ? took_ns - PERIOD_NS : PERIOD_NS - took_ns;

    /* The first period is short: the clock ran while the rest started. */
    if (bridge->ticks > 1 && bridge->silent_periods == 0 && late_ns > bridge->sync_late_ns) {
        bridge->sync_late_ns = late_ns;
        bridge->sync_late_tick = bridge->ticks;
    }
    bridge->sync_ns = now_ns;
}

/* The drives have power only while PC1 toggles. */
static void check_permit(struct chip_bridge *bridge)
{
    struct chip *chip = bridge->chip;
    const bool works = bridge->state == SUPERVISOR_ENGAGING || bridge->state == SUPERVISOR_WALKING;
    const uint64_t age_ns = chip_now_ns(chip) - chip->permit_edge_ns;

    bridge->idle_permit_ticks =
        works && age_ns > 2 * (uint64_t)PERIOD_NS ? bridge->idle_permit_ticks + 1 : 0;
    if (bridge->idle_permit_ticks == PERMIT_PATIENCE_TICKS) {
        chip_find(chip, "PC1 does not toggle: the drives have no power");
    }
}

/* The image's own pins hold the relay, not the host's task that runs along. */
static void end_period(struct chip_bridge *bridge)
{
    const struct chip *chip = bridge->chip;
    struct loop *loop = bridge->loop;

    if (chip->permit_edges != bridge->permit_edges_seen) {
        bridge->permit_edges_seen = chip->permit_edges;
        drive_power_enable_toggle(&loop->relay.lines);
    }
    drive_power_enable_cut(&loop->relay.lines, chip_gives(chip, PORT_C, CUT_PIN));
    loop_end_period(loop, sim_bus_now_ns(&loop->bus));
}

static void begin_tick(struct chip_bridge *bridge)
{
    note_instructions(bridge);
    note_lateness(bridge);
    if (bridge->ticks > 0) {
        end_period(bridge);
    }
    bridge->silent_periods = 0;
    bridge->ticks++;
    chip_bridge_check_missing(bridge);
    check_permit(bridge);
    (void)control_task_start_cycle(&bridge->loop->rig.task);
    look_at_can(bridge); /* the held SYNC goes */
    bridge->sync_held = false;
}

void chip_bridge_pass(struct chip_bridge *bridge, uint64_t time_ns)
{
    const uint64_t until_ns = chip_now_ns(bridge->chip) + time_ns;

    while (!bridge->sync_held && chip_now_ns(bridge->chip) < until_ns) {
        step(bridge, until_ns);
    }
}

void chip_bridge_tick(struct chip_bridge *bridge)
{
    chip_bridge_pass(bridge, bridge->silent_periods == 0 ? SYNC_PATIENCE_NS : PERIOD_NS);
    if (bridge->sync_held) {
        begin_tick(bridge);
        return;
    }
    note_instructions(bridge);
    bridge->silent_periods++;
    if (bridge->ticks > 0) {
        end_period(bridge);
    }
}
