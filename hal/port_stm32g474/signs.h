/* Signs of life of the NUCLEO-G474RE: LD2 on PA5, and the virtual COM port of its ST-Link, which is
 * LPUART1 on PA2 and PA3 at 115200 baud, 8N1. Only sent to, never listened to. */
#ifndef HAL_PORT_STM32G474_SIGNS_H
#define HAL_PORT_STM32G474_SIGNS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/port_stm32g474/clock_tree.h"

enum { SIGNS_BAUD = 115200, SIGNS_POLLS = 20000 };

/* Switches pin and port on; `clock_hz` is what the core runs at. Start-up only. */
void signs_init(uint32_t clock_hz);

/* LD2. O(1). */
void signs_light(bool lit);

/* Sends a text; waits for each character, 87 us, bounded by SIGNS_POLLS. Start-up only. */
void signs_write(const char *text);

/* Sends one character if the port takes it now; returns whether it did. Loop; O(1). */
bool signs_try_put(char character);

/* Waits, within some 10 %. Start-up only. */
void signs_wait(uint32_t clock_hz, uint32_t time_ms);

#endif
