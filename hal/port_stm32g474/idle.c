#include "hal/port_stm32g474/idle.h"

#include "hal/port_cortex_m/mmio.h"

void idle_until_interrupt(const struct fdcan *can, const struct tim2_clock *clock)
{
    /* Locked, an interrupt becomes pending, which is what ends the sleep (Armv7-M
     * Architecture Reference Manual, B1.5.17 "wait for interrupt"); its handler runs at
     * the unlock. */
    const uint32_t state = mmio_lock();

    if (!fdcan_has_received(can) && clock->waiting == 0U) {
        mmio_sleep();
    }
    mmio_unlock(state);
}
