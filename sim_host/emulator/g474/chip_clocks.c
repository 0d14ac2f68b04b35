/* RCC and PWR: who has a clock, and which one. RM0440, sections "PWR" and "RCC". */
#include <string.h>

#include "sim_host/emulator/g474/chip.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

enum {
    CR = 0x00,
    CFGR = 0x08,
    PLLCFGR = 0x0C,
    CIFR = 0x1C,
    CICR = 0x20,
    APB1RSTR1 = 0x38,
    AHB2ENR = 0x4C,
    APB1ENR1 = 0x58,
    APB1ENR2 = 0x5C,
    APB2ENR = 0x60,
    CCIPR = 0x88,
    CSR = 0x94
};
enum {
    CR_HSION = 1 << 8,
    CR_HSIRDY = 1 << 10,
    CR_HSEON = 1 << 16,
    CR_HSERDY = 1 << 17,
    CR_CSSON = 1 << 19,
    CR_PLLON = 1 << 24,
    CR_PLLRDY = 1 << 25,
    CIFR_CSSF = 1 << 8,
    CSR_RMVF = 1 << 23,
    FDCAN_CLOCK = 1 << 25,
    PWR_CLOCK = 1 << 28,
    SOURCE_HSI = 1,
    SOURCE_HSE = 2,
    SOURCE_PLL = 3,
    PWR_CR1 = 0x00,
    PWR_SR2 = 0x14,
    SR2_PVDO = 1 << 11,
    PWR_CR5 = 0x80,
    CR5_R1MODE = 1 << 8,
    HSE_KHZ = 24000,
    HSI_KHZ = 16000,
    HSE_STARTS_NS = 2000000,
    PLL_LOCKS_NS = 40000,
    EXCEPTION_NMI = 2
};
#define CSR_FLAGS 0xFE000000u

static bool has(const struct chip *chip, uint32_t offset, uint32_t bits)
{
    return (chip->clocks.rcc[offset / 4] & bits) != 0;
}

static uint32_t pll_khz(const struct chip *chip)
{
    const uint32_t pll = chip->clocks.rcc[PLLCFGR / 4];
    const uint32_t m = ((pll >> 4) & 0xF) + 1, n = (pll >> 8) & 0x7F;
    const uint32_t r = 2 * (((pll >> 25) & 3) + 1);
    const uint32_t source = (pll & 3) == 3 ? HSE_KHZ : (pll & 3) == 2 ? HSI_KHZ : 0;

    return (pll & 1u << 24) != 0 ? source / m * n / r : 0;
}

static uint32_t divided(uint32_t khz, uint32_t field)
{
    static const uint16_t divisors[8] = {2, 4, 8, 16, 64, 128, 256, 512};
    return (field & 8) != 0 ? khz / divisors[field & 7] : khz;
}

static uint32_t system_khz(const struct chip *chip)
{
    switch ((chip->clocks.rcc[CFGR / 4] >> 2) & 3) {
    case SOURCE_HSE:
        return HSE_KHZ;
    case SOURCE_PLL:
        return pll_khz(chip);
    default:
        return HSI_KHZ;
    }
}

/* RM0440, "Number of wait states according to CPU clock frequency", voltage range 1. */
static void check_speed(struct chip *chip)
{
    const bool boost = (chip->clocks.pwr[PWR_CR5 / 4] & CR5_R1MODE) == 0;
    const uint32_t wait_states = chip->flash_registers.acr & 0xF;
    const uint32_t step_khz = boost ? 34000 : 30000;

    if (!boost && system_khz(chip) > 150000) {
        chip_find(chip, "%u MHz without the regulator's boost mode", system_khz(chip) / 1000);
    }
    if (chip->clocks.core_khz > step_khz * (wait_states + 1)) {
        chip_find(chip, "flash with %u wait states at %u MHz", wait_states,
                  chip->clocks.core_khz / 1000);
    }
}

static uint32_t timer_khz(const struct chip *chip)
{
    static const uint8_t divisors[4] = {2, 4, 8, 16};
    const uint32_t field = (chip->clocks.rcc[CFGR / 4] >> 8) & 7;
    const uint32_t divisor = (field & 4) != 0 ? divisors[field & 3] : 1;

    /* RM0440: timers get twice the bus's clock when that is divided. */
    return chip->clocks.core_khz / divisor * (divisor > 1 ? 2 : 1);
}

void chip_clocks_apply(struct chip *chip)
{
    const uint32_t khz = divided(system_khz(chip), (chip->clocks.rcc[CFGR / 4] >> 4) & 0xF);

    if (khz != chip->clocks.core_khz && khz != 0) {
        chip_timer_rebase(chip);
        chip->base_ns = chip_now_ns(chip);
        chip->base_cycles = chip->cycles;
        chip->clocks.core_khz = khz;
    }
    if (timer_khz(chip) != chip->clocks.timer_khz) {
        chip_timer_rebase(chip); /* what was counted so far was at the old rate */
        chip->clocks.timer_khz = timer_khz(chip);
    }
    check_speed(chip);
}

bool chip_has_clock(const struct chip *chip, uint32_t address, const char **name)
{
    static const char *const ports[CHIP_PORTS] = {"GPIOA", "GPIOB", "GPIOC", "GPIOD",
                                                  "GPIOE", "GPIOF", "GPIOG"};

    if (address >= 0x48000000u && address < 0x48001C00u) {
        const uint32_t port = (address - 0x48000000u) / 0x400u;
        *name = ports[port];
        return has(chip, AHB2ENR, 1u << port);
    }
    if (address < 0x40000400u && address >= 0x40000000u) {
        *name = "TIM2";
        return has(chip, APB1ENR1, 1);
    }
    if ((address >= 0x40006400u && address < 0x40006800u) ||
        (address >= 0x4000A400u && address < 0x4000AC00u)) {
        *name = "FDCAN1";
        return has(chip, APB1ENR1, FDCAN_CLOCK);
    }
    if (address >= 0x40008000u && address < 0x40008400u) {
        *name = "LPUART1";
        return has(chip, APB1ENR2, 1);
    }
    if (address >= 0x40007C00u && address < 0x40008000u) {
        *name = "LPTIM1";
        return has(chip, APB1ENR1, 1u << 31);
    }
    if (address >= 0x40010000u && address < 0x40010800u) {
        *name = "SYSCFG";
        return has(chip, APB2ENR, 1);
    }
    if (address >= 0x40007000u && address < 0x40007400u) {
        *name = "PWR";
        return has(chip, APB1ENR1, PWR_CLOCK);
    }
    return true;
}

/* ---- Registers ----------------------------------------------------------------------- */

static uint32_t rcc_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    return chip->clocks.rcc[offset / 4];
}

static void write_cr(struct chip *chip, uint32_t value)
{
    struct chip_clocks *clocks = &chip->clocks;
    const uint32_t before = clocks->rcc[CR / 4];
    const uint32_t ready = CR_HSERDY | CR_PLLRDY | CR_HSIRDY;
    uint32_t now = (value & ~ready) | (before & ready);

    if ((value & CR_HSEON) == 0) {
        now &= ~(uint32_t)CR_HSERDY;
        clocks->hse_ready_ns = CHIP_NEVER;
    } else if ((before & CR_HSEON) == 0 && clocks->crystal_works) {
        clocks->hse_ready_ns = chip_now_ns(chip) + HSE_STARTS_NS;
    }
    if ((value & CR_PLLON) == 0) {
        MODEL_CHECK((clocks->rcc[CFGR / 4] & 0xC) != 0xC, "the PLL was switched off while in use");
        now &= ~(uint32_t)CR_PLLRDY;
        clocks->pll_ready_ns = CHIP_NEVER;
    } else if ((before & CR_PLLON) == 0) {
        clocks->pll_ready_ns = chip_now_ns(chip) + PLL_LOCKS_NS;
    }
    clocks->rcc[CR / 4] = now;
}

static void write_cfgr(struct chip *chip, uint32_t value)
{
    struct chip_clocks *clocks = &chip->clocks;
    const uint32_t source = value & 3, before = (clocks->rcc[CFGR / 4] >> 2) & 3;
    const uint32_t ready = source == SOURCE_PLL   ? CR_PLLRDY
                           : source == SOURCE_HSE ? CR_HSERDY
                                                  : CR_HSIRDY;
    const uint32_t shown = has(chip, CR, ready) ? source : before;

    clocks->rcc[CFGR / 4] = (value & ~0xCu) | shown << 2;
    /* RM0440, "clock source switching": above 80 MHz by way of half the bus's clock. */
    if (shown == SOURCE_PLL && before != SOURCE_PLL && pll_khz(chip) > 80000) {
        MODEL_CHECK((value >> 4 & 0xF) == 8, "the switch to the PLL was not at half speed");
    }
    chip_clocks_apply(chip);
}

static void rcc_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;
    uint32_t *reg = &chip->clocks.rcc[offset / 4];

    switch (offset) {
    case CR:
        write_cr(chip, value);
        break;
    case CFGR:
        write_cfgr(chip, value);
        break;
    case PLLCFGR:
        MODEL_CHECK(!has(chip, CR, CR_PLLON), "the PLL was changed while on");
        *reg = value;
        break;
    case CIFR:
        break;
    case CICR:
        if ((value & (uint32_t)CIFR_CSSF) != 0) {
            chip->clocks.rcc[CIFR / 4] &= ~(uint32_t)CIFR_CSSF;
        }
        break;
    case APB1RSTR1:
        *reg = value;
        if ((value & FDCAN_CLOCK) != 0) {
            fdcan_model_reset(&chip->can);
            chip_stop(chip);
        }
        break;
    case CSR:
        *reg = (*reg & CSR_FLAGS) | (value & 1u) | (value & 1u) << 1;
        if ((value & (uint32_t)CSR_RMVF) != 0) {
            *reg &= ~CSR_FLAGS;
        }
        break;
    default:
        *reg = value;
        break;
    }
}

static uint32_t pwr_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    return offset == PWR_SR2 ? (chip_supply_is_low(chip) ? SR2_PVDO : 0)
                             : chip->clocks.pwr[offset / 4];
}

static void pwr_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;

    if (offset != PWR_SR2) { /* VOSF is never up for long enough to be seen */
        chip->clocks.pwr[offset / 4] = value;
        chip_clocks_apply(chip);
    }
}

/* ---- Things that happen by themselves --------------------------------------------------- */

uint64_t chip_clocks_due(const struct chip *chip)
{
    const struct chip_clocks *clocks = &chip->clocks;
    return clocks->hse_ready_ns < clocks->pll_ready_ns ? clocks->hse_ready_ns
                                                       : clocks->pll_ready_ns;
}

void chip_clocks_fire(struct chip *chip)
{
    struct chip_clocks *clocks = &chip->clocks;
    const uint64_t now_ns = chip_now_ns(chip);

    if (now_ns >= clocks->hse_ready_ns) {
        clocks->hse_ready_ns = CHIP_NEVER;
        clocks->rcc[CR / 4] |= CR_HSERDY;
    }
    if (now_ns >= clocks->pll_ready_ns) {
        clocks->pll_ready_ns = CHIP_NEVER;
        if ((clocks->rcc[PLLCFGR / 4] & 3) != 3 || has(chip, CR, CR_HSERDY)) {
            clocks->rcc[CR / 4] |= CR_PLLRDY;
        }
    }
}

void chip_set_crystal(struct chip *chip, bool works)
{
    struct chip_clocks *clocks = &chip->clocks;
    const bool ran = has(chip, CR, CR_HSERDY);

    clocks->crystal_works = works;
    if (works || !ran) {
        return;
    }
    clocks->rcc[CR / 4] &= ~(uint32_t)(CR_HSERDY | CR_PLLRDY);
    if (has(chip, CR, CR_CSSON)) { /* RM0440, "clock security system" */
        clocks->rcc[CR / 4] &= ~(uint32_t)(CR_HSEON | CR_PLLON);
        clocks->rcc[CFGR / 4] = (clocks->rcc[CFGR / 4] & ~0xFu) | SOURCE_HSI << 2 | SOURCE_HSI;
        clocks->rcc[CIFR / 4] |= CIFR_CSSF;
        chip_clocks_apply(chip);
        chip_pend(chip, EXCEPTION_NMI);
    } else if (system_khz(chip) != HSI_KHZ) {
        chip->dead = true; /* nothing clocks the core any more; the watchdog has its own */
    }
    chip_update(chip);
}

void chip_clocks_reset(struct chip *chip, bool power_on)
{
    struct chip_clocks *clocks = &chip->clocks;
    const bool works = clocks->crystal_works;
    const uint32_t causes = power_on ? 0 : clocks->rcc[CSR / 4] & CSR_FLAGS;

    memset(clocks, 0, sizeof *clocks);
    clocks->crystal_works = works;
    clocks->rcc[CR / 4] = CR_HSION | CR_HSIRDY;
    clocks->rcc[CFGR / 4] = SOURCE_HSI << 2 | SOURCE_HSI;
    clocks->rcc[PLLCFGR / 4] = 0x1000;
    clocks->rcc[0x48 / 4] = 0x100; /* flash interface */
    clocks->rcc[CSR / 4] = causes | chip->reset_cause;
    clocks->pwr[PWR_CR1 / 4] = 0x200;
    clocks->pwr[PWR_CR5 / 4] = CR5_R1MODE;
    clocks->hse_ready_ns = clocks->pll_ready_ns = CHIP_NEVER;
    clocks->core_khz = clocks->timer_khz = HSI_KHZ;
}

void chip_clocks_map(struct chip *chip)
{
    mmio_model_map(0x40021000u, 0x100, rcc_read, rcc_write, chip);
    mmio_model_map(0x40007000u, 0x100, pwr_read, pwr_write, chip);
}

/* ---- FDCAN1's clock, pins and bit timing -------------------------------------------------- */

bool chip_can_is_on_bus(const struct chip *chip)
{
    const uint32_t timing = chip->can.reg[0x1C / 4];
    const uint32_t quanta = 1 + ((timing >> 8 & 0xFF) + 1) + ((timing & 0x7F) + 1);
    const uint32_t prescaler = (timing >> 16 & 0x1FF) + 1;
    const struct chip_port *a = &chip->port[0];
    const bool pins = (a->reg[0] >> 22 & 0xF) == 0xA && (a->reg[0x24 / 4] >> 12 & 0xFF) == 0x99;
    const uint32_t select = chip->clocks.rcc[CCIPR / 4] >> 24 & 3;
    const uint32_t divider = chip->can.reg[0x100 / 4] & 0xF;
    uint32_t khz = select == 0   ? (has(chip, CR, CR_HSERDY) ? HSE_KHZ : 0)
                   : select == 2 ? chip->clocks.core_khz
                                 : 0;

    khz = divider > 0 ? khz / (2 * divider) : khz;
    return pins && (chip->can.reg[0x18 / 4] & 1) == 0 && khz == 1000 * quanta * prescaler;
}
