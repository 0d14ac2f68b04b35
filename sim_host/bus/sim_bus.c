/* Arbitration, transmission and virtual time of the in-process bus. */
#include "sim_host/bus/sim_bus.h"

#include <assert.h>
#include <string.h>

#include "sim_host/bus/sim_bus_internal.h"

enum { NS_PER_S = 1000000000 };

void sim_bus_init(struct sim_bus *bus, uint32_t bitrate)
{
    assert(bitrate >= 10000 && bitrate <= 1000000 && NS_PER_S % bitrate == 0);
    memset(bus, 0, sizeof *bus);
    frame_bits_init(&bus->bits);
    bus->bit_ns = (uint32_t)NS_PER_S / bitrate;
}

uint64_t sim_bus_now_ns(const struct sim_bus *bus)
{
    return bus->now_ns;
}

double sim_bus_load(const struct sim_bus *bus)
{
    return bus->now_ns == 0 ? 0.0 : (double)bus->busy_ns / (double)bus->now_ns;
}

void sim_bus_set_fault_hook(struct sim_bus *bus, sim_bus_fault_hook hook, void *context)
{
    bus->fault_hook = hook;
    bus->fault_context = context;
}

void sim_bus_measure_response(struct sim_bus *bus, struct sim_bus_response *response)
{
    bus->response = response;
    if (response != NULL) {
        memset(response, 0, sizeof *response);
    }
}

/* What the port would send now: the head of its queue or its babble. */
static bool head_of(struct sim_bus_port *port, struct sim_bus_tx_entry *entry)
{
    const uint64_t now_ns = port->bus->now_ns;
    if (port->babbling && now_ns >= port->babble_until_ns) {
        port->babbling = false;
    }
    const bool queued = port->tx_count > 0;
    if (!queued && !port->babbling) {
        port->bus->pending &= ~(UINT32_C(1) << port->index);
        return false;
    }
    if (!port->connected || port->status.error_state == CAN_BUS_OFF) {
        return false;
    }
    if (queued) {
        *entry = port->tx[port->tx_count - 1];
    }
    if (port->babbling) {
        const uint32_t key = sim_bus_key(&port->babble);
        if (!queued || key < entry->key) {
            *entry = (struct sim_bus_tx_entry){.key = key,
                                               .hook_done = true,
                                               .is_babble = true,
                                               .queued_ns = now_ns,
                                               .message = port->babble};
        }
    }
    return true;
}

static void pop_head(struct sim_bus_port *port, const struct sim_bus_tx_entry *entry)
{
    if (!entry->is_babble) {
        port->tx_count--;
        if (port->tx_count == 0 && !port->babbling) {
            port->bus->pending &= ~(UINT32_C(1) << port->index);
        }
    }
}

static bool same_frame(const struct can_msg *a, const struct can_msg *b)
{
    return a->length == b->length && memcmp(a->data, b->data, a->length) == 0;
}

/* Finds the winner of arbitration among the nodes that may start now; the frame
 * comes off its queue into bus->wire. *again_ns: when a suspended node may. */
static bool arbitrate(struct sim_bus *bus, uint64_t *again_ns)
{
    uint32_t best = UINT32_MAX;
    bool found = false;
    bus->contenders = 0;
    bus->outcome = SIM_BUS_ENDS_WELL;
    for (uint32_t left = bus->pending; left != 0; left &= left - 1) {
        const unsigned i = (unsigned)__builtin_ctz(left);
        struct sim_bus_port *port = &bus->ports[i];
        struct sim_bus_tx_entry *entry = &bus->rivals[i];
        if (!head_of(port, entry)) {
            continue;
        }
        if (port->may_start_ns > bus->now_ns) {
            *again_ns = port->may_start_ns < *again_ns ? port->may_start_ns : *again_ns;
            continue;
        }
        if (!found || entry->key < best) {
            found = true;
            best = entry->key;
            bus->wire = *entry;
            bus->sender = i;
            bus->contenders = UINT32_C(1) << i;
            bus->outcome = SIM_BUS_ENDS_WELL;
        } else if (entry->key == best) {
            /* Two senders of one identifier: harmless only when all is equal. */
            bus->contenders |= UINT32_C(1) << i;
            if (!same_frame(&entry->message, &bus->wire.message)) {
                bus->outcome = SIM_BUS_ENDS_DESTROYED;
            }
        }
    }
    return found;
}

static bool anybody_listens(const struct sim_bus *bus)
{
    for (unsigned i = 0; i < bus->port_count; i++) {
        if ((bus->contenders >> i & 1U) == 0 && sim_bus_is_on(&bus->ports[i])) {
            return true;
        }
    }
    return false;
}

/* Asks the fault hook; true when the frame was taken off the bus. */
static bool apply_fault(struct sim_bus *bus)
{
    bus->fault.kind = SIM_BUS_FAULT_NONE;
    if (bus->fault_hook == NULL || bus->wire.hook_done) {
        return false;
    }
    bus->fault = bus->fault_hook(bus->fault_context, &bus->wire.message, bus->sender, bus->now_ns);
    switch (bus->fault.kind) {
    case SIM_BUS_FAULT_DELAY:
        if (bus->delayed_count == SIM_BUS_DELAYED_MAX) {
            bus->fault.kind = SIM_BUS_FAULT_NONE; /* no room: it passes, and is not counted */
            return false;
        }
        bus->wire.hook_done = true;
        bus->delayed[bus->delayed_count++] = (struct sim_bus_delayed){
            .due_ns = bus->now_ns + bus->fault.delay_ns, .port = bus->sender, .entry = bus->wire};
        bus->stats.faults[SIM_BUS_FAULT_DELAY]++;
        return true;
    case SIM_BUS_FAULT_ALTER:
        for (unsigned i = 0; i < bus->wire.message.length; i++) {
            bus->wire.message.data[i] ^= bus->fault.flip[i];
        }
        bus->wire.hook_done = true;
        break;
    case SIM_BUS_FAULT_DESTROY:
        bus->outcome = SIM_BUS_ENDS_DESTROYED;
        break;
    case SIM_BUS_FAULT_NONE:
    case SIM_BUS_FAULT_DROP:
    case SIM_BUS_FAULT_DUPLICATE:
        break;
    }
    bus->stats.faults[bus->fault.kind]++;
    return false;
}

/* Bits until the error flag begins, for a frame that will not end well. */
static unsigned bits_until_error(const struct sim_bus *bus, unsigned stuffed)
{
    if (bus->outcome == SIM_BUS_ENDS_UNHEARD) {
        return stuffed + 2; /* CRC delimiter, recessive acknowledge slot */
    }
    if (bus->fault.kind == SIM_BUS_FAULT_DESTROY) {
        const unsigned last = stuffed + FRAME_BITS_TAIL - 1;
        return bus->fault.bit + 1U < last ? bus->fault.bit + 1U : last;
    }
    return stuffed; /* two senders: taken as seen at the latest in the CRC */
}

static void begin_frame(struct sim_bus *bus)
{
    for (uint32_t left = bus->contenders; left != 0; left &= left - 1) {
        const unsigned i = (unsigned)__builtin_ctz(left);
        pop_head(&bus->ports[i], &bus->rivals[i]);
    }
    if (apply_fault(bus)) {
        return; /* delayed: the bus stays idle, the next in line tries */
    }
    if (bus->outcome == SIM_BUS_ENDS_WELL && !anybody_listens(bus)) {
        bus->outcome = SIM_BUS_ENDS_UNHEARD;
    }
    const unsigned stuffed = frame_bits_stuffed(&bus->bits, &bus->wire.message);
    unsigned bits = stuffed + FRAME_BITS_TAIL;
    if (bus->outcome != SIM_BUS_ENDS_WELL) {
        bits =
            bits_until_error(bus, stuffed) + SIM_BUS_ERROR_FLAG_BITS + SIM_BUS_ERROR_DELIMITER_BITS;
    }
    if (bus->recovering != 0) {
        const uint64_t idle_bits = (bus->now_ns - bus->idle_since_ns) / bus->bit_ns;
        uint32_t wake = 0;
        sim_bus_count_recessive(bus, (uint32_t)(idle_bits / SIM_BUS_RECESSIVE_BITS), &wake);
    }
    bus->phase = SIM_BUS_TRANSMIT;
    bus->phase_end_ns = bus->now_ns + (uint64_t)bits * bus->bit_ns;
    bus->busy_ns += (uint64_t)(bits + FRAME_BITS_INTERMISSION) * bus->bit_ns;
}

static void note_response(struct sim_bus *bus)
{
    const struct can_msg *message = &bus->wire.message;
    if (bus->response == NULL || (message->flags & CAN_FRAME_EXTENDED) != 0) {
        return;
    }
    const uint64_t took_ns = bus->now_ns - bus->wire.queued_ns;
    bus->response->count[message->id]++;
    if (took_ns > bus->response->worst_ns[message->id]) {
        bus->response->worst_ns[message->id] = took_ns;
    }
}

/* Everybody hears the frame. Returns the ports to wake. */
static uint32_t end_frame_well(struct sim_bus *bus)
{
    const struct can_msg *message = &bus->wire.message;
    const bool is_sync = message->id == SIM_BUS_SYNC_ID &&
                         (message->flags & (CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE)) == 0;
    const bool drops = bus->fault.kind == SIM_BUS_FAULT_DROP;
    const uint32_t deaf = !drops                      ? 0
                          : bus->fault.receivers == 0 ? UINT32_MAX
                                                      : bus->fault.receivers;
    uint32_t wake = 0;
    for (unsigned i = 0; i < bus->port_count; i++) {
        struct sim_bus_port *port = &bus->ports[i];
        const uint32_t bit = UINT32_C(1) << i;
        if ((bus->contenders & bit) != 0) {
            sim_bus_transmit_succeeded(port);
            if (is_sync && (deaf & bit) == 0) {
                struct can_msg echo = *message;
                echo.flags |= CAN_FRAME_OWN;
                sim_bus_deliver(port, &echo, bus->now_ns);
                wake |= bit;
            }
        } else if (sim_bus_is_on(port) && (deaf & bit) == 0) {
            sim_bus_receive_succeeded(port);
            sim_bus_deliver(port, message, bus->now_ns);
            wake |= bit;
        }
    }
    bus->stats.frames++;
    bus->stats.babble_frames += bus->wire.is_babble ? 1 : 0;
    note_response(bus);
    sim_bus_report(bus, SIM_BUS_FRAME, &bus->ports[bus->sender], message);
    if (bus->fault.kind == SIM_BUS_FAULT_DUPLICATE) {
        struct sim_bus_tx_entry copy = bus->wire;
        copy.hook_done = true;
        (void)sim_bus_queue_insert(&bus->ports[bus->sender], &copy, true);
    }
    return wake;
}

/* An error frame: counters go up, the senders try again. */
static uint32_t end_frame_badly(struct sim_bus *bus)
{
    uint32_t wake = 0;
    bus->stats.error_frames++;
    sim_bus_report(bus, SIM_BUS_ERROR_FRAME, &bus->ports[bus->sender], &bus->wire.message);
    for (unsigned i = 0; i < bus->port_count; i++) {
        struct sim_bus_port *port = &bus->ports[i];
        if ((bus->contenders >> i & 1U) != 0) {
            wake |= sim_bus_transmit_failed(bus, port, bus->outcome == SIM_BUS_ENDS_UNHEARD);
            if (port->status.error_state != CAN_BUS_OFF && !bus->wire.is_babble) {
                (void)sim_bus_queue_insert(port, i == bus->sender ? &bus->wire : &bus->rivals[i],
                                           true);
            }
        } else if (sim_bus_is_on(port)) {
            wake |= sim_bus_receive_failed(bus, port);
        }
    }
    return wake;
}

static void wake_ports(struct sim_bus *bus, uint32_t wake)
{
    for (; wake != 0; wake &= wake - 1) {
        struct sim_bus_port *port = &bus->ports[__builtin_ctz(wake)];
        if (port->wake != NULL) {
            port->wake(port->context, bus->now_ns);
        }
    }
}

static void end_frame(struct sim_bus *bus)
{
    bus->now_ns = bus->phase_end_ns;
    bus->phase = SIM_BUS_INTERMISSION;
    bus->phase_end_ns += (uint64_t)FRAME_BITS_INTERMISSION * bus->bit_ns;
    uint32_t wake = bus->outcome == SIM_BUS_ENDS_WELL ? end_frame_well(bus) : end_frame_badly(bus);
    for (uint32_t left = bus->contenders; left != 0; left &= left - 1) {
        struct sim_bus_port *port = &bus->ports[__builtin_ctz(left)];
        if (port->status.error_state == CAN_ERROR_PASSIVE) {
            port->may_start_ns = bus->phase_end_ns + (uint64_t)SIM_BUS_SUSPEND_BITS * bus->bit_ns;
        }
    }
    if (bus->recovering != 0) {
        sim_bus_count_recessive(bus, 1, &wake); /* delimiter, EOF and intermission: 11 bits */
    }
    wake_ports(bus, wake);
}

static void release_delayed(struct sim_bus *bus)
{
    unsigned kept = 0;
    for (unsigned i = 0; i < bus->delayed_count; i++) {
        struct sim_bus_delayed *late = &bus->delayed[i];
        if (late->due_ns <= bus->now_ns) {
            (void)sim_bus_queue_insert(&bus->ports[late->port], &late->entry, true);
        } else {
            bus->delayed[kept++] = *late;
        }
    }
    bus->delayed_count = kept;
}

/* The next moment at which an idle bus has something to do by itself. */
static uint64_t next_own_event(const struct sim_bus *bus, uint64_t until_ns)
{
    uint64_t next_ns = until_ns;
    for (unsigned i = 0; i < bus->delayed_count; i++) {
        next_ns = bus->delayed[i].due_ns < next_ns ? bus->delayed[i].due_ns : next_ns;
    }
    for (uint32_t left = bus->recovering; left != 0; left &= left - 1) {
        const struct sim_bus_port *port = &bus->ports[__builtin_ctz(left)];
        const uint64_t due_ns = bus->idle_since_ns + (uint64_t)port->recovery_left *
                                                         SIM_BUS_RECESSIVE_BITS * bus->bit_ns;
        next_ns = due_ns < next_ns ? due_ns : next_ns;
    }
    return next_ns;
}

/* Lets an idle bus go on to time_ns; recovering nodes count the silence. */
static void stay_idle(struct sim_bus *bus, uint64_t time_ns)
{
    bus->now_ns = time_ns > bus->now_ns ? time_ns : bus->now_ns;
    if (bus->recovering != 0) {
        const uint64_t sequence_ns = (uint64_t)SIM_BUS_RECESSIVE_BITS * bus->bit_ns;
        const uint64_t sequences = (bus->now_ns - bus->idle_since_ns) / sequence_ns;
        uint32_t wake = 0;
        bus->idle_since_ns += sequences * sequence_ns;
        sim_bus_count_recessive(bus, (uint32_t)sequences, &wake);
        wake_ports(bus, wake);
    }
}

uint64_t sim_bus_next_ns(const struct sim_bus *bus)
{
    if (bus->phase != SIM_BUS_IDLE) {
        return bus->phase_end_ns;
    }
    uint64_t next_ns = next_own_event(bus, UINT64_MAX);
    for (uint32_t left = bus->pending; left != 0; left &= left - 1) {
        const struct sim_bus_port *port = &bus->ports[__builtin_ctz(left)];
        if (sim_bus_is_on(port) && port->may_start_ns < next_ns) {
            next_ns = port->may_start_ns;
        }
    }
    return next_ns > bus->now_ns ? next_ns : bus->now_ns;
}

void sim_bus_run_until(struct sim_bus *bus, uint64_t until_ns)
{
    while (bus->now_ns <= until_ns) {
        if (bus->phase != SIM_BUS_IDLE) {
            if (bus->phase_end_ns > until_ns) {
                bus->now_ns = until_ns;
                return;
            }
            if (bus->phase == SIM_BUS_TRANSMIT) {
                end_frame(bus);
            } else {
                bus->now_ns = bus->phase_end_ns;
                bus->idle_since_ns = bus->now_ns;
                bus->phase = SIM_BUS_IDLE;
            }
            continue;
        }
        if (bus->delayed_count > 0) {
            release_delayed(bus);
        }
        uint64_t next_ns = UINT64_MAX;
        if (bus->pending != 0 && arbitrate(bus, &next_ns)) {
            begin_frame(bus);
            continue;
        }
        const uint64_t own_ns = next_own_event(bus, until_ns);
        next_ns = own_ns < next_ns ? own_ns : next_ns;
        const bool at_end = next_ns >= until_ns && bus->now_ns >= until_ns;
        stay_idle(bus, next_ns < until_ns ? next_ns : until_ns);
        if (at_end) {
            return;
        }
    }
}
