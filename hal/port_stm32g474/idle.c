#include "hal/port_stm32g474/idle.h"

#include "hal/port_cortex_m/cycle_counter.h"

uint32_t idle_until_interrupt(const struct fdcan *can, const struct tim2_clock *clock)
{
    /* Locked, an interrupt becomes pending, which is what ends the sleep (Armv7-M
     * Architecture Reference Manual, B1.5.17 "wait for interrupt"); its handler runs at
     * the unlock. */
    const uint32_t state = mmio_lock();
    uint32_t slept = 0;

    while (!fdcan_is_due(can) && clock->waiting == 0U) {
        const uint32_t before = cycle_counter();
        mmio_sleep();
        slept += cycle_counter() - before;
        mmio_unlock(state); /* most frames can wait: the loop is not woken for each */
        (void)mmio_lock();
    }
    mmio_unlock(state);
    return slept;
}
