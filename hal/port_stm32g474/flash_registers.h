/* Flash interface of the STM32G474.
 *
 * Facts from public sources, each number compared by program, all agreeing:
 *   (1) STMicroelectronics, cmsis-device-g4, Include/stm32g474xx.h: addresses and fields;
 *       stm32g4xx-hal-driver, Inc/stm32g4xx_hal_flash.h: keys, size and number of pages;
 *   (2) embassy-rs/stm32-data, data/registers/flash_g4c3.yaml: offsets and fields;
 *   (3) libopencm3, stm32/g4/flash.h and stm32/g4/memorymap.h: addresses, fields, keys;
 *       size of a page and of the flash: Zephyr, dts/arm/st/g4/stm32g4.dtsi, stm32g474Xe.dtsi.
 * Where they disagree (ECCR.ECCD2), or the unit is not certain (ECCR.ADDR_ECC),
 * nothing is used. Behaviour follows RM0440.
 */
#ifndef HAL_PORT_STM32G474_FLASH_REGISTERS_H
#define HAL_PORT_STM32G474_FLASH_REGISTERS_H

#define FLASH_ACR 0x40022000u
#define FLASH_KEYR 0x40022008u
#define FLASH_OPTKEYR 0x4002200Cu
#define FLASH_SR 0x40022010u
#define FLASH_CR 0x40022014u
#define FLASH_ECCR 0x40022018u
#define FLASH_OPTR 0x40022020u

#define FLASH_ACR_LATENCY_MASK 0xFu
#define FLASH_ACR_PRFTEN (1u << 8)
#define FLASH_ACR_ICEN (1u << 9)
#define FLASH_ACR_DCEN (1u << 10)
#define FLASH_ACR_DCRST (1u << 12)

#define FLASH_KEY_1 0x45670123u
#define FLASH_KEY_2 0xCDEF89ABu
#define FLASH_OPTKEY_1 0x08192A3Bu
#define FLASH_OPTKEY_2 0x4C5D6E7Fu

#define FLASH_SR_EOP (1u << 0)
#define FLASH_SR_ERRORS \
    0x000003FAu /* OPERR, PROGERR, WRPERR, PGAERR, SIZERR, PGSERR, MISERR, FASTERR */
#define FLASH_SR_BSY (1u << 16)

#define FLASH_CR_PG (1u << 0)
#define FLASH_CR_PER (1u << 1)
#define FLASH_CR_PNB_POS 3u
#define FLASH_CR_PNB_MASK (0x7Fu << 3)
#define FLASH_CR_BKER (1u << 11)
#define FLASH_CR_STRT (1u << 16)
#define FLASH_CR_OPTSTRT (1u << 17)
#define FLASH_CR_OBL_LAUNCH (1u << 27)
#define FLASH_CR_OPTLOCK (1u << 30)
#define FLASH_CR_LOCK (1u << 31)

#define FLASH_ECCR_ECCIE (1u << 24)
#define FLASH_ECCR_ECCC (1u << 30) /* one error in a word: corrected; written back to clear */
#define FLASH_ECCR_ECCD (1u << 31) /* two errors in a word: NMI; written back to clear */

#define FLASH_OPTR_RDP_MASK 0xFFu
#define FLASH_OPTR_RDP_NONE 0xAAu
#define FLASH_OPTR_BOR_MASK (7u << 8)
#define FLASH_OPTR_BOR_2V5 (3u << 8)
#define FLASH_OPTR_DBANK (1u << 22)
#define FLASH_OPTR_SRAM_PE (1u << 24) /* 0: parity of the first 32 KiB of SRAM1 and of CCM SRAM */

#define FLASH_MEMORY_BASE 0x08000000u
#define FLASH_BANK_BYTES 0x00040000u
#define FLASH_PAGE_BYTES 2048u /* with two banks */
#define FLASH_PAGES_OF_A_BANK 128u

#endif
