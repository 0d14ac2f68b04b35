/* From reset to main: stacks with guards, floating point, memory. */
#include "hal/port_cortex_m/cortex_m4.h"

/* The linker script's: 128 KiB of RAM and 256 KiB with the program, aligned to their size. */
extern const uint32_t program_memory[];
extern uint32_t data_load[], data_start[], data_end[], bss_start[], bss_end[];

enum {
    CPACR_FULL_CP10_CP11 = 0xF << 20,
    CCR_DIV_0_TRAP = 1 << 4,
    SHCSR_FAULTS_ENABLED = 7 << 16, /* memory, bus, usage */
    MPU_ON_WITH_DEFAULT_MAP = 1 | 4,
    MPU_REGION_VALID = 1 << 4,
    MPU_ON = 1,
    MPU_SIZE_32 = 4 << 1,
    MPU_SIZE_256 = 7 << 1,
    MPU_SIZE_128K = 16 << 1,
    MPU_SIZE_256K = 17 << 1,
    /* TEX 0, C, S: memory of the chip, without the write buffer (B3.5.9, table of attributes). */
    MPU_MEMORY = 1 << 17 | 1 << 18,
    MPU_READ_AND_WRITE = 3 << 24,
    MPU_READ_ONLY = 6 << 24,
    MPU_NO_EXECUTE = 1 << 28,
    MPU_NO_ACCESS_NO_EXECUTE = MPU_NO_EXECUTE
};
#define STACK_PATTERN 0xA5A5A5A5u
enum { GUARD_WORDS = 8 };
#define AIRCR_RESET 0x05FA0004u

/* 32 bytes at the bottom of a stack that nobody may touch: an overflow faults. */
static void guard(uint32_t region, const uint32_t *bottom)
{
    MPU_RBAR = (uint32_t)(uintptr_t)bottom | MPU_REGION_VALID | region;
    MPU_RASR = MPU_NO_ACCESS_NO_EXECUTE | MPU_SIZE_32 | MPU_ON;
}

/* RAM is never executed, the program never written. The region with the highest number counts
 * where two overlap (B3.5.3): the guards come behind. */
static void protect(void)
{
    MPU_RBAR = (uint32_t)(uintptr_t)ram_memory | MPU_REGION_VALID | 0u;
    MPU_RASR = MPU_NO_EXECUTE | MPU_READ_AND_WRITE | MPU_MEMORY | MPU_SIZE_128K | MPU_ON;
    MPU_RBAR = (uint32_t)(uintptr_t)program_memory | MPU_REGION_VALID | 1u;
    MPU_RASR = MPU_READ_ONLY | MPU_MEMORY | MPU_SIZE_256K | MPU_ON;
    guard(2, thread_stack_bottom);
    guard(3, handler_stack_bottom);
    /* Address 0 is the vector table, or its alias: data accesses there are null pointers. */
    MPU_RBAR = 0u | MPU_REGION_VALID | 4u;
    MPU_RASR = MPU_NO_ACCESS_NO_EXECUTE | MPU_SIZE_256 | MPU_ON;
    MPU_CTRL = MPU_ON_WITH_DEFAULT_MAP;
    SCB_SHCSR |= SHCSR_FAULTS_ENABLED;
    SCB_CCR |= CCR_DIV_0_TRAP;
    cortex_m4_barrier();
}

/* Runs on the handler stack still empty; written so that the compiler has no
 * reason to call memcpy or memset before memory is ready. */
__attribute__((used)) static void prepare_memory(void)
{
    const uint32_t *from = data_load;

    /* A loader or a debugger may have left it elsewhere; the table begins the flash, aligned. */
    SCB_VTOR = (uint32_t)(uintptr_t)vector_table;
    SCB_CPACR |= CPACR_FULL_CP10_CP11;
    cortex_m4_barrier();
    for (volatile uint32_t *to = data_start; to < data_end; to++) {
        *to = *from++;
    }
    for (volatile uint32_t *to = bss_start; to < bss_end; to++) {
        *to = 0;
    }
    for (volatile uint32_t *to = thread_stack_bottom; to < thread_stack_top; to++) {
        *to = STACK_PATTERN;
    }
    for (uint32_t i = 0; i < CORTEX_M4_STACK_MARGIN_WORDS; i++) {
        *(volatile uint32_t *)(handler_stack_bottom + GUARD_WORDS + i) = STACK_PATTERN;
    }
    protect();
}

__attribute__((naked, noreturn)) void reset_handler(void)
{
    __asm volatile("cpsid i\n"
                   "bl prepare_memory\n"
                   "movw r0, #:lower16:thread_stack_top\n"
                   "movt r0, #:upper16:thread_stack_top\n"
                   "msr psp, r0\n"
                   "movs r0, #2\n" /* thread mode on the process stack */
                   "msr control, r0\n"
                   "isb\n"
                   "bl main\n"
                   "bl cortex_m4_reset\n");
}

void cortex_m4_enable_interrupt(uint32_t number, uint32_t priority)
{
    NVIC_IPR[number] = (uint8_t)(priority << 4); /* the upper four bits count */
    NVIC_ISER[number / 32U] = 1u << (number % 32U);
}

_Noreturn void cortex_m4_reset(void)
{
    cortex_m4_barrier();
    SCB_AIRCR = AIRCR_RESET;
    cortex_m4_barrier();
    for (;;) {
    }
}

const uint32_t *cortex_m4_stack_too_deep(void)
{
    static const uint32_t *const bottom[] = {thread_stack_bottom, handler_stack_bottom};

    for (uint32_t stack = 0; stack < 2u; stack++) {
        const volatile uint32_t *word = bottom[stack] + GUARD_WORDS;
        for (uint32_t i = 0; i < CORTEX_M4_STACK_MARGIN_WORDS; i++) {
            if (word[i] != STACK_PATTERN) {
                return bottom[stack];
            }
        }
    }
    return 0;
}

uint32_t cortex_m4_stack_unused(void)
{
    const volatile uint32_t *word = thread_stack_bottom + 8; /* behind the guard */

    while (word < thread_stack_top && *word == STACK_PATTERN) {
        word++;
    }
    return (uint32_t)((uintptr_t)word - (uintptr_t)thread_stack_bottom);
}
