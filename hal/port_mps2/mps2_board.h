/* The MPS2 board's own parts behind the HAL's interfaces: clock, watchdog,
 * parameter memory. */
#ifndef HAL_PORT_MPS2_MPS2_BOARD_H
#define HAL_PORT_MPS2_MPS2_BOARD_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/emergency_stop.h"
#include "hal/storage/nv_store.h"
#include "hal/watchdog.h"

enum { MPS2_WATCHDOG_MS = 60, MPS2_NV_WORDS = 512, MPS2_NV_BASE = 0x21000000 };

/* Timer 0: one interrupt a millisecond. */
struct mps2_clock {
    volatile uint32_t milliseconds;
};

/* Starts timer 0. Start-up only. */
void mps2_clock_init(struct mps2_clock *clock);

/* Its interrupt. */
void mps2_clock_interrupt(struct mps2_clock *clock);

/* Starts the watchdog: its first time-out is an NMI, the second a reset. */
void mps2_watchdog_start(void);

/* True when the NMI is the watchdog's; the reset follows if nothing feeds it. */
bool mps2_watchdog_barked(void);

extern const struct watchdog mps2_watchdog;

/* User button 0. */
extern const struct emergency_stop mps2_button_stop;

/* Two banks in the board's large RAM, which the emulator fills from a file
 * (-device loader) and a reset of the processor leaves alone. */
extern const struct nv_store mps2_nv_store;

#endif
