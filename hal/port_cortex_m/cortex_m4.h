/* What a Cortex-M4F needs from a board, and what it gives: start, faults, stacks.
 *
 * Register facts: Armv7-M Architecture Reference Manual (DDI 0403, system control
 * block, NVIC, MPU) and, as second source, Arm's CMSIS core_cm4.h.
 */
#ifndef HAL_PORT_CORTEX_M_CORTEX_M4_H
#define HAL_PORT_CORTEX_M_CORTEX_M4_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/storage/crash_record.h"

#define SCB_ICSR (*(volatile uint32_t *)0xE000ED04u)
#define SCB_VTOR (*(volatile uint32_t *)0xE000ED08u)
#define SCB_AIRCR (*(volatile uint32_t *)0xE000ED0Cu)
#define SCB_CCR (*(volatile uint32_t *)0xE000ED14u)
#define SCB_SHCSR (*(volatile uint32_t *)0xE000ED24u)
#define SCB_CFSR (*(volatile uint32_t *)0xE000ED28u)
#define SCB_HFSR (*(volatile uint32_t *)0xE000ED2Cu)
#define SCB_MMFAR (*(volatile uint32_t *)0xE000ED34u)
#define SCB_BFAR (*(volatile uint32_t *)0xE000ED38u)
#define SCB_CPACR (*(volatile uint32_t *)0xE000ED88u)
#define NVIC_ISER ((volatile uint32_t *)0xE000E100u)
#define NVIC_IPR ((volatile uint8_t *)0xE000E400u)
#define MPU_CTRL (*(volatile uint32_t *)0xE000ED94u)
#define MPU_RBAR (*(volatile uint32_t *)0xE000ED9Cu)
#define MPU_RASR (*(volatile uint32_t *)0xE000EDA0u)

/* A word of the vector table: the first is a stack pointer, the others code. */
union vector {
    void (*handler)(void);
    const void *stack;
};

/* ---- The linker script's places ----------------------------------------------- */
extern uint32_t handler_stack_bottom[], handler_stack_top[];
extern uint32_t thread_stack_bottom[], thread_stack_top[];
extern uint32_t ram_memory[];             /* all RAM begins here */
extern const union vector vector_table[]; /* the board's, at the beginning of its flash */
extern struct crash_record crash_record;  /* both in memory that a reset does not clear */
extern struct crash_streak crash_streak;

/* ---- For the vector table --------------------------------------------------------
 * reset_handler: sets up floating point, stacks and their guards, memory; calls
 * main on the thread stack. fault_handler: leaves a crash record and resets; for
 * all faults, the NMI and unused interrupts. */
void reset_handler(void);
void fault_handler(void);

/* Vectors 2 to 15 and runs of unused interrupts. */
#define VECTOR_FAULT             \
    {                            \
        .handler = fault_handler \
    }
#define VECTOR_FAULT_2 VECTOR_FAULT, VECTOR_FAULT
#define VECTOR_FAULT_4 VECTOR_FAULT_2, VECTOR_FAULT_2
#define VECTOR_FAULT_8 VECTOR_FAULT_4, VECTOR_FAULT_4
#define VECTOR_FAULT_16 VECTOR_FAULT_8, VECTOR_FAULT_8
#define VECTOR_FAULT_64 VECTOR_FAULT_16, VECTOR_FAULT_16, VECTOR_FAULT_16, VECTOR_FAULT_16
#define VECTOR_EXCEPTIONS VECTOR_FAULT_8, VECTOR_FAULT_4, VECTOR_FAULT_2

/* ---- From the board ---------------------------------------------------------------
 * Called by reset_handler. Returning resets. */
int main(void);

/* Called first in any fault, NMI or unexpected interrupt: true when it was
 * harmless and the program may go on. */
bool board_survives(uint32_t exception);

/* Called before the reset: nothing must reach the bus any more. Sets
 * record->build_id, and record->cause where the board knows better than the exception number. */
void board_last_will(struct crash_record *record);

/* Milliseconds since start, callable in a fault; 0 when not known. */
uint32_t board_time_ms(void);

/* ---- To the board ------------------------------------------------------------------ */

/* Lets interrupt `number` through at `priority`, 0 (most urgent) to 15. */
void cortex_m4_enable_interrupt(uint32_t number, uint32_t priority);

/* Resets the processor; whatever is in no-init memory stays. */
_Noreturn void cortex_m4_reset(void);

/* Leaves a crash record with `cause` and `detail` from outside a fault, resets. */
_Noreturn void cortex_m4_crash(enum crash_cause cause, uint32_t detail);

/* Unused bytes of the thread stack since start, by the pattern it was filled with.
 * Cost: one read per unused word. */
uint32_t cortex_m4_stack_unused(void);

/* The bottom of a stack that was ever used up to CORTEX_M4_STACK_MARGIN_WORDS above its guard, 0 when
 * neither was. 80 instructions. */
enum { CORTEX_M4_STACK_MARGIN_WORDS = 8 };
const uint32_t *cortex_m4_stack_too_deep(void);

static inline void cortex_m4_interrupts_on(void)
{
    __asm volatile("cpsie i" ::: "memory");
}

static inline void cortex_m4_barrier(void)
{
    __asm volatile("dsb\n isb" ::: "memory");
}

#endif
