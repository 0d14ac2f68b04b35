/* The MPS2 board with the AN386 image (Cortex-M4F), as far as it is used here.
 *
 * Sources: Arm's application note AN386 (memory map), Arm's CMSDK reference
 * manual DDI 0479 (timer, UART, watchdog); second: QEMU's hw/arm/mps2.c,
 * hw/timer/cmsdk-apb-timer.c, hw/char/cmsdk-apb-uart.c and
 * hw/watchdog/cmsdk-apb-watchdog.c.
 */
#ifndef HAL_PORT_MPS2_MPS2_REGISTERS_H
#define HAL_PORT_MPS2_MPS2_REGISTERS_H

#include <stdint.h>

enum { MPS2_CLOCK_HZ = 25000000, MPS2_IRQ_COUNT = 32, MPS2_IRQ_TIMER0 = 8 };

#define MPS2_REGISTER(address) (*(volatile uint32_t *)(address))

/* Timers count down from their reload value and wrap to it. */
#define TIMER0_CTRL MPS2_REGISTER(0x40000000u)
#define TIMER0_VALUE MPS2_REGISTER(0x40000004u)
#define TIMER0_RELOAD MPS2_REGISTER(0x40000008u)
#define TIMER0_INTCLEAR MPS2_REGISTER(0x4000000Cu)
#define TIMER1_CTRL MPS2_REGISTER(0x40001000u)
#define TIMER1_VALUE MPS2_REGISTER(0x40001004u)
#define TIMER1_RELOAD MPS2_REGISTER(0x40001008u)
#define TIMER_CTRL_ENABLE 1u
#define TIMER_CTRL_INTERRUPT 8u

#define UART0_DATA MPS2_REGISTER(0x40004000u)
#define UART0_STATE MPS2_REGISTER(0x40004004u)
#define UART0_CTRL MPS2_REGISTER(0x40004008u)
#define UART0_BAUDDIV MPS2_REGISTER(0x40004010u)
#define UART_STATE_TX_FULL 1u
#define UART_STATE_RX_FULL 2u
#define UART_CTRL_TX_RX 3u

#define WATCHDOG_LOAD MPS2_REGISTER(0x40008000u)
#define WATCHDOG_VALUE MPS2_REGISTER(0x40008004u)
#define WATCHDOG_CONTROL MPS2_REGISTER(0x40008008u)
#define WATCHDOG_INTCLEAR MPS2_REGISTER(0x4000800Cu)
#define WATCHDOG_RAW_INTERRUPT MPS2_REGISTER(0x40008010u)
#define WATCHDOG_LOCK MPS2_REGISTER(0x40008C00u)
#define WATCHDOG_UNLOCK_KEY 0x1ACCE551u
#define WATCHDOG_INTERRUPT_AND_RESET 3u

#define FPGAIO_BUTTON MPS2_REGISTER(0x40028008u) /* a bit per user button, 1 = pressed */

#endif
