#include "hal/port_stm32g474/flash_store.h"

#include <string.h>

#include "hal/port_cortex_m/mmio.h"
#include "hal/port_stm32g474/flash_registers.h"

static uint32_t address_of(uint32_t bank, uint32_t index)
{
    return FLASH_MEMORY_BASE + FLASH_BANK_BYTES +
           ((uint32_t)FLASH_STORE_FIRST_PAGE + bank * (uint32_t)FLASH_STORE_PAGES) *
               FLASH_PAGE_BYTES +
           index * NV_WORD_BYTES;
}

static const uint32_t bank_words = FLASH_STORE_PAGES * FLASH_PAGE_BYTES / NV_WORD_BYTES;

static bool in_range(uint32_t bank, uint32_t index)
{
    return bank < NV_BANK_COUNT && index < bank_words;
}

static uint32_t store_bank_words(void *context)
{
    (void)context;
    return bank_words;
}

static void clear_ecc_error(void)
{
    mmio_write(FLASH_ECCR, (mmio_read(FLASH_ECCR) & FLASH_ECCR_ECCIE) | FLASH_ECCR_ECCD);
}

bool flash_store_survives_nmi(struct flash_store *store)
{
    if (!store->reading || (mmio_read(FLASH_ECCR) & FLASH_ECCR_ECCD) == 0U) {
        return false;
    }
    clear_ecc_error();
    store->corrupt = true;
    return true;
}

enum nv_result flash_store_read_at(struct flash_store *store, uint32_t address, uint8_t *out)
{
    uint32_t half[2];

    store->corrupt = false;
    store->reading = true;
    mmio_barrier();
    half[0] = mmio_read(address);
    half[1] = mmio_read(address + 4U);
    mmio_barrier(); /* the interrupt comes in here, if at all */
    if ((mmio_read(FLASH_ECCR) & FLASH_ECCR_ECCD) != 0U) {
        clear_ecc_error();
        store->corrupt = true;
    }
    store->reading = false;
    if (store->corrupt) {
        memset(out, 0, NV_WORD_BYTES);
        return NV_CORRUPT;
    }
    for (uint32_t i = 0; i < NV_WORD_BYTES; i++) {
        out[i] = (uint8_t)(half[i / 4U] >> (8U * (i % 4U)));
    }
    return NV_OK;
}

static enum nv_result store_read_word(void *context, uint32_t bank, uint32_t index, uint8_t *out)
{
    if (!in_range(bank, index)) {
        memset(out, 0, NV_WORD_BYTES);
        return NV_OUT_OF_RANGE;
    }
    return flash_store_read_at(context, address_of(bank, index), out);
}

static const uint8_t *store_map(void *context, uint32_t bank)
{
    (void)context;
    return in_range(bank, 0) ? (const uint8_t *)(uintptr_t)address_of(bank, 0) : NULL;
}

static bool wait_until_idle(void)
{
    for (uint32_t poll = 0; poll < FLASH_STORE_POLLS; poll++) {
        if ((mmio_read(FLASH_SR) & FLASH_SR_BSY) == 0U) {
            return true;
        }
    }
    return false;
}

/* ES0430 (errata of this family), "Data cache might be corrupted during flash memory
 * read-while-write operation": interrupts go on and read the other bank meanwhile, so the
 * cache is off from before an operation until it is over. */
static void switch_data_cache_off(void)
{
    mmio_clear(FLASH_ACR, FLASH_ACR_DCEN);
}

/* It may hold what was there before (RM0440, flash erase): it is emptied, which is
 * allowed only while it is off. */
static void switch_data_cache_on(void)
{
    const uint32_t acr = mmio_read(FLASH_ACR) & ~(FLASH_ACR_DCEN | FLASH_ACR_DCRST);

    mmio_write(FLASH_ACR, acr);
    mmio_write(FLASH_ACR, acr | FLASH_ACR_DCRST);
    mmio_write(FLASH_ACR, acr);
    mmio_write(FLASH_ACR, acr | FLASH_ACR_DCEN);
}

static void clear_operation(void)
{
    mmio_clear(FLASH_CR, FLASH_CR_PG | FLASH_CR_PER | FLASH_CR_PNB_MASK | FLASH_CR_BKER);
}

/* Opens the control register. RM0440: a wrong key locks it until the next reset. */
static bool unlock(void)
{
    if ((mmio_read(FLASH_OPTR) & FLASH_OPTR_DBANK) == 0U || !wait_until_idle()) {
        return false;
    }
    if ((mmio_read(FLASH_CR) & FLASH_CR_LOCK) != 0U) {
        mmio_write(FLASH_KEYR, FLASH_KEY_1);
        mmio_write(FLASH_KEYR, FLASH_KEY_2);
    }
    mmio_write(FLASH_SR, FLASH_SR_ERRORS | FLASH_SR_EOP); /* old errors block new work */
    if ((mmio_read(FLASH_CR) & FLASH_CR_LOCK) != 0U) {
        return false;
    }
    clear_operation(); /* what an operation that did not end left */
    switch_data_cache_off();
    return true;
}

/* Ends an operation: waits, looks for errors, closes the control register. While it goes
 * on, neither that register nor the cache may be touched: the next unlock waits again. */
static enum nv_result finish(struct flash_store *store)
{
    const bool idle = wait_until_idle();
    const bool good = idle && (mmio_read(FLASH_SR) & FLASH_SR_ERRORS) == 0U;

    if (idle) {
        mmio_write(FLASH_SR, FLASH_SR_ERRORS | FLASH_SR_EOP);
        clear_operation();
        mmio_set(FLASH_CR, FLASH_CR_LOCK);
        switch_data_cache_on();
    }
    if (!good && store->failures < UINT32_MAX) {
        store->failures++;
    }
    return good ? NV_OK : NV_FAILED;
}

enum nv_result flash_store_erase_at(struct flash_store *store, uint32_t address)
{
    const uint32_t offset = address - FLASH_MEMORY_BASE;
    const uint32_t page = offset % FLASH_BANK_BYTES / FLASH_PAGE_BYTES;
    const uint32_t bank = offset < FLASH_BANK_BYTES ? 0U : FLASH_CR_BKER;

    if (offset >= 2U * FLASH_BANK_BYTES || offset % FLASH_PAGE_BYTES != 0U) {
        return NV_OUT_OF_RANGE;
    }
    if (!unlock()) {
        return NV_FAILED;
    }
    mmio_change(FLASH_CR, FLASH_CR_PNB_MASK | FLASH_CR_BKER | FLASH_CR_PG,
                FLASH_CR_PER | bank | (page << FLASH_CR_PNB_POS));
    mmio_set(FLASH_CR, FLASH_CR_STRT);
    return finish(store);
}

static enum nv_result store_erase(void *context, uint32_t bank)
{
    enum nv_result result = NV_OK;

    if (!in_range(bank, 0)) {
        return NV_OUT_OF_RANGE;
    }
    for (uint32_t i = 0; i < FLASH_STORE_PAGES && result == NV_OK; i++) {
        result = flash_store_erase_at(context, address_of(bank, 0) + i * FLASH_PAGE_BYTES);
    }
    return result;
}

enum nv_result flash_store_write_at(struct flash_store *store, uint32_t address,
                                    const uint8_t *word)
{
    uint32_t half[2] = {0, 0}, state;

    if (address - FLASH_MEMORY_BASE >= 2U * FLASH_BANK_BYTES || address % NV_WORD_BYTES != 0U) {
        return NV_OUT_OF_RANGE;
    }
    for (uint32_t i = 0; i < NV_WORD_BYTES; i++) {
        half[i / 4U] |= (uint32_t)word[i] << (8U * (i % 4U));
    }
    if (!unlock()) {
        return NV_FAILED;
    }
    mmio_set(FLASH_CR, FLASH_CR_PG);
    state = mmio_lock(); /* the two halves must follow each other */
    mmio_write(address, half[0]);
    mmio_barrier();
    mmio_write(address + 4U, half[1]);
    mmio_unlock(state);
    return finish(store);
}

static enum nv_result store_write_word(void *context, uint32_t bank, uint32_t index,
                                       const uint8_t *word)
{
    return in_range(bank, index) ? flash_store_write_at(context, address_of(bank, index), word)
                                 : NV_OUT_OF_RANGE;
}

uint32_t flash_store_option_bytes(void)
{
    return mmio_read(FLASH_OPTR);
}

bool flash_store_take_corrected(void)
{
    const uint32_t state = mmio_read(FLASH_ECCR);

    if ((state & FLASH_ECCR_ECCC) == 0U) {
        return false;
    }
    mmio_write(FLASH_ECCR, (state & FLASH_ECCR_ECCIE) | FLASH_ECCR_ECCC);
    return true;
}

/* ---- Programs ------------------------------------------------------------------- */

static bool program_read(void *context, uint32_t address, uint8_t *out)
{
    return flash_store_read_at(context, address, out) == NV_OK;
}

static bool program_erase(void *context, uint32_t address)
{
    return flash_store_erase_at(context, address) == NV_OK;
}

static bool program_write(void *context, uint32_t address, const uint8_t *word)
{
    return flash_store_write_at(context, address, word) == NV_OK;
}

struct program_slots flash_store_programs(struct flash_store *store)
{
    const struct program_slots slots = {
        .memory = {program_read, program_erase, program_write, store, FLASH_PAGE_BYTES},
        .slot = FLASH_MEMORY_BASE + FLASH_STARTER_BYTES,
        .stage = FLASH_MEMORY_BASE + FLASH_BANK_BYTES,
        .room = FLASH_PROGRAM_BYTES,
        .mark = FLASH_MEMORY_BASE + FLASH_BANK_BYTES + FLASH_PROGRAM_BYTES,
        .hardware = PROGRAM_HARDWARE_NUCLEO_G474RE,
    };
    return slots;
}

static const struct nv_store_ops store_ops = {store_bank_words, store_read_word, store_map,
                                              store_erase, store_write_word};

void flash_store_init(struct flash_store *store)
{
    memset(store, 0, sizeof *store);
}

struct nv_store flash_store_interface(struct flash_store *store)
{
    struct nv_store interface = {&store_ops, store};
    return interface;
}
