/* Signs of life of the NUCLEO-G474RE: LD2 on PA5, and the virtual COM port of its ST-Link, which is
 * LPUART1 on PA2 and PA3 at 115200 baud, 8N1. Only sent to, never listened to. */
#ifndef HAL_PORT_STM32G474_SIGNS_H
#define HAL_PORT_STM32G474_SIGNS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/port_stm32g474/clock_tree.h"

enum { SIGNS_BAUD = 115200, SIGNS_POLLS = 20000 };

/* Switches pin and port on; `clock_hz` is what the core runs at. A port whose pin does not hold its function
 * stays off, and takes what is sent without a word. Start-up only. */
void signs_init(uint32_t clock_hz);

/* LD2. O(1). */
void signs_light(bool lit);

/* Sends a text; waits for each character, 87 us, bounded by SIGNS_POLLS. Start-up only. */
void signs_write(const char *text);

/* Sends one character if the port takes it now; returns whether it did. Loop; O(1). */
bool signs_try_put(char character);

/* The same, eight hexadecimal digits. */
void signs_write_hex(uint32_t number);

/* Whether LD2 is lit at `now_ms` when it tells a number: so many flashes of 100 ms, then dark
 * until two seconds are over; at most 7. Pure. */
static inline bool signs_flash(uint32_t now_ms, uint32_t flashes)
{
    const uint32_t phase_ms = now_ms % 2000u;

    return phase_ms / 250u < flashes && phase_ms % 250u < 100u;
}

/* A line that goes out character by character while other things go on. */
struct signs_line {
    char text[24];
    uint32_t at, length;
};

/* Begins "NAME NUMBER" with up to 10 characters of a name and a number up to 9999; what was going
 * out ends there. O(1). */
void signs_line_begin(struct signs_line *line, const char *name, uint32_t number);

/* Sends the next character if there is one and the port takes it. O(1). */
void signs_line_go_on(struct signs_line *line);

/* Waits, within some 10 %. Start-up only. */
void signs_wait(uint32_t clock_hz, uint32_t time_ms);

#endif
