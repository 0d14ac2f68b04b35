#include "hal/port_stm32g474/clock_tree.h"

#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/flash_registers.h"
#include "hal/port_stm32g474/peripheral_clock.h"
#include "hal/port_stm32g474/system_registers.h"

#define PLL_M 6u
#define PLL_N 85u
#define WAIT_STATES 4u       /* up to 170 MHz in boost mode (stm32-rs, flash/acr) */
#define SETTLING_POLLS 2000u /* above 1 us at any clock: RM0440 asks for 1 us at half speed */

static bool wait_for(uint32_t address, uint32_t mask, uint32_t value)
{
    for (uint32_t poll = 0; poll < CLOCK_TREE_POLLS; poll++) {
        if ((mmio_read(address) & mask) == value) {
            return true;
        }
    }
    return false;
}

/* Without it the core must not run above 150 MHz (RM0440), so it is read back. */
static bool switch_to_boost(void)
{
    peripheral_clock_enable(RCC_APB1ENR1, RCC_APB1_PWR);
    mmio_clear(PWR_CR5, PWR_CR5_R1MODE);
    return wait_for(PWR_CR5, PWR_CR5_R1MODE, 0) && wait_for(PWR_SR2, PWR_SR2_VOSF, 0);
}

/* RM0440: wait states first, then the switch at half the bus clock, and full speed 1 us
 * later. The regulator is in its boost mode. */
static bool switch_to_pll(void)
{
    mmio_change(FLASH_ACR, FLASH_ACR_LATENCY_MASK,
                WAIT_STATES | FLASH_ACR_PRFTEN | FLASH_ACR_ICEN | FLASH_ACR_DCEN);
    if (!wait_for(FLASH_ACR, FLASH_ACR_LATENCY_MASK, WAIT_STATES)) {
        return false;
    }
    mmio_change(RCC_CFGR, RCC_CFGR_HPRE_MASK | RCC_CFGR_PPRE_MASK, RCC_CFGR_HPRE_DIV2);
    mmio_change(RCC_CFGR, RCC_CFGR_SW_MASK, RCC_CFGR_SW_PLL);
    if (!wait_for(RCC_CFGR, RCC_CFGR_SW_MASK << RCC_CFGR_SWS_POS,
                  RCC_CFGR_SW_PLL << RCC_CFGR_SWS_POS)) {
        mmio_change(RCC_CFGR, RCC_CFGR_SW_MASK, RCC_CFGR_SW_HSI);
        return false;
    }
    for (uint32_t i = 0; i < SETTLING_POLLS; i++) {
        (void)mmio_read(RCC_CFGR);
    }
    mmio_change(RCC_CFGR, RCC_CFGR_HPRE_MASK, 0);
    return true;
}

enum clock_tree_result clock_tree_init(void)
{
    static const struct mmio_expected expected[] = {{RCC_CR, RCC_CR_CSSON, RCC_CR_CSSON},
                                                    {RCC_CCIPR, RCC_CCIPR_FDCANSEL_MASK, 0}};

    mmio_set(RCC_CR, RCC_CR_HSEON);
    if (!wait_for(RCC_CR, RCC_CR_HSERDY, RCC_CR_HSERDY)) {
        mmio_clear(RCC_CR, RCC_CR_HSEON);
        return CLOCK_TREE_NO_CRYSTAL;
    }
    mmio_clear(RCC_CR, RCC_CR_PLLON);
    if (!wait_for(RCC_CR, RCC_CR_PLLRDY, 0)) {
        return CLOCK_TREE_NO_PLL;
    }
    mmio_write(RCC_PLLCFGR, RCC_PLLCFGR_SRC_HSE | ((PLL_M - 1U) << RCC_PLLCFGR_M_POS) |
                                (PLL_N << RCC_PLLCFGR_N_POS) | RCC_PLLCFGR_REN);
    mmio_set(RCC_CR, RCC_CR_PLLON);
    if (!wait_for(RCC_CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY)) {
        return CLOCK_TREE_NO_PLL;
    }
    if (!switch_to_boost()) {
        return CLOCK_TREE_NO_BOOST;
    }
    if (!switch_to_pll()) {
        return CLOCK_TREE_NO_PLL;
    }
    mmio_set(RCC_CR, RCC_CR_CSSON);
    mmio_clear(RCC_CCIPR, RCC_CCIPR_FDCANSEL_MASK); /* the crystal itself */
    return mmio_first_lost(expected, sizeof expected / sizeof expected[0]) == 0U
               ? CLOCK_TREE_OK
               : CLOCK_TREE_LOST_WRITE;
}

uint32_t clock_tree_hz(void)
{
    const uint32_t source = (mmio_read(RCC_CFGR) >> RCC_CFGR_SWS_POS) & RCC_CFGR_SW_MASK;

    return source == RCC_CFGR_SW_PLL ? (uint32_t)CORE_HZ : (uint32_t)FALLBACK_HZ;
}

bool clock_tree_is_boosted(void)
{
    return (mmio_read(PWR_CR5) & PWR_CR5_R1MODE) == 0U;
}

bool clock_tree_crystal_failed(void)
{
    if ((mmio_read(RCC_CIFR) & RCC_CIFR_CSSF) == 0U) {
        return false;
    }
    mmio_write(RCC_CICR, RCC_CICR_CSSC);
    return true;
}

uint32_t clock_tree_take_reset_flags(void)
{
    uint32_t flags = mmio_read(RCC_CSR) & 0xFE000000U;

    mmio_set(RCC_CSR, RCC_CSR_RMVF);
    return flags;
}
