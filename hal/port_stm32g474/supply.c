#include "hal/port_stm32g474/supply.h"

#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/peripheral_clock.h"
#include "hal/port_stm32g474/system_registers.h"

static void look(struct supply *supply)
{
    const bool low = (mmio_read(PWR_SR2) & PWR_SR2_PVDO) != 0U;

    if (low && !supply->low && supply->dips < UINT32_MAX) {
        supply->dips = supply->dips + 1U;
    }
    supply->was_low = supply->was_low || low;
    supply->low = low;
}

uint32_t supply_init(struct supply *supply)
{
    static const struct mmio_expected expected[] = {
        {PWR_CR2, PWR_CR2_PVDE | PWR_CR2_PLS_MASK, PWR_CR2_PVDE | PWR_CR2_PLS_2V9},
        {EXTI_RTSR1, EXTI_LINE_PVD, EXTI_LINE_PVD},
        {EXTI_FTSR1, EXTI_LINE_PVD, EXTI_LINE_PVD},
        {EXTI_IMR1, EXTI_LINE_PVD, EXTI_LINE_PVD},
        {RCC_APB2ENR, RCC_APB2_SYSCFG, RCC_APB2_SYSCFG},
    };

    supply->low = supply->was_low = false;
    supply->dips = 0;
    peripheral_clock_enable(RCC_APB2ENR, RCC_APB2_SYSCFG);
    peripheral_clock_enable(RCC_APB1ENR1, RCC_APB1_PWR);
    mmio_change(PWR_CR2, PWR_CR2_PVDE | PWR_CR2_PLS_MASK, PWR_CR2_PVDE | PWR_CR2_PLS_2V9);
    mmio_set(EXTI_RTSR1, EXTI_LINE_PVD);
    mmio_set(EXTI_FTSR1, EXTI_LINE_PVD);
    mmio_write(EXTI_PR1, EXTI_LINE_PVD);
    mmio_set(EXTI_IMR1, EXTI_LINE_PVD);
    look(supply);
    return mmio_first_lost(expected, sizeof expected / sizeof expected[0]);
}

void supply_interrupt(struct supply *supply)
{
    const bool before = supply->low;

    mmio_write(EXTI_PR1, EXTI_LINE_PVD);
    look(supply);
    /* Back above the threshold before the register was read: a dip all the same. */
    if (!before && !supply->low) {
        supply->was_low = true;
        supply->dips = supply->dips < UINT32_MAX ? supply->dips + 1U : UINT32_MAX;
    }
}

bool supply_ram_parity_failed(void)
{
    if ((mmio_read(RCC_APB2ENR) & RCC_APB2_SYSCFG) == 0U ||
        (mmio_read(SYSCFG_CFGR2) & SYSCFG_CFGR2_SPF) == 0U) {
        return false;
    }
    mmio_set(SYSCFG_CFGR2, SYSCFG_CFGR2_SPF);
    return true;
}
