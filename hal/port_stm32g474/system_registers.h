/* Clocks, power, pins, timer and watchdog of the STM32G474.
 *
 * Facts from public sources, each number compared by program:
 *   (1) STMicroelectronics, cmsis-device-g4, Include/stm32g474xx.h: all but values of fields;
 *   (2) embassy-rs/stm32-data, data/registers/{rcc_g4,pwr_g4,gpio_v2,timer_v1,iwdg_v2}.yaml:
 *       offsets, fields and their values;
 *   (3) libopencm3, stm32/g4/{memorymap,rcc,pwr,gpio}.h, stm32/common/iwdg_common_all.h and
 *       timer_common_all.h: all of them; stm32/g4/irq.json: interrupts.
 * They agree but for R1MODE, which (2) has at bit 0: NuttX, arch/arm/src/stm32/
 * hardware/stm32g4xxxx_pwr.h, has it at 8 like (1) and (3).
 * The crystal (24 MHz), the PLL's factors and FDCAN1 on PA11 and PA12: Zephyr's
 * nucleo_g474re.dts; alternate function 9: stm32g4xx_hal_gpio_ex.h and
 * mikroSDK's pin lists. LPTIM1, SYSCFG, EXTI, the supply detector and the window: (1), and the values of
 * their fields from stm32g4xx-hal-driver, Inc/stm32g4xx_hal_{pwr,rcc_ex,flash}.h.
 * Behaviour follows RM0440.
 */
#ifndef HAL_PORT_STM32G474_SYSTEM_REGISTERS_H
#define HAL_PORT_STM32G474_SYSTEM_REGISTERS_H

/* ---- RCC ---- */
#define RCC_CR 0x40021000u
#define RCC_CFGR 0x40021008u
#define RCC_PLLCFGR 0x4002100Cu
#define RCC_CIFR 0x4002101Cu
#define RCC_CICR 0x40021020u
#define RCC_APB1RSTR1 0x40021038u
#define RCC_AHB2ENR 0x4002104Cu
#define RCC_APB1ENR1 0x40021058u
#define RCC_APB1ENR2 0x4002105Cu
#define RCC_APB2ENR 0x40021060u
#define RCC_CCIPR 0x40021088u
#define RCC_CSR 0x40021094u

#define RCC_CR_HSION (1u << 8)
#define RCC_CR_HSIRDY (1u << 10)
#define RCC_CR_HSEON (1u << 16)
#define RCC_CR_HSERDY (1u << 17)
#define RCC_CR_CSSON (1u << 19)
#define RCC_CR_PLLON (1u << 24)
#define RCC_CR_PLLRDY (1u << 25)

#define RCC_CFGR_SW_MASK 3u
#define RCC_CFGR_SW_HSI 1u
#define RCC_CFGR_SW_PLL 3u
#define RCC_CFGR_SWS_POS 2u
#define RCC_CFGR_HPRE_MASK (0xFu << 4)
#define RCC_CFGR_HPRE_DIV2 (8u << 4)
#define RCC_CFGR_PPRE_MASK (0x3Fu << 8)

#define RCC_PLLCFGR_SRC_HSE 3u
#define RCC_PLLCFGR_M_POS 4u /* divisor less 1 */
#define RCC_PLLCFGR_N_POS 8u
#define RCC_PLLCFGR_REN (1u << 24) /* output R, to the system; field R at 25: 0 = by 2 */

#define RCC_CIFR_CSSF (1u << 8)
#define RCC_CICR_CSSC (1u << 8)

#define RCC_APB1_TIM2 (1u << 0)
#define RCC_APB1_FDCAN (1u << 25)
#define RCC_APB1_PWR (1u << 28)
#define RCC_APB1_LPTIM1 (1u << 31)
#define RCC_APB2_SYSCFG (1u << 0)
#define RCC_APB1_LPUART1 (1u << 0) /* of the second enable register */
#define RCC_AHB2_GPIOA (1u << 0)
#define RCC_AHB2_GPIOC (1u << 2)

#define RCC_CCIPR_FDCANSEL_MASK (3u << 24)   /* 0 = HSE */
#define RCC_CCIPR_LPUART1SEL_MASK (3u << 10) /* 0 = PCLK1 */
#define RCC_CCIPR_LPTIM1SEL_MASK (3u << 18)
#define RCC_CCIPR_LPTIM1SEL_LSI (1u << 18)

#define RCC_CSR_LSION (1u << 0)
#define RCC_CSR_LSIRDY (1u << 1)
#define RCC_CSR_RMVF (1u << 23)
#define RCC_CSR_OBLRSTF (1u << 25)
#define RCC_CSR_PINRSTF (1u << 26)
#define RCC_CSR_BORRSTF (1u << 27)
#define RCC_CSR_SFTRSTF (1u << 28)
#define RCC_CSR_IWDGRSTF (1u << 29)
#define RCC_CSR_WWDGRSTF (1u << 30)
#define RCC_CSR_LPWRRSTF (1u << 31)

/* ---- PWR ---- */
#define PWR_CR2 0x40007004u
#define PWR_CR2_PVDE (1u << 0)
#define PWR_CR2_PLS_MASK (7u << 1)
#define PWR_CR2_PLS_2V9 (6u << 1)
#define PWR_SR2 0x40007014u
#define PWR_SR2_PVDO (1u << 11) /* the supply is below the threshold */
#define PWR_SR2_VOSF (1u << 10)
#define PWR_CR5 0x40007080u
#define PWR_CR5_R1MODE (1u << 8) /* 0 = boost: needed above 150 MHz */

/* ---- GPIO ---- */
#define GPIOA_BASE 0x48000000u
#define GPIOC_BASE 0x48000800u
#define GPIO_MODER 0x00u
#define GPIO_OSPEEDR 0x08u
#define GPIO_PUPDR 0x0Cu
#define GPIO_IDR 0x10u
#define GPIO_ODR 0x14u
#define GPIO_BSRR 0x18u
#define GPIO_AFRL 0x20u
#define GPIO_AFRH 0x24u
#define GPIO_MODE_INPUT 0u
#define GPIO_MODE_OUTPUT 1u
#define GPIO_MODE_ALTERNATE 2u
#define GPIO_SPEED_HIGH 2u
#define GPIO_PULL_UP 1u
#define GPIO_PULL_DOWN 2u
#define GPIO_AF_TIM2 1u
#define GPIO_AF_FDCAN1 9u
#define GPIO_AF_LPUART1 12u

/* ---- LPUART1 ---- */
#define LPUART1_CR1 0x40008000u
#define LPUART1_BRR 0x4000800Cu
#define LPUART1_ISR 0x4000801Cu
#define LPUART1_TDR 0x40008028u
#define LPUART_CR1_UE (1u << 0)
#define LPUART_CR1_TE (1u << 3)
#define LPUART_ISR_TXE (1u << 7)

/* ---- TIM2, 32 bits ---- */
#define TIM2_CR1 0x40000000u
#define TIM2_DIER 0x4000000Cu
#define TIM2_SR 0x40000010u
#define TIM2_EGR 0x40000014u
#define TIM2_CCMR1 0x40000018u
#define TIM2_CCER 0x40000020u
#define TIM2_CNT 0x40000024u
#define TIM2_PSC 0x40000028u
#define TIM2_ARR 0x4000002Cu
#define TIM2_CCR1 0x40000034u
#define TIM2_CCR2 0x40000038u
#define TIM_CR1_CEN (1u << 0)
#define TIM_DIER_UIE (1u << 0)
#define TIM_DIER_CC1IE (1u << 1)
#define TIM_SR_UIF (1u << 0)
#define TIM_SR_CC1IF (1u << 1)
#define TIM_EGR_UG (1u << 0)
#define TIM_CCMR1_OC2_LOW_ON_MATCH (2u << 12)
#define TIM_CCMR1_OC2_HIGH (5u << 12)
#define TIM_CCER_CC2E (1u << 4)

/* ---- LPTIM1, 16 bits ---- */
#define LPTIM1_ISR 0x40007C00u
#define LPTIM1_CFGR 0x40007C0Cu
#define LPTIM1_CR 0x40007C10u
#define LPTIM1_ARR 0x40007C18u
#define LPTIM1_CNT 0x40007C1Cu
#define LPTIM_ISR_ARROK (1u << 4)
#define LPTIM_CR_ENABLE (1u << 0)
#define LPTIM_CR_CNTSTRT (1u << 2)

/* ---- SYSCFG ---- */
#define SYSCFG_CFGR2 0x4001001Cu
#define SYSCFG_CFGR2_SPF (1u << 8) /* RAM parity error; written back to clear */

/* ---- EXTI; line 16 is the supply's detector ---- */
#define EXTI_IMR1 0x40010400u
#define EXTI_RTSR1 0x40010408u
#define EXTI_FTSR1 0x4001040Cu
#define EXTI_PR1 0x40010414u
#define EXTI_LINE_PVD (1u << 16)

/* ---- IWDG ---- */
#define IWDG_KR 0x40003000u
#define IWDG_PR 0x40003004u
#define IWDG_RLR 0x40003008u
#define IWDG_SR 0x4000300Cu
#define IWDG_WINR 0x40003010u
#define IWDG_KEY_FEED 0xAAAAu
#define IWDG_KEY_UNLOCK 0x5555u
#define IWDG_KEY_START 0xCCCCu
#define IWDG_PR_DIV4 0u
#define IWDG_SR_BUSY 7u /* PVU, RVU, WVU */

/* Interrupt numbers. */
#define IRQ_PVD 1u
#define IRQ_FDCAN1_IT0 21u
#define IRQ_TIM2 28u
#define IRQ_COUNT 102u

#endif
