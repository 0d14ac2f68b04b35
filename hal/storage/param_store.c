#include "hal/storage/param_store.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/storage/crc.h"

enum { COMMIT_WORD = 0, HEADER_WORD = 1, PAYLOAD_WORD = 2 };

struct bank_header {
    uint32_t sequence;
    uint32_t crc;
    uint16_t version;
    uint16_t payload_bytes;
};

static uint32_t words_of(uint32_t payload_bytes)
{
    return (payload_bytes + NV_WORD_BYTES - 1U) / NV_WORD_BYTES;
}

static bool read_word(struct param_store *store, uint32_t bank, uint32_t index, uint8_t *out)
{
    enum nv_result result = store->nv.ops->read_word(store->nv.context, bank, index, out);

    if (result == NV_CORRUPT && store->corrupt_words < UINT32_MAX) {
        store->corrupt_words++;
    }
    return result == NV_OK;
}

/* True when the bank holds a complete copy; then *header is filled in. */
static bool bank_is_valid(struct param_store *store, uint32_t bank, struct bank_header *header)
{
    uint8_t word[NV_WORD_BYTES];
    uint32_t words, crc;

    if (!read_word(store, bank, COMMIT_WORD, word) || bytes_get_u32(word) != PARAM_STORE_MAGIC) {
        return false;
    }
    header->crc = bytes_get_u32(word + 4);
    if (!read_word(store, bank, HEADER_WORD, word)) {
        return false;
    }
    header->sequence = bytes_get_u32(word);
    header->version = (uint16_t)(word[4] | ((uint32_t)word[5] << 8));
    header->payload_bytes = (uint16_t)(word[6] | ((uint32_t)word[7] << 8));
    words = words_of(header->payload_bytes);
    if (words > store->nv.ops->bank_words(store->nv.context) - PAYLOAD_WORD) {
        return false;
    }
    crc = crc32_update(CRC32_INIT, word, sizeof word);
    for (uint32_t i = 0; i < words; i++) {
        if (!read_word(store, bank, PAYLOAD_WORD + i, word)) {
            return false;
        }
        crc = crc32_update(crc, word, sizeof word);
    }
    return crc == header->crc;
}

/* Serial-number arithmetic, so that a wrapped sequence still counts as newer. */
static bool is_newer(uint32_t a, uint32_t b)
{
    return a != b && (a - b) < 0x80000000U;
}

void param_store_attach(struct param_store *store, const struct nv_store *nv)
{
    memset(store, 0, sizeof *store);
    store->nv = *nv;
}

enum param_store_result param_store_open(struct param_store *store, const struct nv_store *nv,
                                         uint16_t version, uint16_t payload_bytes)
{
    bool found = false;
    struct bank_header best = {0};

    param_store_attach(store, nv);
    store->version = version;
    store->payload_bytes = payload_bytes;
    if (words_of(payload_bytes) + PAYLOAD_WORD > nv->ops->bank_words(nv->context)) {
        return PARAM_STORE_TOO_LARGE;
    }
    for (uint32_t bank = 0; bank < NV_BANK_COUNT; bank++) {
        struct bank_header header = {0};
        if (bank_is_valid(store, bank, &header) &&
            (!found || is_newer(header.sequence, best.sequence))) {
            found = true;
            best = header;
            store->active_bank = bank;
        }
    }
    if (!found) {
        return PARAM_STORE_EMPTY;
    }
    store->sequence = best.sequence;
    store->crc = best.crc;
    if (best.version != version || best.payload_bytes != payload_bytes) {
        return PARAM_STORE_VERSION;
    }
    store->usable = true;
    return PARAM_STORE_OK;
}

enum param_store_result param_store_load(struct param_store *store, uint32_t offset, void *out,
                                         uint32_t length)
{
    uint8_t word[NV_WORD_BYTES];
    uint8_t *bytes = out;

    if (!store->usable) {
        return store->sequence == 0U && store->crc == 0U ? PARAM_STORE_EMPTY : PARAM_STORE_VERSION;
    }
    if (offset > store->payload_bytes || length > store->payload_bytes - offset) {
        return PARAM_STORE_TOO_LARGE;
    }
    for (uint32_t i = 0; i < length; i++, offset++) {
        if ((i == 0U || offset % NV_WORD_BYTES == 0U) &&
            !read_word(store, store->active_bank, PAYLOAD_WORD + offset / NV_WORD_BYTES, word)) {
            return PARAM_STORE_EMPTY;
        }
        bytes[i] = word[offset % NV_WORD_BYTES];
    }
    return PARAM_STORE_OK;
}

const void *param_store_map(const struct param_store *store, uint32_t offset)
{
    const uint8_t *bank = store->usable && offset < store->payload_bytes
                              ? store->nv.ops->map(store->nv.context, store->active_bank)
                              : NULL;

    return bank != NULL ? bank + PAYLOAD_WORD * NV_WORD_BYTES + offset : NULL;
}

static void pause_between_parts(const struct param_store *store)
{
    if (store->between != NULL) {
        store->between(store->between_context);
    }
}

static enum nv_result erase(const struct param_store *store, uint32_t bank)
{
    pause_between_parts(store);
    const enum nv_result result = store->nv.ops->erase(store->nv.context, bank);
    pause_between_parts(store);
    return result;
}

/* Writes header and payload of a new copy; returns its CRC in *crc. */
static bool write_copy(struct param_store *store, uint32_t bank, uint32_t sequence,
                       param_store_source source, const void *context, uint32_t *crc)
{
    const struct nv_store *nv = &store->nv;
    uint8_t word[NV_WORD_BYTES];

    bytes_put_u32(word, sequence);
    bytes_put_u32(word + 4, (uint32_t)store->version | ((uint32_t)store->payload_bytes << 16));
    *crc = crc32_update(CRC32_INIT, word, sizeof word);
    if (nv->ops->write_word(nv->context, bank, HEADER_WORD, word) != NV_OK) {
        return false;
    }
    for (uint32_t i = 0; i < words_of(store->payload_bytes); i++) {
        if (i % (uint32_t)PARAM_STORE_PART_WORDS == 0U) {
            pause_between_parts(store);
        }
        source(context, i * NV_WORD_BYTES, word);
        *crc = crc32_update(*crc, word, sizeof word);
        if (nv->ops->write_word(nv->context, bank, PAYLOAD_WORD + i, word) != NV_OK) {
            return false;
        }
    }
    return true;
}

enum param_store_result param_store_save(struct param_store *store, param_store_source source,
                                         const void *context, bool standstill)
{
    const struct nv_store *nv = &store->nv;
    bool has_copy = store->crc != 0U || store->sequence != 0U;
    uint32_t bank = has_copy ? store->active_bank ^ 1U : 0U;
    uint32_t sequence = store->sequence + 1U;
    struct bank_header header = {0};
    uint8_t word[NV_WORD_BYTES];
    uint32_t crc;

    if (!standstill) {
        return PARAM_STORE_MOVING;
    }
    if (words_of(store->payload_bytes) + PAYLOAD_WORD > nv->ops->bank_words(nv->context)) {
        return PARAM_STORE_TOO_LARGE;
    }
    if (erase(store, bank) != NV_OK || !write_copy(store, bank, sequence, source, context, &crc)) {
        return PARAM_STORE_FAILED;
    }
    bytes_put_u32(word, PARAM_STORE_MAGIC);
    bytes_put_u32(word + 4, crc);
    if (nv->ops->write_word(nv->context, bank, COMMIT_WORD, word) != NV_OK ||
        !bank_is_valid(store, bank, &header) || header.crc != crc) {
        return PARAM_STORE_FAILED;
    }
    store->active_bank = bank;
    store->sequence = sequence;
    store->crc = crc;
    store->usable = true;
    return PARAM_STORE_OK;
}

enum param_store_result param_store_forget(struct param_store *store, bool standstill)
{
    if (!standstill) {
        return PARAM_STORE_MOVING;
    }
    if (erase(store, store->active_bank ^ 1U) != NV_OK ||
        erase(store, store->active_bank) != NV_OK) {
        return PARAM_STORE_FAILED;
    }
    store->sequence = store->crc = 0;
    store->usable = false;
    return PARAM_STORE_OK;
}
