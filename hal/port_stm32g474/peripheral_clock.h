/* Switches clocks of peripherals on, so that the next access to one of them counts. */
#ifndef HAL_PORT_STM32G474_PERIPHERAL_CLOCK_H
#define HAL_PORT_STM32G474_PERIPHERAL_CLOCK_H

#include <stdint.h>

#include "hal/port_cortex_m/mmio.h"

/* Sets `clocks` in the enable register. RM0440, "Peripheral clock enable register": the
 * clock takes two cycles to arrive, and a write before that is lost. Reading the register
 * back takes longer. Start-up only. */
static inline void peripheral_clock_enable(uint32_t enable_register, uint32_t clocks)
{
    mmio_set(enable_register, clocks);
    (void)mmio_read(enable_register);
}

#endif
