/* A model of the STM32G474's flash interface and of the four pages the parameter
 * store uses, written from the description in RM0440, not from the driver.
 *
 * Modelled: the lock and its keys, page erase, 64-bit programming in two halves,
 * error flags, busy time, error correction with its non-maskable interrupt, the
 * data cache, and power failing in the middle of an operation. */
#ifndef SIM_HOST_EMULATOR_G474_FLASH_MODEL_H
#define SIM_HOST_EMULATOR_G474_FLASH_MODEL_H

#include <stdbool.h>
#include <stdint.h>

enum {
    MODEL_PAGES = 4,
    MODEL_PAGE_WORDS = 256, /* of 64 bits */
    MODEL_FIRST_PAGE = 124
};

/* DS12288, "Flash memory characteristics": a page's erase takes 22.02 ms typically and 24.47 ms
 * at most, a word's programming 81.7 us and 83.35 us. The models take the longest. */
enum { MODEL_ERASE_NS = 24470000, MODEL_PROGRAM_NS = 83350 };

enum model_word_state { WORD_ERASED, WORD_WRITTEN, WORD_TORN };

struct flash_model {
    uint32_t acr, cr, sr, eccr, optr;
    uint64_t word[MODEL_PAGES][MODEL_PAGE_WORDS];
    enum model_word_state state[MODEL_PAGES][MODEL_PAGE_WORDS];
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
    uint32_t foreign_erases; /* of pages that are not the store's */
    double elapsed_ms;       /* in erases and programming, at their longest (DS12288) */
};

/* Erased pages, two banks, power on; mapped at its addresses. */
void flash_model_init(struct flash_model *model);

/* Reset with power back: registers at their reset values, contents kept. */
void flash_model_power_up(struct flash_model *model);

#endif
