/* The supply's detector behind EXTI, the brown-out reset, parity behind SYSCFG, and LPTIM1 on the
 * watchdog's oscillator. RM0440, sections "PWR", "EXTI", "SYSCFG" and "LPTIM". */
#include <string.h>

#include "sim_host/emulator/g474/chip.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "sim_host/emulator/g474/model_check.h"

enum {
    IMR1 = 0,
    RTSR1 = 2,
    FTSR1 = 3,
    PR1 = 5,
    LINE_PVD = 1 << 16,
    PWR_CR2_WORD = 1,
    PVDE = 1,
    CFGR2 = 0x1C,
    SPF = 1 << 8,
    EXCEPTION_NMI = 2,
    LPTIM_ISR = 0,
    LPTIM_CFGR = 3,
    LPTIM_CR = 4,
    LPTIM_ARR = 6,
    LPTIM_CNT = 7,
    LPTIM_RUNS = 1 | 1 << 2,
    ARROK = 1 << 4,
    NS_PER_S = 1000000000
};

/* stm32g4xx-hal-driver: PWR_PVDLEVEL and OB_BOR_LEVEL. The last of the former is a pin. */
static const uint16_t detector_mV[8] = {2000, 2200, 2400, 2500, 2600, 2800, 2900, 0};
static const uint16_t brown_out_mV[8] = {1700, 2000, 2200, 2500, 2800, 2800, 2800, 2800};

bool chip_supply_is_low(const struct chip *chip)
{
    const uint32_t control = chip->clocks.pwr[PWR_CR2_WORD];
    return (control & PVDE) != 0 && chip->supply.vdd_mV < detector_mV[control >> 1 & 7];
}

bool chip_supply_resets(const struct chip *chip)
{
    return chip->supply.vdd_mV < brown_out_mV[chip->flash_registers.optr >> 8 & 7];
}

void chip_supply_follow(struct chip *chip, bool was_low)
{
    const bool low = chip_supply_is_low(chip);
    uint32_t *exti = chip->supply.exti;

    if (low != was_low) {
        exti[PR1] |= exti[low ? RTSR1 : FTSR1] & (uint32_t)LINE_PVD;
        chip_update(chip);
    }
}

static uint32_t exti_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    return offset / 4 < 6 ? chip->supply.exti[offset / 4] : 0;
}

static void exti_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;
    uint32_t *exti = chip->supply.exti;

    if (offset / 4 == PR1) { /* writing 1 clears */
        exti[PR1] &= ~value;
    } else if (offset / 4 < 6) {
        exti[offset / 4] = value;
    }
}

static uint32_t syscfg_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    return offset == CFGR2 ? chip->supply.cfgr2 : 0;
}

static void syscfg_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;

    MODEL_CHECK(offset == CFGR2, "SYSCFG register %#x written", offset);
    chip->supply.cfgr2 = (chip->supply.cfgr2 & ~value & SPF) | (value & 0xF);
}

static uint32_t lptim_read(void *context, uint32_t offset)
{
    const struct chip *chip = context;
    const struct chip_supply *supply = &chip->supply;
    const uint32_t source = chip->clocks.rcc[0x88 / 4] >> 18 & 3;
    const bool runs = (supply->lptim[LPTIM_CR] & LPTIM_RUNS) == LPTIM_RUNS && source == 1 &&
                      (chip->clocks.rcc[0x94 / 4] & 2) != 0;

    if (offset / 4 == LPTIM_CNT) {
        const uint64_t ns = chip_now_ns(chip) - supply->lptim_since_ns;
        return runs ? (uint32_t)(ns * supply->lsi_hz / NS_PER_S % (supply->lptim[LPTIM_ARR] + 1u))
                    : 0;
    }
    return offset / 4 < 9 ? supply->lptim[offset / 4] : 0;
}

static void lptim_write(void *context, uint32_t offset, uint32_t value)
{
    struct chip *chip = context;
    uint32_t *lptim = chip->supply.lptim;
    const bool on = (lptim[LPTIM_CR] & 1) != 0;

    switch (offset / 4) {
    case LPTIM_CFGR:
        MODEL_CHECK(!on && value == 0, "LPTIM1 is set up as %#x, %s", value, on ? "on" : "off");
        break;
    case LPTIM_ARR:
        MODEL_CHECK(on, "LPTIM1 was given its end while off");
        lptim[LPTIM_ISR] |= ARROK;
        break;
    case LPTIM_CR:
        chip->supply.lptim_since_ns = chip_now_ns(chip);
        break;
    default:
        model_misuse("LPTIM1 register %#x written", offset);
        return;
    }
    lptim[offset / 4] = value;
}

/* ---- Memory that answers wrong ------------------------------------------------------------------ */

static void on_weak_read(void *context)
{
    struct chip *chip = context;

    chip->weak_reads++;
    if (!chip->weak_is_ram) {
        flash_model_corrected(&chip->flash_registers);
    } else if ((chip->flash_registers.optr & 1u << 24) == 0) { /* RM0440, "SRAM parity check" */
        chip->supply.cfgr2 |= SPF;
        chip_pend(chip, EXCEPTION_NMI);
    }
}

void chip_weaken(struct chip *chip, uint32_t address)
{
    if (chip->weak_at != 0) {
        core_watch_reads(&chip->core, 0, NULL);
    }
    chip->weak_at = address;
    chip->weak_is_ram = address >= 0x20000000u;
    if (address != 0) {
        core_watch_reads(&chip->core, address, on_weak_read);
    }
}

void chip_supply_reset(struct chip *chip)
{
    memset(chip->supply.exti, 0, sizeof chip->supply.exti);
    memset(chip->supply.lptim, 0, sizeof chip->supply.lptim);
    chip->supply.cfgr2 = 0;
}

void chip_supply_map(struct chip *chip)
{
    mmio_model_map(0x40007C00u, 0x400, lptim_read, lptim_write, chip);
    mmio_model_map(0x40010000u, 0x30, syscfg_read, syscfg_write, chip);
    mmio_model_map(0x40010400u, 0x40, exti_read, exti_write, chip);
}
