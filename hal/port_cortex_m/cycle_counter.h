/* The core's counter of its own cycles (Armv7-M Architecture Reference Manual, DWT_CYCCNT). It wraps;
 * whether it goes on in sleep is the chip's choice. */
#ifndef HAL_PORT_CORTEX_M_CYCLE_COUNTER_H
#define HAL_PORT_CORTEX_M_CYCLE_COUNTER_H

#include <stdint.h>

#include "hal/port_cortex_m/mmio.h"

#define SCB_DEMCR 0xE000EDFCu
#define DEMCR_TRCENA (1u << 24)
#define DWT_CTRL 0xE0001000u
#define DWT_CTRL_CYCCNTENA (1u << 0)
#define DWT_CYCCNT 0xE0001004u

/* Switches it on. Start-up only. */
static inline void cycle_counter_start(void)
{
    mmio_set(SCB_DEMCR, DEMCR_TRCENA);
    mmio_write(DWT_CYCCNT, 0);
    mmio_set(DWT_CTRL, DWT_CTRL_CYCCNTENA);
}

/* Cycles since the start, modulo 2^32. Any context; O(1). */
static inline uint32_t cycle_counter(void)
{
    return mmio_read(DWT_CYCCNT);
}

#endif
