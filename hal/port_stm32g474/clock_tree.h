/* The STM32G474's clocks: 24 MHz crystal, 170 MHz core, FDCAN straight from the
 * crystal, with time-outs and a defined way out when the crystal fails. */
#ifndef HAL_PORT_STM32G474_CLOCK_TREE_H
#define HAL_PORT_STM32G474_CLOCK_TREE_H

#include <stdbool.h>
#include <stdint.h>

enum {
    CRYSTAL_HZ = 24000000,
    CORE_HZ = 170000000, /* 24 MHz / 6 * 85 / 2 */
    FALLBACK_HZ = 16000000,
    /* At 16 MHz and some 8 cycles a poll: 100 ms for the crystal (it takes 2 ms,
     * DS12288), more than enough for the PLL and the regulator. */
    CLOCK_TREE_POLLS = 200000
};

enum clock_tree_result {
    CLOCK_TREE_OK = 0,          /* 170 MHz from the crystal, clock security on */
    CLOCK_TREE_NO_CRYSTAL = -1, /* runs on the 16 MHz RC oscillator (1 % off: no CAN) */
    CLOCK_TREE_NO_PLL = -2,     /* likewise; the crystal runs, the PLL does not lock */
    CLOCK_TREE_NO_BOOST = -3,   /* likewise; the regulator does not go into its boost mode */
    /* 170 MHz from the crystal, but nobody would notice its end, or FDCAN has another clock. */
    CLOCK_TREE_LOST_WRITE = -4
};

/* Sets the clocks up after reset. On any failure but CLOCK_TREE_LOST_WRITE the core stays on
 * the RC oscillator at FALLBACK_HZ. On any failure the caller must go to the safe state, never onto the
 * bus. Start-up only, interrupts off; below 0.2 s. */
enum clock_tree_result clock_tree_init(void);

/* What the core runs at now: CORE_HZ or FALLBACK_HZ. O(1). */
uint32_t clock_tree_hz(void);

/* How often an empty loop over a volatile counter must turn for `time_ms` (up to 10,000) at
 * `clock_hz`: 7.6 cycles a turn (load, add, store, load, compare, branch). Within some 10 %. */
static inline uint32_t clock_tree_wait_polls(uint32_t clock_hz, uint32_t time_ms)
{
    return clock_hz / 1000u * 10u / 76u * time_ms;
}

/* True while the core's regulator is in its boost mode. O(1). */
bool clock_tree_is_boosted(void);

/* From the NMI handler: true when the crystal has stopped (clock security
 * system). The core then runs on the RC oscillator, FDCAN has no clock any more
 * and the drives unload by their own time-out. O(1). */
bool clock_tree_crystal_failed(void);

/* Why the processor was reset: bits 25..31 of RCC_CSR (option bytes, pin,
 * brown-out, software, independent watchdog, window watchdog, low power), then
 * cleared for the next time. Start-up only. */
uint32_t clock_tree_take_reset_flags(void);

#endif
