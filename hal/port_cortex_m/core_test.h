/* Tests of the core and of RAM while the program runs, in the sense of IEC 60730-1, annex H, class B:
 * registers for bits that are stuck, RAM by a march in slices.
 *
 * Each is short and leaves everything as it was. The caller keeps interrupts out (mmio_lock). The two
 * stack pointers and PRIMASK are not tested: a wrong one is a fault at the next call or interrupt.
 */
#ifndef HAL_PORT_CORTEX_M_CORE_TEST_H
#define HAL_PORT_CORTEX_M_CORE_TEST_H

#include <stdint.h>

enum { CORE_TEST_RAM_WORDS = 4 };

/* R0 to R12, LR, the flags and BASEPRI hold 0x55555555 and 0xAAAAAAAA. 0, or 1 when one does not.
 * 100 instructions. */
uint32_t core_test_registers(void);

/* Likewise S0 to S15, and S16 to S31. 140 and 150 instructions. */
uint32_t core_test_low_floats(void);
uint32_t core_test_high_floats(void);

/* March C- over CORE_TEST_RAM_WORDS words from `at`, with two patterns (hal/ram_march.h); their
 * content is kept in registers meanwhile and put back. It uses no memory while it tests, so that its
 * own stack may be among them. 0, or 1 when a word failed. 190 instructions. */
uint32_t core_test_ram(uint32_t *at);

#endif
