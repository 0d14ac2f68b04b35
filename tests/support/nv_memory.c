#include "tests/support/nv_memory.h"

#include <string.h>

static uint32_t bank_words(void *context)
{
    (void)context;
    return NV_MEMORY_WORDS;
}

static enum nv_result read_word(void *context, uint32_t bank, uint32_t index, uint8_t *out)
{
    struct nv_memory *memory = context;

    memset(out, 0, NV_WORD_BYTES);
    if (bank >= NV_BANK_COUNT || index >= NV_MEMORY_WORDS) {
        return NV_OUT_OF_RANGE;
    }
    if (memory->corrupt[bank][index]) {
        return NV_CORRUPT;
    }
    memcpy(out, memory->words[bank][index], NV_WORD_BYTES);
    return NV_OK;
}

static const uint8_t *map(void *context, uint32_t bank)
{
    struct nv_memory *memory = context;
    return bank < NV_BANK_COUNT ? &memory->words[bank][0][0] : NULL;
}

/* True when the power fails during the operation that begins now. */
static int power_fails(struct nv_memory *memory)
{
    memory->power_is_off = memory->operations++ == memory->power_fails_at;
    return memory->power_is_off;
}

static enum nv_result erase(void *context, uint32_t bank)
{
    struct nv_memory *memory = context;

    if (memory->power_is_off) {
        return NV_FAILED;
    }
    if (power_fails(memory)) { /* half erased: every other word is in an undefined state */
        for (uint32_t i = 0; i < NV_MEMORY_WORDS; i += 2) {
            memory->corrupt[bank][i] = memory->torn == NV_TORN_CORRUPT;
            if (memory->torn == NV_TORN_GARBAGE) {
                memory->words[bank][i][i % NV_WORD_BYTES] |= 0x5A;
            } else if (memory->torn == NV_TORN_NEW) {
                memset(memory->words[bank][i], 0xFF, NV_WORD_BYTES);
            }
        }
        return NV_FAILED;
    }
    memset(memory->words[bank], 0xFF, sizeof memory->words[bank]);
    memset(memory->written[bank], 0, sizeof memory->written[bank]);
    memset(memory->corrupt[bank], 0, sizeof memory->corrupt[bank]);
    return NV_OK;
}

static void tear(struct nv_memory *memory, uint32_t bank, uint32_t index, const uint8_t *word)
{
    uint8_t *target = memory->words[bank][index];

    switch (memory->torn) {
    case NV_TORN_OLD:
        break;
    case NV_TORN_NEW:
        memcpy(target, word, NV_WORD_BYTES);
        break;
    case NV_TORN_GARBAGE:
        for (int i = 0; i < NV_WORD_BYTES; i++) {
            target[i] = (uint8_t)(word[i] | (0x11 << (i & 3)));
        }
        break;
    case NV_TORN_CORRUPT:
        memory->corrupt[bank][index] = 1;
        break;
    }
}

static enum nv_result write_word(void *context, uint32_t bank, uint32_t index, const uint8_t *word)
{
    struct nv_memory *memory = context;

    if (memory->power_is_off || memory->written[bank][index]) {
        return NV_FAILED;
    }
    memory->written[bank][index] = 1;
    if (power_fails(memory)) {
        tear(memory, bank, index, word);
        return NV_FAILED;
    }
    memcpy(memory->words[bank][index], word, NV_WORD_BYTES);
    return NV_OK;
}

static const struct nv_store_ops memory_ops = {bank_words, read_word, map, erase, write_word};

void nv_memory_init(struct nv_memory *memory)
{
    memset(memory, 0, sizeof *memory);
    memset(memory->words, 0xFF, sizeof memory->words);
    memory->power_fails_at = UINT32_MAX;
}

void nv_memory_power_up(struct nv_memory *memory)
{
    memory->power_is_off = 0;
    memory->power_fails_at = UINT32_MAX;
}

struct nv_store nv_memory_store(struct nv_memory *memory)
{
    struct nv_store store = {&memory_ops, memory};
    return store;
}
