/* The system control space: NVIC, system control block, SysTick, MPU, cycle counter.
 * Armv7-M Architecture Reference Manual (DDI 0403), B3.2 to B3.5. */
#include <string.h>

#include "sim_host/emulator/g474/chip.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

/* Offsets from 0xE000E000. */
enum {
    SYST_CSR = 0x010,
    SYST_RVR = 0x014,
    SYST_CVR = 0x018,
    SYST_CALIB = 0x01C,
    ISER = 0x100,
    ICER = 0x180,
    ISPR = 0x200,
    ICPR = 0x280,
    IABR = 0x300,
    IPR = 0x400,
    CPUID = 0xD00,
    ICSR = 0xD04,
    VTOR = 0xD08,
    AIRCR = 0xD0C,
    SCR = 0xD10,
    CCR = 0xD14,
    SHPR1 = 0xD18,
    SHCSR = 0xD24,
    CFSR = 0xD28,
    HFSR = 0xD2C,
    MMFAR = 0xD34,
    BFAR = 0xD38,
    CPACR = 0xD88,
    MPU_TYPE = 0xD90,
    MPU_CTRL = 0xD94,
    MPU_RNR = 0xD98,
    MPU_RBAR = 0xD9C,
    MPU_RASR = 0xDA0,
    DEMCR = 0xDFC,
    STIR = 0xF00,
    FPCCR = 0xF34,
    FPCAR = 0xF38,
    FPDSCR = 0xF3C
};
enum {
    SYSTICK_ENABLE = 1,
    SYSTICK_INTERRUPT = 2,
    EXCEPTION_NMI = 2,
    EXCEPTION_PENDSV = 14,
    EXCEPTION_SYSTICK = 15,
    AIRCR_RESET = 1 << 2
};
#define AIRCR_KEY 0x05FA0000u

/* ---- SysTick --------------------------------------------------------------------------------- */

static uint64_t systick_period(const struct chip *chip)
{
    const uint64_t clocks = chip->scs.systick_load + 1u;
    return (chip->scs.systick_ctrl & 4) != 0 ? clocks : 8 * clocks;
}

uint64_t chip_systick_due(const struct chip *chip)
{
    const struct chip_scs *scs = &chip->scs;
    return (scs->systick_ctrl & SYSTICK_ENABLE) != 0 && scs->systick_load > 0
               ? scs->systick_since + systick_period(chip)
               : CHIP_NEVER;
}

void chip_systick_fire(struct chip *chip)
{
    struct chip_scs *scs = &chip->scs;

    if (chip->cycles >= chip_systick_due(chip)) {
        scs->systick_since = chip_systick_due(chip);
        scs->systick_ctrl |= 1u << 16;
        if ((scs->systick_ctrl & SYSTICK_INTERRUPT) != 0) {
            scs->pending[EXCEPTION_SYSTICK] = true;
        }
    }
}

/* ---- NVIC --------------------------------------------------------------------------------------- */

static uint32_t bits_of(const bool *of, uint32_t offset)
{
    const unsigned first = 16 + (offset & 0x7F) / 4 * 32;
    uint32_t bits = 0;

    for (unsigned i = 0; i < 32 && first + i < CHIP_EXCEPTIONS; i++) {
        bits |= of[first + i] ? 1u << i : 0;
    }
    return bits;
}

static void set_bits(bool *of, uint32_t offset, uint32_t bits, bool value)
{
    const unsigned first = 16 + (offset & 0x7F) / 4 * 32;

    for (unsigned i = 0; i < 32 && first + i < CHIP_EXCEPTIONS; i++) {
        if ((bits >> i & 1) != 0) {
            of[first + i] = value;
        }
    }
}

static uint32_t priorities(const struct chip *chip, unsigned first)
{
    uint32_t word = 0;

    for (unsigned i = 0; i < 4 && first + i < CHIP_EXCEPTIONS; i++) {
        word |= (uint32_t)chip->scs.priority[first + i] << (8 * i);
    }
    return word;
}

static void set_priorities(struct chip *chip, unsigned first, uint32_t word)
{
    for (unsigned i = 0; i < 4 && first + i < CHIP_EXCEPTIONS; i++) {
        chip->scs.priority[first + i] = (uint8_t)(word >> (8 * i) & 0xF0); /* four bits count */
    }
}

static uint32_t control_state(const struct chip *chip)
{
    const struct chip_scs *scs = &chip->scs;
    const unsigned active = scs->depth > 0 ? scs->nest[scs->depth - 1] : 0;

    return active | (scs->pending[EXCEPTION_SYSTICK] ? 1u << 26 : 0) |
           (scs->pending[EXCEPTION_PENDSV] ? 1u << 28 : 0) |
           (scs->pending[EXCEPTION_NMI] ? 1u << 31 : 0) | (scs->depth <= 1 ? 1u << 11 : 0);
}

static uint32_t scs_read(void *context, uint32_t offset)
{
    struct chip *chip = context;
    struct chip_scs *scs = &chip->scs;
    uint32_t value;

    if (offset >= IPR && offset < IPR + CHIP_INTERRUPTS + 3) {
        return priorities(chip, 16 + (offset - IPR));
    }
    if (offset >= SHPR1 && offset < SHPR1 + 12) {
        return priorities(chip, 4 + (offset - SHPR1));
    }
    switch (offset & ~0x1Fu) { /* the NVIC's words */
    case ISER:
    case ICER:
        return bits_of(scs->enabled, offset);
    case ISPR:
    case ICPR:
        return bits_of(scs->pending, offset);
    case IABR:
        return bits_of(scs->active, offset);
    default:
        break;
    }
    switch (offset) {
    case SYST_CSR:
        value = scs->systick_ctrl;
        scs->systick_ctrl &= ~(1u << 16);
        return value;
    case SYST_RVR:
        return scs->systick_load;
    case SYST_CVR:
        return chip_systick_due(chip) == CHIP_NEVER
                   ? 0
                   : (uint32_t)(chip_systick_due(chip) - chip->cycles);
    case SYST_CALIB:
        return 0;
    case CPUID:
        return 0x410FC241u;
    case ICSR:
        return control_state(chip);
    case VTOR:
        return scs->vtor;
    case AIRCR:
        return 0xFA050000u | scs->aircr;
    case SCR:
        return scs->scr;
    case CCR:
        return scs->ccr;
    case SHCSR:
        return scs->shcsr;
    case CFSR:
        return scs->cfsr;
    case HFSR:
        return scs->hfsr;
    case MMFAR:
        return scs->mmfar;
    case BFAR:
        return scs->bfar;
    case CPACR:
        return scs->cpacr;
    case MPU_TYPE:
        return CHIP_MPU_REGIONS << 8;
    case MPU_CTRL:
        return scs->mpu_ctrl;
    case MPU_RNR:
        return scs->mpu_rnr;
    case MPU_RBAR:
        return scs->mpu_rbar[scs->mpu_rnr] | scs->mpu_rnr;
    case MPU_RASR:
        return scs->mpu_rasr[scs->mpu_rnr];
    case DEMCR:
        return scs->demcr;
    case FPCCR:
        return scs->fpccr;
    case FPCAR:
        return scs->fpcar;
    case FPDSCR:
        return 0;
    default:
        model_misuse("system register %#x read", 0xE000E000u + offset);
        return 0;
    }
}

static void write_aircr(struct chip *chip, uint32_t value)
{
    if ((value & 0xFFFF0000u) != AIRCR_KEY) {
        model_misuse("AIRCR written without its key");
        return;
    }
    chip->scs.aircr = value & 0x700;
    if ((value & AIRCR_RESET) != 0) {
        chip->reset_asked = true;
        chip->reset_cause = (uint32_t)CHIP_RESET_SOFTWARE | (uint32_t)CHIP_RESET_PIN;
    }
}

static void write_region(struct chip *chip, uint32_t value)
{
    struct chip_scs *scs = &chip->scs;

    if ((value & 1u << 4) != 0) {
        scs->mpu_rnr = value & 7;
    }
    scs->mpu_rbar[scs->mpu_rnr] = value & ~0x1Fu;
}

static void write_nvic(struct chip *chip, uint32_t offset, uint32_t value)
{
    struct chip_scs *scs = &chip->scs;

    switch (offset & ~0x1Fu) {
    case ISER:
        set_bits(scs->enabled, offset, value, true);
        break;
    case ICER:
        set_bits(scs->enabled, offset, value, false);
        break;
    case ISPR:
        set_bits(scs->pending, offset, value, true);
        break;
    case ICPR:
        set_bits(scs->pending, offset, value, false);
        break;
    default:
        break;
    }
}

static void write_system(struct chip *chip, uint32_t offset, uint32_t value)
{
    struct chip_scs *scs = &chip->scs;

    switch (offset) {
    case SYST_CSR:
        scs->systick_since = (scs->systick_ctrl & 1) != 0 ? scs->systick_since : chip->cycles;
        scs->systick_ctrl = value & 7;
        break;
    case SYST_RVR:
        scs->systick_load = value & 0xFFFFFF;
        break;
    case SYST_CVR:
        scs->systick_since = chip->cycles;
        break;
    case ICSR:
        scs->pending[EXCEPTION_NMI] |= (value & 1u << 31) != 0;
        scs->pending[EXCEPTION_PENDSV] |= (value & 1u << 28) != 0;
        scs->pending[EXCEPTION_SYSTICK] |= (value & 1u << 26) != 0;
        break;
    case VTOR: /* the starter is about to begin the program that it may have written */
        chip_begin_program(chip);
        scs->vtor = value & ~0x7Fu;
        break;
    case AIRCR:
        write_aircr(chip, value);
        break;
    case SCR:
        scs->scr = value;
        break;
    case CCR:
        scs->ccr = value;
        break;
    case SHCSR:
        scs->shcsr = value;
        break;
    case CFSR: /* writing 1 clears */
        scs->cfsr &= ~value;
        break;
    case HFSR:
        scs->hfsr &= ~value;
        break;
    case CPACR:
        scs->cpacr = value;
        break;
    case MPU_CTRL:
        scs->mpu_ctrl = value;
        chip_guard(chip);
        break;
    case MPU_RNR:
        scs->mpu_rnr = value & 7;
        break;
    case MPU_RBAR:
        write_region(chip, value);
        break;
    case MPU_RASR:
        scs->mpu_rasr[scs->mpu_rnr] = value;
        chip_guard(chip);
        break;
    case DEMCR:
        scs->demcr = value;
        break;
    case FPCCR:
        scs->fpccr = value;
        break;
    case STIR:
        if ((value & 0x1FF) < CHIP_INTERRUPTS) {
            scs->pending[16 + (value & 0x1FF)] = true;
        }
        break;
    default:
        model_misuse("system register %#x written", 0xE000E000u + offset);
        break;
    }
}

static void scs_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;

    if (offset >= IPR && offset < IPR + CHIP_INTERRUPTS + 3) {
        set_priorities(chip, 16 + (offset - IPR), value);
    } else if (offset >= SHPR1 && offset < SHPR1 + 12) {
        set_priorities(chip, 4 + (offset - SHPR1), value);
    } else if (offset >= ISER && offset < IPR) {
        write_nvic(chip, offset, value);
    } else {
        write_system(chip, offset, value);
    }
}

/* ---- Cycle counter --------------------------------------------------------------------------------- */

static uint32_t counter_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    return offset == 4 ? (uint32_t)chip->cycles : offset == 0 ? 0x40000001u : 0;
}

static void counter_write(void *context, uint32_t offset, uint32_t value)
{
    (void)context;
    MODEL_CHECK(offset == 0 || (offset == 4 && value == 0),
                "the cycle counter's register %#x was written", offset);
}

/* ---- Trace port: DDI 0403, C1.7 and appendix D4 --------------------------------------------------- */

enum { ITM_TER = 0xE00, ITM_TCR = 0xE80 };

static uint32_t trace_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;

    if (offset == ITM_TCR || offset < 0x80) { /* a debugger listens, and there is always room */
        return chip->trace != NULL ? 1 : 0;
    }
    return offset == ITM_TER && chip->trace != NULL ? UINT32_MAX : 0;
}

static void trace_write(void *context, uint32_t offset, uint32_t value)
{
    const struct chip *chip = context;
    const uint8_t packet[5] = {(uint8_t)(offset / 4 << 3 | 3), (uint8_t)value,
                               (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                               (uint8_t)(value >> 24)};

    if (chip->trace != NULL && offset < 0x80) {
        (void)fwrite(packet, sizeof packet, 1, chip->trace);
    }
}

void chip_scs_reset(struct chip *chip)
{
    memset(&chip->scs, 0, sizeof chip->scs);
    chip->scs.ccr = 0x200;
    chip->scs.fpccr = 0xC0000000u;
}

void chip_scs_map(struct chip *chip)
{
    mmio_model_map(0xE000E000u, 0x1000, scs_read, scs_write, chip);
    mmio_model_map(0xE0000000u, 0x1000, trace_read, trace_write, chip);
    mmio_model_map(0xE0001000u, 0x20, counter_read, counter_write, chip);
}
