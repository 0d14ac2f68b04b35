/* Fault confinement: error counters, error passive, bus-off and recovery.
 * Rules of ISO 11898-1 clause 12.1.4 (the same as in the Bosch CAN 2.0
 * specification, part B, chapter 8, which is public). Error messages have the
 * layout of linux/can/error.h, so that both ports tell the same story. */
#include <string.h>

#include "sim_host/bus/sim_bus_internal.h"

enum {
    CLASS_CONTROLLER = 0x004,
    CLASS_PROTOCOL = 0x008,
    CLASS_ACKNOWLEDGE = 0x020,
    CLASS_BUS_OFF = 0x040,
    CLASS_BUS_ERROR = 0x080,
    CLASS_RESTARTED = 0x100,
    WARNING_LIMIT = 96,
    PASSIVE_LIMIT = 128,
    BUS_OFF_LIMIT = 256,
    REC_AFTER_PASSIVE = 120 /* between 119 and 127 */
};

static enum can_error_state state_of(int tec, int rec)
{
    const int worst = tec > rec ? tec : rec;
    if (tec >= BUS_OFF_LIMIT) {
        return CAN_BUS_OFF;
    }
    if (worst >= PASSIVE_LIMIT) {
        return CAN_ERROR_PASSIVE;
    }
    return worst >= WARNING_LIMIT ? CAN_ERROR_WARNING : CAN_ERROR_ACTIVE;
}

static uint32_t tell(struct sim_bus *bus, struct sim_bus_port *port, uint32_t classes)
{
    struct can_msg message = {.id = classes, .length = 8, .flags = CAN_FRAME_ERROR};
    message.data[6] = (uint8_t)(port->tec > 255 ? 255 : port->tec);
    message.data[7] = (uint8_t)(port->rec > 255 ? 255 : port->rec);
    if ((classes & CLASS_CONTROLLER) != 0) {
        const bool passive = port->status.error_state == CAN_ERROR_PASSIVE;
        const bool warning = port->status.error_state == CAN_ERROR_WARNING;
        const bool by_tx = port->tec >= port->rec;
        if (passive) {
            message.data[1] = by_tx ? 0x20 : 0x10;
        } else if (warning) {
            message.data[1] = by_tx ? 0x08 : 0x04;
        } else {
            message.data[1] = 0x40;
        }
    }
    sim_bus_deliver(port, &message, bus->now_ns);
    return UINT32_C(1) << port->index;
}

/* Recomputes the state; returns the class bits a change is reported with. */
static uint32_t update_state(struct sim_bus_port *port)
{
    const enum can_error_state before = port->status.error_state;
    const enum can_error_state after = state_of(port->tec, port->rec);
    port->status.error_state = after;
    if (before == after) {
        return 0;
    }
    return after == CAN_BUS_OFF ? CLASS_BUS_OFF : CLASS_CONTROLLER;
}

uint32_t sim_bus_transmit_failed(struct sim_bus *bus, struct sim_bus_port *port,
                                 bool no_acknowledge)
{
    /* Exception A: an error-passive transmitter that only misses the acknowledge
     * does not count up, so a lone node never goes bus-off. */
    const bool counts = !(no_acknowledge && port->tec >= PASSIVE_LIMIT);
    if (counts) {
        port->tec += 8;
    }
    port->status.error_frames++;
    const uint32_t change = update_state(port);
    if (port->status.error_state == CAN_BUS_OFF) {
        port->status.bus_off_count++;
        port->tx_count = 0; /* what waited is lost with the controller */
        port->babbling = false;
        bus->pending &= ~(UINT32_C(1) << port->index);
        sim_bus_report(bus, SIM_BUS_NODE_BUS_OFF, port, NULL);
    }
    return tell(bus, port,
                change | CLASS_BUS_ERROR |
                    (uint32_t)(no_acknowledge ? CLASS_ACKNOWLEDGE : CLASS_PROTOCOL));
}

uint32_t sim_bus_receive_failed(struct sim_bus *bus, struct sim_bus_port *port)
{
    if (port->rec < PASSIVE_LIMIT) {
        port->rec++;
    }
    port->status.error_frames++;
    return tell(bus, port, update_state(port) | CLASS_BUS_ERROR | CLASS_PROTOCOL);
}

void sim_bus_transmit_succeeded(struct sim_bus_port *port)
{
    port->status.tx_frames++;
    if (port->tec > 0) {
        port->tec--;
        (void)update_state(port);
    }
}

void sim_bus_receive_succeeded(struct sim_bus_port *port)
{
    port->status.rx_frames++;
    if (port->rec > 0) {
        port->rec = port->rec >= PASSIVE_LIMIT ? REC_AFTER_PASSIVE : port->rec - 1;
        (void)update_state(port);
    }
}

uint32_t sim_bus_recovered(struct sim_bus *bus, struct sim_bus_port *port)
{
    port->tec = 0;
    port->rec = 0;
    port->recovering = false;
    port->status.error_state = CAN_ERROR_ACTIVE;
    port->may_start_ns = bus->now_ns;
    bus->recovering &= ~(UINT32_C(1) << port->index);
    sim_bus_report(bus, SIM_BUS_NODE_RECOVERED, port, NULL);
    return tell(bus, port, CLASS_RESTARTED);
}

void sim_bus_count_recessive(struct sim_bus *bus, uint32_t sequences, uint32_t *wake)
{
    for (unsigned i = 0; i < bus->port_count; i++) {
        struct sim_bus_port *port = &bus->ports[i];
        if (!port->recovering) {
            continue;
        }
        port->recovery_left -= sequences < port->recovery_left ? sequences : port->recovery_left;
        if (port->recovery_left == 0) {
            *wake |= sim_bus_recovered(bus, port);
        }
    }
}
