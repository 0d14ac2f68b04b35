/* A model of the STM32G474's flash interface and of both banks, written from the description in RM0440, not from the driver.
 *
 * Modelled: the lock and its keys, page erase, 64-bit programming in two halves,
 * error flags, busy time, error correction with its non-maskable interrupt, the
 * data cache, and power failing in the middle of an operation. */
#ifndef SIM_HOST_EMULATOR_G474_FLASH_MODEL_H
#define SIM_HOST_EMULATOR_G474_FLASH_MODEL_H

#include <stdbool.h>
#include <stdint.h>

enum {
    MODEL_PAGES = 256, /* those of the first bank, then those of the second */
    MODEL_BANK_PAGES = 128,
    MODEL_PAGE_WORDS = 256, /* of 64 bits */
    MODEL_STORE_PAGE = 252  /* the first of the parameter memory */
};

/* As delivered: two banks (bit 22), the lowest brown-out level, no parity (bit 24). And as a chip shows
 * them that finds them torn: RM0351, "Option bytes loading", has for the STM32L4, whose flash this one is
 * like: all bits 1, brown-out level 0, and read protection. RM0440's text was not at hand. */
#define MODEL_OPTIONS_DELIVERED 0xFFEFF8AAu
#define MODEL_OPTIONS_TORN 0xFFFFF8FFu
/* Brown-out level 3 and parity. */
#define MODEL_OPTIONS_SET 0xFEEFFBAAu

/* A page's erase at its longest: as in Zephyr, drivers/flash/flash_stm32.c (releases of 2020), for the
 * STM32G4. A word's programming: no public source was at hand, and nothing is judged by it. */
enum { MODEL_ERASE_NS = 24470000, MODEL_PROGRAM_NS = 83350 };

enum model_word_state {
    WORD_ERASED,
    WORD_WRITTEN,
    WORD_TORN, /* two bits are wrong: told */
    WORD_WEAK  /* one bit is wrong: mended and told */
};

struct flash_model {
    uint32_t acr, cr, sr, eccr;
    /* The option bytes in force, as the register was written since, and as they are stored. */
    uint32_t optr, optr_written, optr_stored;
    int option_keys;
    bool options_wanted; /* to be loaded: the chip is to be reset */
    uint64_t word[MODEL_PAGES][MODEL_PAGE_WORDS];
    uint8_t state[MODEL_PAGES][MODEL_PAGE_WORDS]; /* enum model_word_state */
    uint64_t cached[MODEL_PAGES][MODEL_PAGE_WORDS];
    bool in_cache[MODEL_PAGES][MODEL_PAGE_WORDS];
    int keys;      /* right keys so far; -1 = locked until reset */
    uint32_t busy; /* reads of SR until BSY goes; UINT32_MAX = never */
    uint32_t busy_time;
    bool half_written; /* the first half of a word waits for the second */
    uint32_t half_address, half_value;
    uint32_t operations, power_fails_at;
    void (*on_operation)(void *context); /* before each; NULL = nobody looks */
    void *operation_context;
    bool power_off;
    bool torn_raises_nmi; /* reading a torn word: detected, or silently wrong */
    void (*nmi)(void *context);
    void *nmi_context;
    /* What an operation changed, as bytes from the beginning of flash; NULL = nobody asks. */
    void (*changed)(void *context, uint32_t offset, uint32_t bytes);
    void *changed_context;
    uint32_t first_page;     /* that may be erased */
    uint32_t foreign_erases; /* of pages before it */
    uint32_t worked_on;      /* the bank of the last operation */
    double elapsed_ms;       /* in erases and programming, at their longest */
};

/* Erased pages, two banks, power on; mapped at its addresses. Only the store may be erased. */
void flash_model_init(struct flash_model *model);

/* Reset with power back: registers at their reset values, contents kept. */
void flash_model_power_up(struct flash_model *model);

/* The option bytes as they are stored come into force, as at power-on. */
void flash_model_load_options(struct flash_model *model);

/* A read met a word with one wrong bit, or with two. */
void flash_model_corrected(struct flash_model *model);
void flash_model_failed(struct flash_model *model);

/* A store of a word of 32 bits into flash, `offset` bytes from its beginning. */
void flash_model_store(struct flash_model *model, uint32_t offset, uint32_t value);

#endif
