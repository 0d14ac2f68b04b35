/* A CAN bus that keeps what was sent and hands out what the test put in. */
#ifndef TESTS_SUPPORT_FAKE_BUS_H
#define TESTS_SUPPORT_FAKE_BUS_H

#include "hal/bus/can_bus.h"

enum { FAKE_BUS_FRAMES = 256 };

struct fake_bus {
    struct can_msg sent[FAKE_BUS_FRAMES];
    unsigned sent_count;
    struct can_msg waiting[FAKE_BUS_FRAMES];
    unsigned waiting_count;
    unsigned taken;
    enum can_result verdict;      /* what send answers; frames are kept on CAN_OK only */
    struct can_bus_status status; /* what get_status answers */
    unsigned recoveries;          /* asked for */
};

void fake_bus_init(struct fake_bus *bus);
struct can_bus fake_bus_interface(struct fake_bus *bus);
void fake_bus_put(struct fake_bus *bus, const struct can_msg *message);

/* The last frame sent with this identifier, or NULL. */
const struct can_msg *fake_bus_last(const struct fake_bus *bus, uint32_t id);

/* How many frames with this identifier were sent since the last clear. */
unsigned fake_bus_count(const struct fake_bus *bus, uint32_t id);
void fake_bus_clear(struct fake_bus *bus);

#endif
