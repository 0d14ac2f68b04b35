#include "hal/port_stm32g474/lsi_meter.h"

#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/peripheral_clock.h"
#include "hal/port_stm32g474/system_registers.h"

enum { POLLS = 20000, READS = 4, SHORTEST_US = 500000, LONGEST_US = 1500000 };
#define COUNT_MAX 0xFFFFU

static void wait_for(uint32_t address, uint32_t bit)
{
    for (uint32_t poll = 0; poll < (uint32_t)POLLS; poll++) {
        if ((mmio_read(address) & bit) != 0U) {
            return; /* if it never comes, nothing is counted and the measurement tells */
        }
    }
}

/* RM0440, LPTIM_CNT: its clock is another one, so a value counts when two reads agree. */
static bool read_count(uint32_t *count)
{
    uint32_t before = mmio_read(LPTIM1_CNT);

    for (uint32_t i = 0; i < (uint32_t)READS; i++) {
        *count = mmio_read(LPTIM1_CNT);
        if (*count == before) {
            return true;
        }
        before = *count;
    }
    return false;
}

uint32_t lsi_meter_init(struct lsi_meter *meter)
{
    static const struct mmio_expected expected[] = {
        {RCC_CCIPR, RCC_CCIPR_LPTIM1SEL_MASK, RCC_CCIPR_LPTIM1SEL_LSI},
        {LPTIM1_ARR, COUNT_MAX, COUNT_MAX},
        {LPTIM1_CR, LPTIM_CR_ENABLE, LPTIM_CR_ENABLE},
    };

    *meter = (struct lsi_meter){.hz = 0};
    mmio_set(RCC_CSR, RCC_CSR_LSION);
    wait_for(RCC_CSR, RCC_CSR_LSIRDY);
    mmio_change(RCC_CCIPR, RCC_CCIPR_LPTIM1SEL_MASK, RCC_CCIPR_LPTIM1SEL_LSI);
    peripheral_clock_enable(RCC_APB1ENR1, RCC_APB1_LPTIM1);
    mmio_write(LPTIM1_CFGR, 0);
    mmio_write(LPTIM1_CR, LPTIM_CR_ENABLE);
    mmio_write(LPTIM1_ARR, COUNT_MAX); /* RM0440: only while enabled */
    wait_for(LPTIM1_ISR, LPTIM_ISR_ARROK);
    mmio_write(LPTIM1_CR, LPTIM_CR_ENABLE | LPTIM_CR_CNTSTRT);
    return mmio_first_lost(expected, sizeof expected / sizeof expected[0]);
}

bool lsi_meter_update(struct lsi_meter *meter, uint32_t now_us)
{
    const uint32_t elapsed_us = now_us - meter->since_us;
    uint32_t count;

    if (elapsed_us < (uint32_t)SHORTEST_US || !read_count(&count)) {
        return false;
    }
    const uint32_t counted = (count - meter->since) & COUNT_MAX;
    const bool fits = meter->since_us != 0U && elapsed_us <= (uint32_t)LONGEST_US;

    meter->since_us = now_us;
    meter->since = count;
    if (fits) {
        meter->hz = counted * 1000U / ((elapsed_us + 500U) / 1000U);
    }
    return fits;
}
