#include "firmware/bus_recovery.h"

void bus_recovery_update(struct bus_recovery *recovery, enum can_result sync,
                         const struct can_bus *bus)
{
    if (sync != CAN_DOWN) {
        recovery->wait = 0;
        return;
    }
    if (recovery->wait > 0u) {
        recovery->wait--;
        return;
    }
    recovery->wait = BUS_RECOVERY_TICKS;
    if (recovery->asked < UINT32_MAX) {
        recovery->asked++;
    }
    can_bus_recover(bus);
}
