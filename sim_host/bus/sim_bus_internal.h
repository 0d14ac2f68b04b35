/* What the files of the in-process bus share; not for its users. */
#ifndef SIM_HOST_BUS_SIM_BUS_INTERNAL_H
#define SIM_HOST_BUS_SIM_BUS_INTERNAL_H

#include "sim_host/bus/sim_bus.h"

enum {
    SIM_BUS_SYNC_ID = 0x080,
    SIM_BUS_ERROR_FLAG_BITS = 12, /* flag of 6, and the echo flags of the others */
    SIM_BUS_ERROR_DELIMITER_BITS = 8,
    SIM_BUS_SUSPEND_BITS = 8,
    SIM_BUS_RECOVERY_SEQUENCES = 128,
    SIM_BUS_RECESSIVE_BITS = 11
};

/* Arbitration field as a number, smaller wins: 11 id bits, RTR or SRR, IDE, then
 * 18 id bits and RTR of an extended frame. */
uint32_t sim_bus_key(const struct can_msg *message);

/* Puts an entry into the queue behind all entries of its identifier, or before
 * them when it was on the wire already (`again`). False when there is no room. */
bool sim_bus_queue_insert(struct sim_bus_port *port, const struct sim_bus_tx_entry *entry,
                          bool again);

/* Appends to the receive queue; counts an overflow when it is full. */
void sim_bus_deliver(struct sim_bus_port *port, const struct can_msg *message, uint64_t time_ns);

/* True when the port takes part in the traffic. */
static inline bool sim_bus_is_on(const struct sim_bus_port *port)
{
    return port->connected && port->status.error_state != CAN_BUS_OFF;
}

/* Fault confinement (ISO 11898-1, 12.1.4). The first three return the ports that
 * received an error message and want to be woken. */
uint32_t sim_bus_transmit_failed(struct sim_bus *bus, struct sim_bus_port *port,
                                 bool no_acknowledge);
uint32_t sim_bus_receive_failed(struct sim_bus *bus, struct sim_bus_port *port);
uint32_t sim_bus_recovered(struct sim_bus *bus, struct sim_bus_port *port);
void sim_bus_transmit_succeeded(struct sim_bus_port *port);
void sim_bus_receive_succeeded(struct sim_bus_port *port);
void sim_bus_count_recessive(struct sim_bus *bus, uint32_t sequences, uint32_t *wake);

/* Tells the tap, if there is one. message may be NULL. */
void sim_bus_report(struct sim_bus *bus, enum sim_bus_event_kind kind,
                    const struct sim_bus_port *port, const struct can_msg *message);

#endif
