#include "hal/port_mps2/mps2_board.h"

#include <string.h>

#include "hal/port_mps2/mps2_registers.h"

enum { COUNTS_PER_MS = MPS2_CLOCK_HZ / 1000 };

/* ---- Clock ---------------------------------------------------------------------- */

void mps2_clock_init(struct mps2_clock *clock)
{
    clock->milliseconds = 0;
    TIMER0_CTRL = 0;
    TIMER0_RELOAD = COUNTS_PER_MS - 1;
    TIMER0_VALUE = COUNTS_PER_MS - 1;
    TIMER0_CTRL = TIMER_CTRL_ENABLE | TIMER_CTRL_INTERRUPT;
}

void mps2_clock_interrupt(struct mps2_clock *clock)
{
    TIMER0_INTCLEAR = 1;
    clock->milliseconds = clock->milliseconds + 1u;
}

/* ---- Watchdog -------------------------------------------------------------------- */

void mps2_watchdog_start(void)
{
    WATCHDOG_LOCK = WATCHDOG_UNLOCK_KEY;
    WATCHDOG_LOAD = (uint32_t)MPS2_WATCHDOG_MS * (uint32_t)COUNTS_PER_MS;
    WATCHDOG_CONTROL = WATCHDOG_INTERRUPT_AND_RESET;
    WATCHDOG_LOCK = 0;
}

bool mps2_watchdog_barked(void)
{
    return (WATCHDOG_RAW_INTERRUPT & 1u) != 0u;
}

static void feed(void *context)
{
    (void)context;
    WATCHDOG_LOCK = WATCHDOG_UNLOCK_KEY;
    WATCHDOG_INTCLEAR = 1; /* reloads */
    WATCHDOG_LOCK = 0;
}

static const struct watchdog_ops watchdog_ops = {feed};
const struct watchdog mps2_watchdog = {&watchdog_ops, 0};

/* ---- Emergency stop -------------------------------------------------------------------- */

static bool button_pressed(void *context)
{
    (void)context;
    return (FPGAIO_BUTTON & 1u) != 0u;
}

static const struct emergency_stop_ops button_ops = {button_pressed};
const struct emergency_stop mps2_button_stop = {&button_ops, 0};

/* ---- Parameter memory --------------------------------------------------------------- */

static uint8_t *word_at(uint32_t bank, uint32_t index)
{
    return (uint8_t *)(uintptr_t)((uint32_t)MPS2_NV_BASE +
                                  (bank * MPS2_NV_WORDS + index) * NV_WORD_BYTES);
}

static uint32_t nv_bank_words(void *context)
{
    (void)context;
    return MPS2_NV_WORDS;
}

static enum nv_result nv_read_word(void *context, uint32_t bank, uint32_t index, uint8_t *out)
{
    (void)context;
    if (bank >= NV_BANK_COUNT || index >= MPS2_NV_WORDS) {
        memset(out, 0, NV_WORD_BYTES);
        return NV_OUT_OF_RANGE;
    }
    memcpy(out, word_at(bank, index), NV_WORD_BYTES);
    return NV_OK;
}

static const uint8_t *nv_map(void *context, uint32_t bank)
{
    (void)context;
    return bank < NV_BANK_COUNT ? word_at(bank, 0) : NULL;
}

static enum nv_result nv_erase(void *context, uint32_t bank)
{
    (void)context;
    if (bank >= NV_BANK_COUNT) {
        return NV_OUT_OF_RANGE;
    }
    memset(word_at(bank, 0), 0xFF, (size_t)MPS2_NV_WORDS * NV_WORD_BYTES);
    return NV_OK;
}

static enum nv_result nv_write_word(void *context, uint32_t bank, uint32_t index,
                                    const uint8_t *word)
{
    (void)context;
    if (bank >= NV_BANK_COUNT || index >= MPS2_NV_WORDS) {
        return NV_OUT_OF_RANGE;
    }
    memcpy(word_at(bank, index), word, NV_WORD_BYTES);
    return NV_OK;
}

static const struct nv_store_ops nv_ops = {nv_bank_words, nv_read_word, nv_map, nv_erase,
                                           nv_write_word};
const struct nv_store mps2_nv_store = {&nv_ops, 0};
