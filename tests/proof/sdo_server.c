/* The SDO server over an object dictionary with every type, under any requests in any order. */
#include "hal/canopen/co_sdo_server.h"
#include "tests/proof/arbitrary.h"

struct values {
    uint8_t truth;
    int8_t i8;
    int16_t i16;
    int32_t i32;
    uint8_t u8;
    uint16_t u16;
    uint32_t u32;
    float real;
    char text[CO_VALUE_MAX];
    struct co_domain domain;
    int32_t i24;
    uint32_t u24;
};

#define BOTH (CO_READ | CO_WRITE)
static const struct co_entry entries[] = {
    CO_OBJECT(struct values, truth, 0x2000, 1, CO_BOOLEAN, BOTH, 0, 1, "truth"),
    CO_OBJECT(struct values, i8, 0x2000, 2, CO_INTEGER8, BOTH, -5, 5, "i8"),
    CO_OBJECT(struct values, i16, 0x2000, 3, CO_INTEGER16, BOTH, -300, 300, "i16"),
    CO_ANY(struct values, i32, 0x2000, 4, CO_INTEGER32, BOTH, "i32"),
    CO_ANY(struct values, u8, 0x2001, 1, CO_UNSIGNED8, CO_WRITE, "u8"),
    CO_ANY(struct values, u16, 0x2001, 2, CO_UNSIGNED16, CO_READ, "u16"),
    CO_ANY(struct values, u32, 0x2001, 3, CO_UNSIGNED32, CO_CONST, "u32"),
    CO_OBJECT(struct values, real, 0x2001, 4, CO_REAL32, BOTH, -1500, 1500, "real"),
    CO_STRING(struct values, text, 0x2002, 0, BOTH, "text"),
    CO_ANY(struct values, domain, 0x2003, 0, CO_DOMAIN, BOTH, "domain"),
    CO_ANY(struct values, i24, 0x2004, 0, CO_INTEGER24, BOTH, "i24"),
    CO_ANY(struct values, u24, 0x2005, 0, CO_UNSIGNED24, BOTH, "u24"),
};

enum { ENTRIES = sizeof entries / sizeof entries[0] };

static struct values values;
static const uint8_t lying_elsewhere[CO_VALUE_MAX] = {1};

static uint32_t writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                        unsigned length)
{
    (void)context;
    (void)entry;
    //@ assert within_buffer: length == 0 || \valid_read(bytes + (0 .. length - 1));
    (void)bytes;
    (void)length;
    return any_u32;
}

static uint32_t begin(void *context, const struct co_entry *entry, uint32_t total)
{
    (void)context;
    (void)entry;
    (void)total;
    return any_u32;
}

static uint32_t take(void *context, const struct co_entry *entry, const uint8_t *bytes,
                     unsigned length, bool last)
{
    (void)context;
    (void)entry;
    //@ assert within_frame: length == 0 || \valid_read(bytes + (0 .. length - 1));
    (void)bytes;
    (void)length;
    (void)last;
    return any_u32;
}

/* Requests to a dictionary that has one object: object and transfer stay paired. */
static void serve(const struct co_entry *entry)
{
    static const struct co_access_hooks hooks = {.writing = writing, .begin = begin, .take = take};
    static struct co_sdo_server server;
    static struct co_dictionary dictionary;
    dictionary = (struct co_dictionary){entry, 1, &values};
    co_sdo_server_init(&server, &dictionary, 1, &hooks, NULL);
    values.domain = (struct co_domain){lying_elsewhere, sizeof lying_elsewhere};
    //@ loop widen_hints server.position, 64; loop widen_hints server.length, 64;
    while (any_bool()) {
        uint8_t request[8], answer[8];
        any_bytes(request, sizeof request);
        (void)co_sdo_server_handle(&server, request, any_u64, answer);
        if (any_bool()) {
            co_sdo_server_reset(&server);
        }
    }
}

/* The search in the whole table. */
static void search(void)
{
    const struct co_dictionary dictionary = {entries, ENTRIES, &values};
    void *base;
    uint32_t code;
    const struct co_entry *found = co_od_find(&dictionary, 1, any_u16, any_u8, &base, &code);
    //@ assert of_table: found == \null || \valid_read(found);
}

void proof_sdo_server(void)
{
    search();
    //@ loop unroll ENTRIES;
    for (unsigned i = 0; i < ENTRIES; i++) {
        serve(&entries[i]);
    }
}
