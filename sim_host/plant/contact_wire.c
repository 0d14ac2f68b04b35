#include "sim_host/plant/contact_wire.h"

void contact_wire_init(struct contact_wire *wire)
{
    *wire = (struct contact_wire){.down = true};
}

void contact_wire_update(struct contact_wire *wire, enum foot_contact foot, double now_s)
{
    const bool down = foot != FOOT_UP;
    if (down && !wire->down && foot == FOOT_DOWN &&
        now_s - wire->up_since_s >= CONTACT_OPEN_LEAST_S) {
        wire->edge = true;
        wire->edge_s = now_s;
    } else if (!down && wire->down) {
        wire->up_since_s = now_s;
    }
    wire->down = down;
}

bool contact_wire_has_edge(const struct contact_wire *wire, double now_s)
{
    return wire->edge && now_s - wire->edge_s <= CONTACT_EDGE_S;
}
