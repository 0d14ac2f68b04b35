/* An object dictionary: constant tables of entries over plain structs of values.
 *
 * The tables are the one source of what a device can be asked: the SDO server, the
 * PDO mapping and the EDS generator read the same entries. Values live in the
 * owner's struct in their native type; numbers on the bus are little-endian
 * (CiA 301, 7.1.4.3).
 */
#ifndef HAL_CANOPEN_CO_OD_H
#define HAL_CANOPEN_CO_OD_H

#include <stddef.h>
#include <stdint.h>

/* Data types by their CiA 301 index, which is also the index of dummy mapping. */
enum co_type {
    CO_BOOLEAN = 0x01, /* uint8_t, 0 or 1 */
    CO_INTEGER8 = 0x02,
    CO_INTEGER16 = 0x03,
    CO_INTEGER32 = 0x04,
    CO_UNSIGNED8 = 0x05,
    CO_UNSIGNED16 = 0x06,
    CO_UNSIGNED32 = 0x07,
    CO_REAL32 = 0x08,         /* float */
    CO_VISIBLE_STRING = 0x09, /* char array, ends at its first 0 or its size */
    CO_DOMAIN = 0x0F,         /* struct co_domain: bytes that lie elsewhere, to be read only */
    CO_INTEGER24 = 0x10,      /* int32_t */
    CO_UNSIGNED24 = 0x16      /* uint32_t */
};

enum co_access {
    CO_READ = 1 << 0,
    CO_WRITE = 1 << 1,
    CO_CONST = 1 << 2,  /* readable, the same for ever */
    CO_MAP_TX = 1 << 3, /* may be mapped into a TPDO */
    CO_MAP_RX = 1 << 4,
    CO_ADD_NODE = 1 << 5 /* EDS: default value is $NODEID+value */
};

enum { CO_VALUE_MAX = 64 }; /* longest object but a domain, bytes */

/* The value of a CO_DOMAIN; the bytes must stay as they are while they are read. */
struct co_domain {
    const uint8_t *bytes;
    uint32_t length; /* 0: not to be had now */
};

struct co_entry {
    uint16_t index;
    uint8_t sub;
    uint8_t type;    /* enum co_type */
    uint8_t access;  /* enum co_access */
    uint8_t size;    /* bytes on the bus; of a string: of its array, <= CO_VALUE_MAX */
    uint16_t offset; /* of the value in the owner's struct */
    /* Limits of a written integer (unsigned types: of the same bits as uint32_t);
     * low > high: no limits. For REAL32: thousandths, so -1500 is -1.5. */
    int16_t low;
    int16_t high;
#ifndef CO_WITHOUT_NAMES
    const char *name; /* as the EDS shows it */
#endif
};

/* A sorted table (by index, then sub) and the struct it describes. */
struct co_dictionary {
    const struct co_entry *entries;
    uint16_t count;
    void *base;
};

/* Bytes of an integer or real type on the bus, 0 for strings, domains, unknown types. */
unsigned co_type_size(enum co_type type);

/* Finds index:sub in `count` dictionaries. Returns the entry and its struct in
 * *base, or NULL with *abort_code CO_ABORT_NO_OBJECT or CO_ABORT_NO_SUB.
 * Cost: a binary search in each dictionary whose range of indexes it is in. */
const struct co_entry *co_od_find(const struct co_dictionary *dictionaries, unsigned count,
                                  uint16_t index, uint8_t sub, void **base, uint32_t *abort_code);

/* The entry's value as bus bytes into out (CO_VALUE_MAX bytes). Returns how many.
 * Knows nothing of access rights; nothing of a domain. */
unsigned co_od_load(const struct co_entry *entry, const void *base, uint8_t *out);

/* Stores bus bytes. Returns CO_ABORT_NONE, or the abort code (length, limits) with
 * nothing changed. A string may be shorter than its array. */
uint32_t co_od_store(const struct co_entry *entry, void *base, const uint8_t *bytes,
                     unsigned length);

/* The same checks without storing. */
uint32_t co_od_check(const struct co_entry *entry, const uint8_t *bytes, unsigned length);

/* An integer's bus bytes as a sign-extended number (1..4 bytes). */
int64_t co_od_number(const struct co_entry *entry, const uint8_t *bytes);

/* For writing tables. Names are for the EDS and for people at the host; a device built
 * with CO_WITHOUT_NAMES does not carry them in its flash. */
#ifdef CO_WITHOUT_NAMES
#define CO_NAME(text)
#else
#define CO_NAME(text) , (text)
#endif
#define CO_SIZE_OF(type)                                                           \
    ((type) == CO_DOMAIN                                                       ? 0 \
     : (type) == CO_BOOLEAN || (type) == CO_INTEGER8 || (type) == CO_UNSIGNED8 ? 1 \
     : (type) == CO_INTEGER16 || (type) == CO_UNSIGNED16                       ? 2 \
     : (type) == CO_INTEGER24 || (type) == CO_UNSIGNED24                       ? 3 \
                                                                               : 4)
#define CO_OBJECT(owner, field, index, sub, type, access, low, high, name)                    \
    {                                                                                         \
        (index), (sub), (type), (access), CO_SIZE_OF(type), (uint16_t)offsetof(owner, field), \
            (low), (high)CO_NAME(name)                                                        \
    }
#define CO_ANY(owner, field, index, sub, type, access, name) \
    CO_OBJECT(owner, field, index, sub, type, access, 1, 0, name)
#define CO_STRING(owner, field, index, sub, access, name)                                  \
    {                                                                                      \
        (index), (sub), CO_VISIBLE_STRING, (access), (uint8_t)sizeof(((owner *)0)->field), \
            (uint16_t)offsetof(owner, field), 1, 0 CO_NAME(name)                           \
    }

#endif
