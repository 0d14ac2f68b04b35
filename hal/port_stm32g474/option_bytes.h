/* The option bytes that this device wants: brown-out reset below 2.5 V, and RAM with parity.
 *
 * The starter sets them once, at the first start after the flash was written by cable. They are
 * never touched again, and never with read protection on: that is what a chip shows whose option
 * bytes a power failure tore, and setting them would then cost the whole flash (RM0440, "Read
 * protection"). A program that runs on other option bytes says so (0x2033, afo ctl board).
 */
#ifndef HAL_PORT_STM32G474_OPTION_BYTES_H
#define HAL_PORT_STM32G474_OPTION_BYTES_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/port_stm32g474/flash_registers.h"

/* What `option_bytes` (FLASH_OPTR) should be. Pure. */
static inline uint32_t option_bytes_wanted(uint32_t option_bytes)
{
    return (option_bytes & ~(FLASH_OPTR_BOR_MASK | FLASH_OPTR_SRAM_PE)) | FLASH_OPTR_BOR_2V5;
}

/* True when they are as wanted. O(1). */
bool option_bytes_are_set(void);

/* Writes what is wanted and lets the chip load it, which resets it: does not return on the chip. It
 * returns false, with nothing changed, when the flash is protected, busy or keeps locked.
 * `tried` says that the last reset was such a load (RCC_CSR_OBLRSTF): then it does not try again.
 * Start-up only; some 25 ms. */
bool option_bytes_set(bool tried);

#endif
