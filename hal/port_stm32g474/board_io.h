/* Timer, watchdog, pins of the STM32G474 behind the HAL's interfaces.
 *
 * Pins: PA1 sync pulse, PA11 and PA12 FDCAN1 receive and transmit, PC0 emergency stop, PC1 drive power enable, PC2
 * the wearer's button, PC3 the cue, PC5 the line that takes the drives' torque. PB8 is left alone: it is BOOT0 while
 * the option bits are as delivered.
 */
#ifndef HAL_PORT_STM32G474_BOARD_IO_H
#define HAL_PORT_STM32G474_BOARD_IO_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/clock.h"
#include "hal/drive_power_enable.h"
#include "hal/emergency_stop.h"
#include "hal/sync_pulse.h"
#include "hal/watchdog.h"
#include "hal/wearer_panel.h"

/* TIM2 counts microseconds; its compare unit marks each period. */
struct tim2_clock {
    volatile uint32_t high;    /* overflows of the 32-bit counter */
    volatile uint32_t waiting; /* periods that ended and nobody took */
    volatile uint32_t missed;
};

/* Starts the timer: 1 us a count, interrupt every TICK_PERIOD_US.
 * `timer_clock_hz` is a multiple of 1 MHz. Returns 0, or the address of a register that does
 * not hold what was written. Start-up only. */
uint32_t tim2_clock_init(struct tim2_clock *clock, uint32_t timer_clock_hz);

/* Its interrupt: counts, nothing else. Lower priority than FDCAN1. When it comes so late
 * that further periods have ended by then, those are counted missed and not made up for.
 * Below 150 instructions. */
void tim2_clock_interrupt(struct tim2_clock *clock);

struct clock tim2_clock_interface(struct tim2_clock *clock);

/* Time of the clock, ns. Loop or ISR, also with the timer's interrupt pending. */
uint64_t tim2_clock_now_ns(void *clock);

/* The same in us; wraps after 71 minutes. O(1). */
uint32_t tim2_clock_now_us(const struct tim2_clock *clock);

/* The same in whole ms; wraps after 49 days. */
uint32_t tim2_clock_now_ms(const struct tim2_clock *clock);

enum {
    WATCHDOG_TIMEOUT_MS = 120, /* erasing two pages takes 49 ms; the drives wait 250 ms */
    WATCHDOG_OPENS_MS = 10,    /* fed earlier than that after the last time it bites, too */
    WATCHDOG_FEED_MS = 20,
    WATCHDOG_POLLS = 2000000
};

/* When the watchdog was fed last, by TIM2. */
struct iwdg {
    uint32_t fed_us;
};

/* Starts the independent watchdog; nothing but a reset stops it. It runs from the
 * 32 kHz RC oscillator, some 10 % off. Returns 0, or the address of a register that does not
 * hold what was written: its time-out is another then. Start-up only; below 1 ms. */
uint32_t iwdg_start(void);

/* The independent watchdog for a loop that feeds it in every period: it passes one feed in
 * WATCHDOG_FEED_MS on. Code that feeds the watchdog past it, or a timer that runs twice as fast, falls out of
 * the window. Only once TIM2 counts. */
struct watchdog iwdg_interface(struct iwdg *iwdg);

/* Feeds it now. Start-up only, not within WATCHDOG_OPENS_MS of the last time. */
void iwdg_feed(void);

/* Switches the pins and FDCAN1's clock on. Returns 0, or the address of a register that does
 * not hold what was written. Start-up only. */
uint32_t board_io_init(void);

/* PC1, push-pull: toggles once a tick that feeds the watchdog, while the drives may have power. PC5, push-pull, pulled
 * down outside: high to take their torque at once. In reset, and until board_io_init(), both are analog. */
extern const struct drive_power_enable pc1_pc5_drive_power_enable;

/* Whether PC1 or PC5 is high now, at the pin. O(1). */
bool board_io_permit_is_high(void);
bool board_io_cut_is_high(void);

/* Whether PC0 is low: the contact is open. O(1). */
bool board_io_stop_is_pressed(void);

/* PC0, pulled down: high only while the closed contact feeds it. */
extern const struct emergency_stop pc0_emergency_stop;

/* PA1: TIM2's second channel, which ends the pulse by itself. Only once TIM2 counts. */
extern const struct sync_pulse pa1_sync_pulse;

/* PC2, pulled up: low while the button is pressed. PC3, push-pull: high while light or buzzer is on. */
extern const struct wearer_panel pc2_pc3_wearer_panel;

#endif
