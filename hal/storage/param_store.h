/* Parameters kept over power cycles: two copies, version, CRC, power-loss safe.
 *
 * One bank holds the newest copy, the other the one before. Saving erases the
 * older bank, writes the payload and, last, one commit word. Whatever happens in
 * between, at least one complete copy stays readable.
 *
 * Layout of a bank, in 64-bit words:
 *   0            commit: magic u32, CRC-32 u32 of words 1 .. n (written last)
 *   1            header: sequence u32, format version u16, payload bytes u16
 *   2 .. n       payload, padded with 0xFF
 */
#ifndef HAL_STORAGE_PARAM_STORE_H
#define HAL_STORAGE_PARAM_STORE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/storage/nv_store.h"

enum {
    PARAM_STORE_MAGIC = 0x4F464150, /* "PAFO" in memory order */
    PARAM_STORE_PART_WORDS = 64
};

enum param_store_result {
    PARAM_STORE_OK = 0,
    PARAM_STORE_EMPTY = -1,     /* load: no valid copy at all */
    PARAM_STORE_VERSION = -2,   /* load: the newest copy has another format version or size */
    PARAM_STORE_MOVING = -3,    /* save: refused, not at standstill */
    PARAM_STORE_TOO_LARGE = -4, /* save or load: payload does not fit a bank */
    PARAM_STORE_FAILED = -5,    /* save: memory refused, or the copy does not read back */
    PARAM_STORE_NOT_READ = -6   /* load: the store is not opened, param_store_attach only */
};

struct param_store {
    struct nv_store nv;
    uint16_t version;       /* format of the payload; another one is not loaded */
    uint16_t payload_bytes; /* fixed size of the payload */
    uint32_t sequence;      /* of the newest valid copy, 0 when there is none */
    uint32_t active_bank;   /* where that copy is */
    uint32_t crc;           /* its CRC-32, 0 when there is none: the identity of the set */
    bool usable;            /* that copy has the right version and size */
    /* Called between parts of saving and forgetting that each block for as long as one erase or
     * PARAM_STORE_PART_WORDS words take: the watchdog is fed there. NULL = nobody is. */
    void (*between)(void *context);
    void *between_context;
    uint32_t corrupt_words; /* words that failed error correction while looking; saturates */
};

/* Prepares a store and looks for the newest valid copy; writes nothing.
 * `nv` is copied, its context stays the caller's. Loop only; reads both banks.
 * Returns PARAM_STORE_OK, PARAM_STORE_EMPTY, PARAM_STORE_VERSION or
 * PARAM_STORE_TOO_LARGE. */
enum param_store_result param_store_open(struct param_store *store, const struct nv_store *nv,
                                         uint16_t version, uint16_t payload_bytes);

/* Prepares a store without looking at the memory: it can only be forgotten. O(1). */
void param_store_attach(struct param_store *store, const struct nv_store *nv);

/* Copies `length` bytes of the newest valid payload from `offset` on to `out`.
 * Loop only; reads the words asked for. Returns PARAM_STORE_OK, PARAM_STORE_EMPTY
 * (no copy, or a word that open could still read fails now: `out` is then not to be
 * used), PARAM_STORE_VERSION as of open, or PARAM_STORE_TOO_LARGE (beyond the payload). */
enum param_store_result param_store_load(struct param_store *store, uint32_t offset, void *out,
                                         uint32_t length);

/* Where byte `offset` of the newest valid payload lies, for data too large to copy;
 * NULL when there is no copy or the memory cannot be read in place. Stays valid until
 * the second save from now on. O(1). */
const void *param_store_map(const struct param_store *store, uint32_t offset);

/* Gives bytes `offset` .. `offset` + 7 of a payload, 0xFF beyond its end. */
typedef void (*param_store_source)(const void *context, uint32_t offset, uint8_t *out);

/* Saves the payload that `source` gives, word by word in order, as a new copy and reads
 * it back. `standstill` must be true: an
 * erase may stall the processor for tens of ms. On any error the previous copy
 * stays valid. Loop only. Returns PARAM_STORE_OK, PARAM_STORE_MOVING,
 * PARAM_STORE_TOO_LARGE or PARAM_STORE_FAILED. */
enum param_store_result param_store_save(struct param_store *store, param_store_source source,
                                         const void *context, bool standstill);

/* Erases both copies, the newest last. `standstill` as above. Returns PARAM_STORE_OK,
 * PARAM_STORE_MOVING or PARAM_STORE_FAILED (what was not erased can still be loaded). */
enum param_store_result param_store_forget(struct param_store *store, bool standstill);

#endif
