/* Sleep of the board's loop, without sleeping over what has already come. */
#ifndef HAL_PORT_STM32G474_IDLE_H
#define HAL_PORT_STM32G474_IDLE_H

#include "hal/port_fdcan/fdcan.h"
#include "hal/port_stm32g474/board_io.h"

/* Sleeps until a received frame that is due or a period of the clock waits for the loop; other
 * interrupts are handled meanwhile. An interrupt between the look and the sleep
 * ends the sleep. Returns the cycles that the counter went on by in sleep (cycle_counter.h).
 * Loop only; returns after TICK_PERIOD_US at the latest. */
uint32_t idle_until_interrupt(const struct fdcan *can, const struct tim2_clock *clock);

#endif
