/* The settings' store over a memory that holds, forgets and refuses anything. */
#include "hal/storage/param_store.h"
#include "tests/proof/arbitrary.h"

static uint32_t bank_words(void *context)
{
    (void)context;
    return any_u32;
}

static enum nv_result read_word(void *context, uint32_t bank, uint32_t index, uint8_t *out)
{
    (void)context;
    (void)bank;
    (void)index;
    any_bytes(out, NV_WORD_BYTES);
    return (enum nv_result)any_int;
}

static enum nv_result erase(void *context, uint32_t bank)
{
    (void)context;
    (void)bank;
    return (enum nv_result)any_int;
}

static enum nv_result write_word(void *context, uint32_t bank, uint32_t index, const uint8_t *word)
{
    (void)context;
    (void)bank;
    (void)index;
    (void)word;
    return (enum nv_result)any_int;
}

static const uint8_t *map(void *context, uint32_t bank)
{
    (void)context;
    (void)bank;
    return NULL;
}

static void source(const void *context, uint32_t offset, uint8_t *out)
{
    (void)context;
    (void)offset;
    any_bytes(out, NV_WORD_BYTES);
}

void proof_param_store(void)
{
    static const struct nv_store_ops ops = {bank_words, read_word, map, erase, write_word};
    static struct param_store store;
    static uint8_t out[300];
    const struct nv_store nv = {&ops, NULL};
    (void)param_store_open(&store, &nv, any_u16, any_u16);
    for (;;) {
        const uint32_t length = (uint32_t)Frama_C_interval(0, sizeof out);
        (void)param_store_load(&store, any_u32, out, length);
        (void)param_store_map(&store, any_u32);
        (void)param_store_save(&store, source, NULL, any_bool());
        (void)param_store_forget(&store, any_bool());
    }
}
