#include "tests/support/fake_bus.h"

#include <string.h>

static enum can_result send(void *context, const struct can_msg *message)
{
    struct fake_bus *bus = (struct fake_bus *)context;
    if (bus->verdict != CAN_OK) {
        return bus->verdict;
    }
    if (bus->sent_count == FAKE_BUS_FRAMES) {
        return CAN_FULL;
    }
    bus->sent[bus->sent_count++] = *message;
    return CAN_OK;
}

static enum can_result receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct fake_bus *bus = (struct fake_bus *)context;
    if (bus->taken == bus->waiting_count) {
        bus->taken = bus->waiting_count = 0;
        return CAN_EMPTY;
    }
    *message = bus->waiting[bus->taken++];
    if (time_ns != NULL) {
        *time_ns = 0;
    }
    return CAN_OK;
}

static void get_status(void *context, struct can_bus_status *status)
{
    *status = ((const struct fake_bus *)context)->status;
}

static void recover(void *context)
{
    ((struct fake_bus *)context)->recoveries++;
}

static const struct can_bus_ops ops = {send, receive, get_status, recover};

void fake_bus_init(struct fake_bus *bus)
{
    memset(bus, 0, sizeof *bus);
}

struct can_bus fake_bus_interface(struct fake_bus *bus)
{
    return (struct can_bus){&ops, bus};
}

void fake_bus_put(struct fake_bus *bus, const struct can_msg *message)
{
    if (bus->waiting_count < FAKE_BUS_FRAMES) {
        bus->waiting[bus->waiting_count++] = *message;
    }
}

const struct can_msg *fake_bus_last(const struct fake_bus *bus, uint32_t id)
{
    for (unsigned i = bus->sent_count; i > 0; i--) {
        if (bus->sent[i - 1].id == id) {
            return &bus->sent[i - 1];
        }
    }
    return NULL;
}

unsigned fake_bus_count(const struct fake_bus *bus, uint32_t id)
{
    unsigned count = 0;
    for (unsigned i = 0; i < bus->sent_count; i++) {
        count += bus->sent[i].id == id;
    }
    return count;
}

void fake_bus_clear(struct fake_bus *bus)
{
    bus->sent_count = 0;
}
