/* Non-volatile memory as the parameter store sees it: banks that are erased as
 * a whole and then written once, word by word, in 64-bit words.
 *
 * That is what flash with error correction allows: a word may be written once
 * after an erase, and a word whose writing was cut short by a power failure may
 * read as its old value, its new value, anything else, or as an error.
 */
#ifndef HAL_STORAGE_NV_STORE_H
#define HAL_STORAGE_NV_STORE_H

#include <stdint.h>

enum { NV_WORD_BYTES = 8, NV_BANK_COUNT = 2 };

enum nv_result {
    NV_OK = 0,
    NV_CORRUPT = -1,     /* read: the memory's error correction gave up */
    NV_FAILED = -2,      /* erase or write: refused or timed out */
    NV_OUT_OF_RANGE = -3 /* no such bank or word */
};

struct nv_store_ops {
    /* Words of NV_WORD_BYTES in one bank. Constant; O(1). */
    uint32_t (*bank_words)(void *context);

    /* Reads word `index` of `bank` into the 8 bytes at `out`; on NV_CORRUPT they
     * are 0. Loop only. Returns NV_OK, NV_CORRUPT or NV_OUT_OF_RANGE. */
    enum nv_result (*read_word)(void *context, uint32_t bank, uint32_t index, uint8_t *out);

    /* Where `bank` can be read in place, as long as it is not erased; NULL when it
     * cannot. Words that failed read_word must not be touched. O(1). */
    const uint8_t *(*map)(void *context, uint32_t bank);

    /* Erases a whole bank to 0xFF. May stall the caller for tens of ms: only at
     * standstill. Returns NV_OK, NV_FAILED or NV_OUT_OF_RANGE. */
    enum nv_result (*erase)(void *context, uint32_t bank);

    /* Writes an erased word once, from the 8 bytes at `word`. Blocks below 1 ms.
     * Returns NV_OK, NV_FAILED or NV_OUT_OF_RANGE. */
    enum nv_result (*write_word)(void *context, uint32_t bank, uint32_t index, const uint8_t *word);
};

struct nv_store {
    const struct nv_store_ops *ops;
    void *context;
};

#endif
