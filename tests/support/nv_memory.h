/* A flash memory to test against: erased as a whole, each word written once,
 * power cut at a chosen operation, cut words reading as chosen. */
#ifndef TESTS_SUPPORT_NV_MEMORY_H
#define TESTS_SUPPORT_NV_MEMORY_H

#include <stdint.h>

#include "hal/storage/nv_store.h"

enum { NV_MEMORY_WORDS = 512 };

/* What a word reads as whose writing the power failure cut short. */
enum nv_memory_torn {
    NV_TORN_OLD,     /* as if never written */
    NV_TORN_NEW,     /* as if written */
    NV_TORN_GARBAGE, /* some bits of each, and no error is seen */
    NV_TORN_CORRUPT  /* the error correction gives up */
};

struct nv_memory {
    uint8_t words[NV_BANK_COUNT][NV_MEMORY_WORDS][NV_WORD_BYTES];
    uint8_t written[NV_BANK_COUNT][NV_MEMORY_WORDS];
    uint8_t corrupt[NV_BANK_COUNT][NV_MEMORY_WORDS];
    uint32_t operations;     /* erases and writes so far */
    uint32_t power_fails_at; /* number of the operation that is cut; UINT32_MAX = never */
    int power_is_off;        /* everything fails until nv_memory_power_up */
    enum nv_memory_torn torn;
};

/* An erased memory with lasting power. */
void nv_memory_init(struct nv_memory *memory);

/* Power is back, for good. */
void nv_memory_power_up(struct nv_memory *memory);

/* The memory as the store sees it. */
struct nv_store nv_memory_store(struct nv_memory *memory);

#endif
