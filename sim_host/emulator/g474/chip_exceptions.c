/* Exceptions as Armv7-M has them: who comes first, what is stacked, how it returns.
 * DDI 0403, B1.5.2 (numbers), B1.5.4 (priorities), B1.5.6 to B1.5.8 (entry and return, also of the
 * floating-point state, which is stored at once or lazily), B1.5.12 (tail-chaining). */
#include <string.h>

#include "sim_host/emulator/g474/chip.h"

enum {
    HARD_FAULT = 3,
    MEMORY_FAULT = 4,
    BUS_FAULT = 5,
    USAGE_FAULT = 6,
    PRIORITY_NONE = 256, /* of a thread */
    PRIORITY_HARD = -1,
    PRIORITY_NMI = -2,
    ENTRY_CYCLES = 12,
    RETURN_CYCLES = 12,
    TAIL_CYCLES = 6,
    BASIC_WORDS = 8,
    FLOAT_WORDS = 26,
    CONTROL_PSP = 2,
    CONTROL_FLOAT = 4,
    XPSR_PADDED = 1 << 9,
    XPSR_THUMB = 1 << 24,
    CCR_ALIGN_8 = 1 << 9,
    RETURN_TO_THREAD = 1 << 3,
    RETURN_ON_PSP = 1 << 2,
    RETURN_BASIC = 1 << 4,
    FPCCR_LSPACT = 1 << 0,
    FPCCR_THREAD = 1 << 3,
    FPCCR_LSPEN = 1 << 30,
    CFSR_MEMORY_FETCH = 1 << 0,
    CFSR_MEMORY_DATA = 1 << 1,
    CFSR_MEMORY_ADDRESS = 1 << 7,
    CFSR_BUS_FETCH = 1 << 8,
    CFSR_BUS_DATA = 1 << 9,
    CFSR_BUS_ADDRESS = 1 << 15,
    CFSR_UNDEFINED = 1 << 16,
    HFSR_FORCED = 1 << 30
};
#define RAM_BASE 0x20000000u

static int priority_of(const struct chip *chip, unsigned exception)
{
    if (exception == 2) {
        return PRIORITY_NMI;
    }
    return exception == HARD_FAULT ? PRIORITY_HARD : chip->scs.priority[exception];
}

/* By the group's bits alone: PRIGROUP splits what preempts from what only orders. */
static int group_of(const struct chip *chip, int priority)
{
    const uint32_t group = chip->scs.aircr >> 8 & 7;
    return priority < 0 ? priority : priority & ~((2 << group) - 1) & 0xFF;
}

static bool is_enabled(const struct chip *chip, unsigned exception)
{
    switch (exception) {
    case MEMORY_FAULT:
    case BUS_FAULT:
    case USAGE_FAULT:
        return (chip->scs.shcsr >> (12 + exception) & 1) != 0;
    default:
        return exception < 16 || (exception < CHIP_EXCEPTIONS && chip->scs.enabled[exception]);
    }
}

/* The most urgent pending one, 0 = none; among equals the lowest number. */
static unsigned most_urgent(const struct chip *chip)
{
    static const bool none[CHIP_EXCEPTIONS];
    unsigned best = 0;

    if (memcmp(chip->scs.pending, none, sizeof none) == 0) { /* nearly always */
        return 0;
    }
    for (unsigned i = 2; i < CHIP_EXCEPTIONS; i++) {
        if (chip->scs.pending[i] && is_enabled(chip, i) &&
            (best == 0 || priority_of(chip, i) < priority_of(chip, best))) {
            best = i;
        }
    }
    return best;
}

static int running_priority(const struct chip *chip)
{
    int running = PRIORITY_NONE;

    for (unsigned i = 0; i < chip->scs.depth; i++) {
        const int own = group_of(chip, priority_of(chip, chip->scs.nest[i]));
        running = own < running ? own : running;
    }
    return running;
}

bool chip_wants_exception(const struct chip *chip)
{
    const unsigned exception = most_urgent(chip);
    return exception != 0 && group_of(chip, priority_of(chip, exception)) < running_priority(chip);
}

unsigned chip_next_exception(struct chip *chip)
{
    const unsigned exception = most_urgent(chip);
    const uint32_t base = core_get(&chip->core, CORE_BASEPRI);
    int running = running_priority(chip);

    if (base != 0 && (int)base < running) {
        running = (int)base;
    }
    if ((core_get(&chip->core, CORE_PRIMASK) & 1) != 0 && running > 0) {
        running = 0;
    }
    if ((core_get(&chip->core, CORE_FAULTMASK) & 1) != 0 && running > PRIORITY_HARD) {
        running = PRIORITY_HARD;
    }
    return exception != 0 && group_of(chip, priority_of(chip, exception)) < running ? exception : 0;
}

void chip_pend(struct chip *chip, unsigned exception)
{
    chip->scs.pending[exception] = true;
    chip_update(chip);
}

/* ---- Stacking -------------------------------------------------------------------------------- */

static uint32_t *stack_word(struct chip *chip, uint32_t address)
{
    const uint32_t offset = address - 0x20000000u;

    if (offset > CHIP_RAM_BYTES - 4 || address % 4 != 0) {
        chip_find(chip, "an exception was stacked at %#x: the chip locks up", address);
        chip->dead = true;
        return (uint32_t *)(void *)chip->ram;
    }
    return (uint32_t *)(void *)(chip->ram + offset);
}

static void push_float(struct chip *chip, uint32_t frame)
{
    uint32_t s[16];

    core_get_float(&chip->core, s);
    for (unsigned i = 0; i < 16; i++) {
        *stack_word(chip, frame + 4 * (BASIC_WORDS + i)) = s[i];
    }
    *stack_word(chip, frame + 4 * (BASIC_WORDS + 16)) = core_get(&chip->core, CORE_FPSCR);
}

static void pop_float(struct chip *chip, uint32_t frame)
{
    uint32_t s[16];

    for (unsigned i = 0; i < 16; i++) {
        s[i] = *stack_word(chip, frame + 4 * (BASIC_WORDS + i));
    }
    core_set_float(&chip->core, s);
    core_set(&chip->core, CORE_FPSCR, *stack_word(chip, frame + 4 * (BASIC_WORDS + 16)));
}

/* The place is reserved; what goes there is stored when the first floating-point instruction
 * comes, if one does (FPCCR.LSPEN). */
static void reserve_float(struct chip *chip, uint32_t frame, bool thread)
{
    chip->scs.fpcar = frame + 4 * BASIC_WORDS;
    chip->scs.fpccr = (chip->scs.fpccr & ~(uint32_t)FPCCR_THREAD) | (uint32_t)FPCCR_LSPACT |
                      (thread ? (uint32_t)FPCCR_THREAD : 0u);
}

bool chip_float_is_owed(const struct chip *chip)
{
    return (chip->scs.fpccr & (uint32_t)FPCCR_LSPACT) != 0;
}

void chip_store_float(struct chip *chip)
{
    push_float(chip, chip->scs.fpcar - 4 * BASIC_WORDS);
    chip->scs.fpccr &= ~(uint32_t)FPCCR_LSPACT;
}

/* Stacks what runs now; returns the EXC_RETURN value. */
static uint32_t push_frame(struct chip *chip, uint32_t pc)
{
    struct core *core = &chip->core;
    const uint32_t control = core_get(core, CORE_CONTROL);
    const bool thread = chip->scs.depth == 0;
    const bool psp = thread && (control & CONTROL_PSP) != 0;
    const bool floats = (control & CONTROL_FLOAT) != 0 && (chip->scs.fpccr >> 31) != 0;
    const uint32_t words = floats ? FLOAT_WORDS : BASIC_WORDS;
    const uint32_t sp = core_get(core, psp ? CORE_PSP : CORE_MSP);
    const bool align = floats || (chip->scs.ccr & CCR_ALIGN_8) != 0;
    const bool padded = align && (sp & 4) != 0;
    const uint32_t frame = (sp - 4 * words) & ~(uint32_t)(align ? 4 : 0);
    uint32_t xpsr = core_get(core, CORE_XPSR) & ~(uint32_t)XPSR_PADDED;

    for (unsigned i = 0; i < 6; i++) {
        *stack_word(chip, frame + 4 * i) = core_get(core, (enum core_register)(CORE_R0 + i));
    }
    *stack_word(chip, frame + 24) = pc & ~1u;
    xpsr |= (uint32_t)XPSR_THUMB | (padded ? (uint32_t)XPSR_PADDED : 0u);
    *stack_word(chip, frame + 28) = xpsr;
    if (floats && (chip->scs.fpccr & (uint32_t)FPCCR_LSPEN) != 0) {
        reserve_float(chip, frame, thread);
    } else if (floats) {
        push_float(chip, frame);
    }
    core_set(core, psp ? CORE_PSP : CORE_MSP, frame);
    return 0xFFFFFFE1u | (floats ? 0u : (uint32_t)RETURN_BASIC) |
           (thread ? (uint32_t)RETURN_TO_THREAD : 0u) | (psp ? (uint32_t)RETURN_ON_PSP : 0u);
}

static uint32_t begin_handler(struct chip *chip, unsigned exception, uint32_t exc_return)
{
    struct core *core = &chip->core;
    struct chip_scs *scs = &chip->scs;
    const uint32_t table = scs->vtor == 0 ? 0 : scs->vtor - 0x08000000u;
    uint32_t handler = 0;

    scs->pending[exception] = false;
    scs->active[exception] = true;
    scs->entries++;
    if (scs->depth == CHIP_NEST_MAX || table + 4 * exception + 4 > CHIP_FLASH_BYTES) {
        chip_find(chip, "no vector for exception %u: the chip locks up", exception);
        chip->dead = true;
        return 0;
    }
    scs->nest[scs->depth++] = (uint8_t)exception;
    chip_flash_use_note(chip, table + 4 * exception, 4);
    handler = *(uint32_t *)(void *)(chip->flash + table + 4 * exception);
    core_set(core, CORE_XPSR, (uint32_t)XPSR_THUMB | exception);
    core_set(core, CORE_CONTROL,
             core_get(core, CORE_CONTROL) & ~(uint32_t)(CONTROL_PSP | CONTROL_FLOAT));
    core_set(core, CORE_LR, exc_return);
    chip_update(chip);
    return handler & ~1u;
}

uint32_t chip_enter(struct chip *chip, unsigned exception, uint32_t pc)
{
    const uint32_t exc_return = push_frame(chip, pc);

    chip->cycles += ENTRY_CYCLES;
    return begin_handler(chip, exception, exc_return);
}

static uint32_t pop_frame(struct chip *chip, uint32_t exc_return)
{
    struct core *core = &chip->core;
    const bool thread = (exc_return & RETURN_TO_THREAD) != 0;
    const bool psp = (exc_return & RETURN_ON_PSP) != 0;
    const bool floats = (exc_return & RETURN_BASIC) == 0;
    const uint32_t frame = core_get(core, psp ? CORE_PSP : CORE_MSP);
    const uint32_t xpsr = *stack_word(chip, frame + 28);
    const uint32_t pc = *stack_word(chip, frame + 24);
    const uint32_t after = frame + 4u * (uint32_t)(floats ? FLOAT_WORDS : BASIC_WORDS) +
                           ((xpsr & (uint32_t)XPSR_PADDED) != 0 ? 4u : 0u);
    const uint32_t control =
        core_get(core, CORE_CONTROL) & ~(uint32_t)(CONTROL_PSP | CONTROL_FLOAT);

    if (floats && chip_float_is_owed(chip)) { /* the registers still hold it */
        chip->scs.fpccr &= ~(uint32_t)FPCCR_LSPACT;
    } else if (floats) {
        pop_float(chip, frame);
    }
    core_set(core, psp ? CORE_PSP : CORE_MSP, after);
    core_set(core, CORE_XPSR, (xpsr & ~(uint32_t)XPSR_PADDED & ~(thread ? 0x1FFu : 0u)));
    core_set(core, CORE_CONTROL,
             control | (psp ? (uint32_t)CONTROL_PSP : 0u) |
                 (floats ? (uint32_t)CONTROL_FLOAT : 0u));
    for (unsigned i = 0; i < 6; i++) {
        core_set(core, (enum core_register)(CORE_R0 + i), *stack_word(chip, frame + 4 * i));
    }
    return pc;
}

uint32_t chip_leave(struct chip *chip, uint32_t exc_return)
{
    struct chip_scs *scs = &chip->scs;
    unsigned next;

    if (scs->depth == 0 || (exc_return & 0xFFFFFFE0u) != 0xFFFFFFE0u) {
        chip_find(chip, "a return to %#x outside of a handler: the chip locks up", exc_return);
        chip->dead = true;
        return 0;
    }
    const unsigned ended = scs->nest[--scs->depth];
    scs->active[ended] = false;
    if (ended != 2) {
        core_set(&chip->core, CORE_FAULTMASK, 0);
    }
    chip_update(chip);
    next = chip_next_exception(chip);
    if (next != 0) { /* tail-chained: the frame stays where it is */
        chip->cycles += TAIL_CYCLES;
        scs->tail_chained++;
        return begin_handler(chip, next, exc_return);
    }
    chip->cycles += RETURN_CYCLES;
    return pop_frame(chip, exc_return);
}

/* ---- Faults -------------------------------------------------------------------------------------- */

/* DDI 0403, B3.5.9: the program is privileged throughout. Permissions 5 to 7 are read only. */
static bool region_forbids(uint32_t rasr, enum core_stop access)
{
    const uint32_t permission = rasr >> 24 & 7;
    const bool never_executed = (rasr >> 28 & 1) != 0;

    if (permission == 0) {
        return true;
    }
    return (access == CORE_BAD_FETCH && never_executed) ||
           (access == CORE_BAD_WRITE && permission >= 5);
}

bool chip_mpu_forbids(const struct chip *chip, uint32_t address, enum core_stop access)
{
    const struct chip_scs *scs = &chip->scs;

    if ((scs->mpu_ctrl & 1) == 0) {
        return false;
    }
    for (unsigned i = CHIP_MPU_REGIONS; i-- > 0;) { /* the highest number counts */
        const uint32_t rasr = scs->mpu_rasr[i];
        const uint32_t bytes = 2u << (rasr >> 1 & 0x1F);
        if ((rasr & 1) != 0 && address - scs->mpu_rbar[i] < bytes) {
            return region_forbids(rasr, access);
        }
    }
    return false;
}

/* The watched bytes of region i, NULL when it is none that is closed and in RAM. */
static const uint8_t *guarded_ram(const struct chip *chip, unsigned i, uint32_t *bytes)
{
    const struct chip_scs *scs = &chip->scs;
    const uint32_t rasr = scs->mpu_rasr[i], offset = scs->mpu_rbar[i] - 0x20000000u;

    *bytes = 2u << (rasr >> 1 & 0x1F);
    *bytes = *bytes < (uint32_t)CHIP_GUARD_MAX ? *bytes : (uint32_t)CHIP_GUARD_MAX;
    return (scs->mpu_ctrl & 1) != 0 && (rasr & 1) != 0 && (rasr >> 24 & 7) == 0 &&
                   offset <= CHIP_RAM_BYTES - *bytes
               ? chip->ram + offset
               : NULL;
}

void chip_guard(struct chip *chip)
{
    for (unsigned i = 0; i < CHIP_MPU_REGIONS; i++) {
        uint32_t bytes;
        const uint8_t *ram = guarded_ram(chip, i, &bytes);
        if (ram != NULL) {
            memcpy(chip->scs.guarded[i], ram, bytes);
        }
    }
}

void chip_check_guards(struct chip *chip)
{
    for (unsigned i = 0; (chip->scs.mpu_ctrl & 1) != 0 && i < CHIP_MPU_REGIONS; i++) {
        uint32_t bytes;
        const uint8_t *ram = guarded_ram(chip, i, &bytes);
        if (ram != NULL && memcmp(chip->scs.guarded[i], ram, bytes) != 0) {
            memcpy(chip->scs.guarded[i], ram, bytes);
            chip->scs.cfsr |= CFSR_MEMORY_DATA | CFSR_MEMORY_ADDRESS;
            chip->scs.mmfar = chip->scs.mpu_rbar[i];
            chip_pend(chip, MEMORY_FAULT);
        }
    }
}

unsigned chip_fault(struct chip *chip, enum core_stop stop, uint32_t address)
{
    struct chip_scs *scs = &chip->scs;
    const bool fetch = stop == CORE_BAD_FETCH;
    unsigned exception = USAGE_FAULT;

    if (stop == CORE_UNDEFINED) {
        scs->cfsr |= CFSR_UNDEFINED;
    } else if (chip_mpu_forbids(chip, address, stop)) {
        exception = MEMORY_FAULT;
        scs->cfsr |= fetch ? CFSR_MEMORY_FETCH : CFSR_MEMORY_DATA | CFSR_MEMORY_ADDRESS;
        scs->mmfar = address;
    } else {
        exception = BUS_FAULT;
        scs->cfsr |= fetch ? CFSR_BUS_FETCH : CFSR_BUS_DATA | CFSR_BUS_ADDRESS;
        scs->bfar = address;
        if (fetch && address - RAM_BASE < (uint32_t)CHIP_RAM_BYTES) {
            chip_find(chip, "RAM is executed: the MPU does not forbid it");
        }
    }
    if (!is_enabled(chip, exception) ||
        group_of(chip, priority_of(chip, exception)) >= running_priority(chip) ||
        (core_get(&chip->core, CORE_PRIMASK) & 1) != 0) {
        scs->hfsr |= HFSR_FORCED;
        exception = HARD_FAULT;
        if (running_priority(chip) <= PRIORITY_HARD) {
            chip_find(chip, "a fault in the handler of a fault: the chip locks up");
            chip->dead = true;
        }
    }
    return exception;
}
