#include "hal/port_stm32g474/option_bytes.h"

#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/flash_store.h"

bool option_bytes_are_set(void)
{
    const uint32_t now = mmio_read(FLASH_OPTR);
    return now == option_bytes_wanted(now);
}

static bool is_idle(void)
{
    for (uint32_t poll = 0; poll < (uint32_t)FLASH_STORE_POLLS; poll++) {
        if ((mmio_read(FLASH_SR) & FLASH_SR_BSY) == 0U) {
            return true;
        }
    }
    return false;
}

/* RM0440, "Modifying user options": both locks, the register, the start, the load. */
static bool unlock(void)
{
    if ((mmio_read(FLASH_CR) & FLASH_CR_LOCK) != 0U) {
        mmio_write(FLASH_KEYR, FLASH_KEY_1);
        mmio_write(FLASH_KEYR, FLASH_KEY_2);
    }
    mmio_write(FLASH_OPTKEYR, FLASH_OPTKEY_1);
    mmio_write(FLASH_OPTKEYR, FLASH_OPTKEY_2);
    return (mmio_read(FLASH_CR) & (FLASH_CR_LOCK | FLASH_CR_OPTLOCK)) == 0U;
}

bool option_bytes_set(bool tried)
{
    const uint32_t now = mmio_read(FLASH_OPTR);

    if (tried || (now & FLASH_OPTR_RDP_MASK) != FLASH_OPTR_RDP_NONE || !is_idle() || !unlock()) {
        return false;
    }
    mmio_write(FLASH_SR, FLASH_SR_ERRORS | FLASH_SR_EOP);
    mmio_write(FLASH_OPTR, option_bytes_wanted(now));
    mmio_set(FLASH_CR, FLASH_CR_OPTSTRT);
    if (!is_idle() || (mmio_read(FLASH_SR) & FLASH_SR_ERRORS) != 0U) {
        mmio_set(FLASH_CR, FLASH_CR_OPTLOCK | FLASH_CR_LOCK);
        return false;
    }
    mmio_set(FLASH_CR, FLASH_CR_OBL_LAUNCH);
    return true;
}
