/* The hardware between the controller's two power lines and the drives' safe torque off, as firmware/README.md wires
 * it: the pump and its channel of safety relay K2, and relay K3.
 *
 * K2 needs somebody to start it again once it has fallen. Here somebody does so at once: what a drive does when its
 * power comes back is judged, too. The emergency stop's own channel of K2 is left out, so that the controller has to
 * unload without its help.
 */
#ifndef SIM_HOST_NODES_POWER_RELAY_H
#define SIM_HOST_NODES_POWER_RELAY_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/drive_power_enable.h"

enum {
    /* From the last edge on until the pump no longer holds its channel: an estimate, some twenty of its periods. */
    POWER_RELAY_PUMP_MS = 20,
    POWER_RELAY_K2_MS = 400, /* its off-delay */
    POWER_RELAY_K3_MS = 10,  /* an estimate for a relay with forcibly guided contacts */
    /* From a drive's input to its power stage: maxon, EPOS4 50/5 Hardware Reference (May 2017), table 3-29. */
    POWER_RELAY_STO_MS = 25
};

struct power_relay {
    uint32_t still_ticks; /* since the last edge; saturates where the power is gone */
    uint32_t cut_ticks;   /* for which the cutting line has been high; saturates likewise */
    bool moved;           /* an edge in this tick */
    bool is_cut;
    struct drive_power_enable lines; /* what the controller holds; its context is this relay */
};

/* With power, as with everything in order before the controller's first tick. *relay must not move. */
void power_relay_init(struct power_relay *relay);

/* A reset of the controller: its pins let go, which the pull-down reads as low. */
void power_relay_let_go(struct power_relay *relay);

/* One tick on. Returns whether the drives may have torque in the coming one. */
bool power_relay_advance(struct power_relay *relay);

#endif
