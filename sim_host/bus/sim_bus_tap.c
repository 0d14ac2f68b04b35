/* What a listener to the whole bus is told. */
#include <stddef.h>

#include "sim_host/bus/sim_bus_internal.h"

void sim_bus_set_tap(struct sim_bus *bus, sim_bus_tap tap, void *context)
{
    bus->tap = tap;
    bus->tap_context = context;
}

void sim_bus_report(struct sim_bus *bus, enum sim_bus_event_kind kind,
                    const struct sim_bus_port *port, const struct can_msg *message)
{
    if (bus->tap == NULL) {
        return;
    }
    struct sim_bus_event event = {
        .kind = kind, .time_ns = bus->now_ns, .port = port->index, .fault = bus->fault.kind};
    if (message != NULL) {
        event.message = *message;
    }
    bus->tap(bus->tap_context, &event);
}
