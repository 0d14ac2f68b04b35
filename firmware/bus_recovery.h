/* Back from bus-off: the controller chip stays off the bus until somebody asks it to recover (ISO 11898-1,
 * 128 times 11 recessive bits), and may need to be asked again.
 */
#ifndef FIRMWARE_BUS_RECOVERY_H
#define FIRMWARE_BUS_RECOVERY_H

#include <stdint.h>

#include "hal/bus/can_bus.h"
#include "model/tick.h"

enum {
    BUS_RECOVERY_TICKS = TICKS_OF_MS(10) /* between attempts */
};

/* Zeroed: nothing asked for yet. */
struct bus_recovery {
    uint16_t wait;
    uint32_t asked; /* saturates */
};

/* Once a tick, with what the bus said to the SYNC: asks *bus for recovery now and then while it is
 * CAN_DOWN. Loop only; O(1). */
void bus_recovery_update(struct bus_recovery *recovery, enum can_result sync,
                         const struct can_bus *bus);

#endif
