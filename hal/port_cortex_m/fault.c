/* Faults: what happened is written down, the bus is left alone, the processor
 * restarts. The drives notice the missing heartbeat and unload by themselves. */
#include "hal/port_cortex_m/cortex_m4.h"

/* Words of the exception frame (Armv7-M, B1.5.6). */
enum { R0, R1, R2, R3, R12, LR, PC, XPSR, BASIC_FRAME, FLOAT_FRAME = 26 };

enum {
    EXCEPTION_NMI = 2,
    EXCEPTION_HARD_FAULT = 3,
    EXCEPTION_MEMORY = 4,
    EXCEPTION_BUS = 5,
    EXCEPTION_USAGE = 6,
    EXC_RETURN_NO_FLOAT = 1 << 4,
    CFSR_MMARVALID = 1 << 7,
    CFSR_BFARVALID = 1 << 15
};

static enum crash_cause cause_of(uint32_t exception)
{
    switch (exception) {
    case EXCEPTION_NMI:
        return CRASH_NMI;
    case EXCEPTION_HARD_FAULT:
        return CRASH_HARD_FAULT;
    case EXCEPTION_MEMORY:
        return CRASH_MEMORY_FAULT;
    case EXCEPTION_BUS:
        return CRASH_BUS_FAULT;
    case EXCEPTION_USAGE:
        return CRASH_USAGE_FAULT;
    default:
        return CRASH_UNEXPECTED_INTERRUPT;
    }
}

/* True when `words` words at `at` lie in one of the stacks, above its guard. */
static bool is_readable(const uint32_t *at, uint32_t words)
{
    return ((uintptr_t)at % 4u) == 0u &&
           ((at >= thread_stack_bottom + 8 && at + words <= thread_stack_top) ||
            (at >= handler_stack_bottom + 8 && at + words <= handler_stack_top));
}

static void copy_frame(struct crash_record *record, const uint32_t *frame, uint32_t exc_return)
{
    uint32_t size = (exc_return & EXC_RETURN_NO_FLOAT) != 0u ? BASIC_FRAME : FLOAT_FRAME;

    record->sp = (uint32_t)(uintptr_t)(frame + size);
    if (!is_readable(frame, BASIC_FRAME)) {
        return;
    }
    record->r0 = frame[R0];
    record->r1 = frame[R1];
    record->r2 = frame[R2];
    record->r3 = frame[R3];
    record->r12 = frame[R12];
    record->lr = frame[LR];
    record->pc = frame[PC];
    record->xpsr = frame[XPSR];
    for (uint32_t i = 0; i < CRASH_STACK_WORDS && is_readable(frame + size + i, 1); i++) {
        record->stack[i] = frame[size + i];
    }
}

static void begin_record(struct crash_record *record)
{
    crash_record_begin(record);
    record->time_ms = board_time_ms();
}

_Noreturn static void finish_record(struct crash_record *record)
{
    board_last_will(record);
    crash_record_seal(record);
    crash_streak_add(&crash_streak);
    cortex_m4_reset();
}

/* Called by fault_handler with the stacked frame. Returns when it was harmless. */
__attribute__((used)) static void report(const uint32_t *frame, uint32_t exc_return,
                                         uint32_t exception)
{
    struct crash_record *record = &crash_record;

    if (board_survives(exception)) {
        return;
    }
    begin_record(record);
    record->cause = (uint32_t)cause_of(exception);
    record->detail = exception;
    record->cfsr = SCB_CFSR;
    record->hfsr = SCB_HFSR;
    if ((record->cfsr & CFSR_MMARVALID) != 0u) {
        record->fault_address = SCB_MMFAR;
    } else if ((record->cfsr & CFSR_BFARVALID) != 0u) {
        record->fault_address = SCB_BFAR;
    }
    copy_frame(record, frame, exc_return);
    finish_record(record);
}

__attribute__((naked)) void fault_handler(void)
{
    __asm volatile("tst lr, #4\n"
                   "ite eq\n"
                   "mrseq r0, msp\n"
                   "mrsne r0, psp\n"
                   "mov r1, lr\n"
                   "mrs r2, ipsr\n"
                   "push {r3, lr}\n"
                   "bl report\n"
                   "pop {r3, pc}\n");
}

_Noreturn void cortex_m4_crash(enum crash_cause cause, uint32_t detail)
{
    struct crash_record *record = &crash_record;

    __asm volatile("cpsid i" ::: "memory");
    begin_record(record);
    record->cause = (uint32_t)cause;
    record->detail = detail;
    record->pc = (uint32_t)(uintptr_t)__builtin_return_address(0);
    finish_record(record);
}

/* What newlib's assert calls; defined here so that its own, which prints, is not
 * linked. The name is the library's. */
_Noreturn void __assert_func(const char *file, int line, const char *function,
                             const char *expression);
_Noreturn void __assert_func(const char *file, int line, const char *function,
                             const char *expression)
{
    (void)file;
    (void)function;
    (void)expression;
    cortex_m4_crash(CRASH_ASSERTION, (uint32_t)line);
}
