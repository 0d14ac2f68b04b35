/* The bus as one node sees it: queues and the functions behind struct can_bus. */
#include <assert.h>
#include <string.h>

#include "sim_host/bus/sim_bus_internal.h"

uint32_t sim_bus_key(const struct can_msg *message)
{
    const uint32_t remote = (message->flags & CAN_FRAME_REMOTE) != 0 ? 1 : 0;
    if ((message->flags & CAN_FRAME_EXTENDED) != 0) {
        const uint32_t base = (message->id >> 18) & 0x7FFU;
        const uint32_t rest = message->id & 0x3FFFFU;
        return base << 21 | UINT32_C(1) << 20 | UINT32_C(1) << 19 | rest << 1 | remote;
    }
    return (message->id & 0x7FFU) << 21 | remote << 20;
}

bool sim_bus_queue_insert(struct sim_bus_port *port, const struct sim_bus_tx_entry *entry,
                          bool again)
{
    const unsigned room = again ? SIM_BUS_TX_QUEUE + 1 : SIM_BUS_TX_QUEUE;
    if (port->tx_count >= room) {
        return false;
    }
    unsigned at = port->tx_count;
    while (at > 0 &&
           (again ? port->tx[at - 1].key < entry->key : port->tx[at - 1].key <= entry->key)) {
        port->tx[at] = port->tx[at - 1];
        at--;
    }
    port->tx[at] = *entry;
    port->tx_count++;
    port->bus->pending |= UINT32_C(1) << port->index;
    return true;
}

void sim_bus_deliver(struct sim_bus_port *port, const struct can_msg *message, uint64_t time_ns)
{
    if (port->rx_count == SIM_BUS_RX_QUEUE) {
        port->status.rx_overflow++;
        return;
    }
    struct sim_bus_rx_entry *entry = &port->rx[(port->rx_head + port->rx_count) % SIM_BUS_RX_QUEUE];
    entry->time_ns = time_ns;
    entry->message = *message;
    port->rx_count++;
}

static bool is_valid(const struct can_msg *message)
{
    const uint32_t id_max = (message->flags & CAN_FRAME_EXTENDED) != 0
                                ? (uint32_t)CAN_ID_EXTENDED_MAX
                                : (uint32_t)CAN_ID_STANDARD_MAX;
    return message->length <= CAN_FRAME_DATA_MAX && message->id <= id_max &&
           (message->flags & CAN_FRAME_ERROR) == 0;
}

static enum can_result port_send(void *context, const struct can_msg *message)
{
    struct sim_bus_port *port = context;
    if (!is_valid(message)) {
        return CAN_INVALID;
    }
    if (port->status.error_state == CAN_BUS_OFF) {
        return CAN_DOWN;
    }
    struct sim_bus_tx_entry entry = {
        .key = sim_bus_key(message), .queued_ns = port->bus->now_ns, .message = *message};
    entry.message.flags &= (uint8_t) ~(unsigned)CAN_FRAME_OWN;
    const unsigned carried = (message->flags & CAN_FRAME_REMOTE) != 0 ? 0 : message->length;
    for (unsigned i = carried; i < CAN_FRAME_DATA_MAX; i++) {
        entry.message.data[i] = 0;
    }
    while (port->tx_count >= SIM_BUS_TX_QUEUE && port->tx[0].key > entry.key) {
        port->status.tx_refused++; /* the least urgent is lost */
        port->tx_count--;
        memmove(&port->tx[0], &port->tx[1], port->tx_count * sizeof port->tx[0]);
    }
    if (!sim_bus_queue_insert(port, &entry, false)) {
        port->status.tx_refused++;
        return CAN_FULL;
    }
    return CAN_OK;
}

static enum can_result port_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct sim_bus_port *port = context;
    if (port->rx_count == 0) {
        return port->status.error_state == CAN_BUS_OFF ? CAN_DOWN : CAN_EMPTY;
    }
    const struct sim_bus_rx_entry *entry = &port->rx[port->rx_head];
    *message = entry->message;
    if (time_ns != NULL) {
        *time_ns = entry->time_ns;
    }
    port->rx_head = (port->rx_head + 1) % SIM_BUS_RX_QUEUE;
    port->rx_count--;
    return CAN_OK;
}

static void port_get_status(void *context, struct can_bus_status *status)
{
    const struct sim_bus_port *port = context;
    *status = port->status;
    status->tx_error_count = (uint8_t)(port->tec > 255 ? 255 : port->tec);
    status->rx_error_count = (uint8_t)(port->rec > 255 ? 255 : port->rec);
}

static void port_recover(void *context)
{
    struct sim_bus_port *port = context;
    if (port->status.error_state != CAN_BUS_OFF || port->recovering) {
        return;
    }
    if (port->bus->recovering == 0) {
        port->bus->idle_since_ns = port->bus->now_ns; /* silence counts from here */
    }
    port->recovering = true;
    port->recovery_left = SIM_BUS_RECOVERY_SEQUENCES;
    port->bus->recovering |= UINT32_C(1) << port->index;
}

static const struct can_bus_ops port_ops = {.send = port_send,
                                            .receive = port_receive,
                                            .get_status = port_get_status,
                                            .recover = port_recover};

struct can_bus sim_bus_port(struct sim_bus *bus, int port)
{
    assert(port >= 0 && (unsigned)port < bus->port_count);
    return (struct can_bus){.ops = &port_ops, .context = &bus->ports[port]};
}

int sim_bus_attach(struct sim_bus *bus, const char *name, sim_bus_wake wake, void *context)
{
    if (bus->port_count == SIM_BUS_PORTS_MAX) {
        return -1;
    }
    struct sim_bus_port *port = &bus->ports[bus->port_count];
    memset(port, 0, sizeof *port);
    port->bus = bus;
    port->name = name;
    port->wake = wake;
    port->context = context;
    port->connected = true;
    port->index = (uint8_t)bus->port_count;
    return (int)bus->port_count++;
}

void sim_bus_connect(struct sim_bus *bus, int port, bool connected)
{
    assert(port >= 0 && (unsigned)port < bus->port_count);
    bus->ports[port].connected = connected;
}

unsigned sim_bus_withdraw(struct sim_bus *bus, int index, uint32_t id)
{
    assert(index >= 0 && (unsigned)index < bus->port_count);
    struct sim_bus_port *port = &bus->ports[index];
    unsigned kept = 0;
    for (unsigned i = 0; i < port->tx_count; i++) {
        if (port->tx[i].message.id != id) {
            port->tx[kept++] = port->tx[i];
        }
    }
    const unsigned withdrawn = port->tx_count - kept;
    port->tx_count = kept;
    return withdrawn;
}

void sim_bus_reset_port(struct sim_bus *bus, int index)
{
    assert(index >= 0 && (unsigned)index < bus->port_count);
    struct sim_bus_port *port = &bus->ports[index];
    const uint32_t bit = UINT32_C(1) << index;
    port->tx_count = 0;
    port->rx_count = 0;
    port->tec = 0;
    port->rec = 0;
    port->recovering = false;
    port->babbling = false;
    port->may_start_ns = 0;
    memset(&port->status, 0, sizeof port->status);
    bus->pending &= ~bit;
    bus->recovering &= ~bit;
    /* A frame it has on the wire breaks off: nobody is left to finish it. */
    if (bus->phase == SIM_BUS_TRANSMIT && (bus->contenders & bit) != 0) {
        bus->contenders &= ~bit;
        if (bus->contenders == 0) {
            bus->outcome = SIM_BUS_ENDS_DESTROYED;
        }
    }
}

void sim_bus_babble(struct sim_bus *bus, int index, const struct can_msg *message,
                    uint64_t until_ns)
{
    assert(index >= 0 && (unsigned)index < bus->port_count);
    struct sim_bus_port *port = &bus->ports[index];
    port->babbling = until_ns > bus->now_ns && is_valid(message);
    port->babble_until_ns = until_ns;
    if (port->babbling) {
        port->babble = *message;
        bus->pending |= UINT32_C(1) << index;
    }
}
