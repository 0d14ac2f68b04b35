/* The contact input of a latch's node: the other foot's switch, wired to it.
 *
 * The node opens its latch on two signs that share no cause: the controller's arm window, and here a
 * contact edge of the other foot. An edge is a closing of the switch that has been open for
 * CONTACT_OPEN_LEAST_S, so a switch that chatters makes none. It counts for CONTACT_EDGE_S: the arm
 * window may open a little later than the foot lands.
 */
#ifndef SIM_HOST_PLANT_CONTACT_WIRE_H
#define SIM_HOST_PLANT_CONTACT_WIRE_H

#include <stdbool.h>

#include "model/foot_contact.h"

#define CONTACT_OPEN_LEAST_S 0.050
#define CONTACT_EDGE_S 0.030

struct contact_wire {
    bool down;
    bool edge; /* one has come */
    double up_since_s;
    double edge_s;
};

/* The switch is closed, and no edge has come. */
void contact_wire_init(struct contact_wire *wire);

/* The switch's signal at now_s; FOOT_UNKNOWN counts as closed: no edge follows from it. */
void contact_wire_update(struct contact_wire *wire, enum foot_contact foot, double now_s);

/* An edge has come within the last CONTACT_EDGE_S. */
bool contact_wire_has_edge(const struct contact_wire *wire, double now_s);

#endif
