/* The parameter store on a flash model whose power fails at every operation. */
#include "hal/storage/param_store.h"

#include <string.h>

#include "tests/support/assert_close.h"
#include "tests/support/nv_memory.h"

enum { VERSION = 3 };

struct payload {
    uint32_t serial;
    uint8_t bytes[57]; /* an odd size: the last word is padded */
};

static struct nv_memory memory;
static struct nv_store nv;
static struct param_store store;

static void setup(void)
{
    nv_memory_init(&memory);
    nv = nv_memory_store(&memory);
}

static struct payload make_payload(uint32_t serial)
{
    struct payload payload;

    memset(&payload, 0, sizeof payload);
    payload.serial = serial;
    for (size_t i = 0; i < sizeof payload.bytes; i++) {
        payload.bytes[i] = (uint8_t)(serial * 31U + i);
    }
    return payload;
}

/* Bytes of a payload as the store asks for them. */
static void source(const void *context, uint32_t offset, uint8_t *out)
{
    for (uint32_t i = 0; i < NV_WORD_BYTES; i++, offset++) {
        out[i] = offset < sizeof(struct payload) ? ((const uint8_t *)context)[offset] : 0xFF;
    }
}

static enum param_store_result save_payload(const struct payload *payload, bool standstill)
{
    return param_store_save(&store, source, payload, standstill);
}

static enum param_store_result load_payload(struct payload *payload)
{
    return param_store_load(&store, 0, payload, sizeof *payload);
}

static enum param_store_result open_store(void)
{
    return param_store_open(&store, &nv, VERSION, sizeof(struct payload));
}

static void save(uint32_t serial)
{
    struct payload payload = make_payload(serial);
    ck_assert_int_eq(save_payload(&payload, true), PARAM_STORE_OK);
}

static void assert_holds(uint32_t serial)
{
    struct payload got, want = make_payload(serial);
    ck_assert_int_eq(open_store(), PARAM_STORE_OK);
    ck_assert_int_eq(load_payload(&got), PARAM_STORE_OK);
    ck_assert_mem_eq(&got, &want, sizeof got);
}

START_TEST(an_erased_memory_is_empty)
{
    struct payload payload = make_payload(9), before = payload;

    ck_assert_int_eq(open_store(), PARAM_STORE_EMPTY);
    ck_assert_int_eq(load_payload(&payload), PARAM_STORE_EMPTY);
    ck_assert_mem_eq(&payload, &before, sizeof payload);
}
END_TEST

START_TEST(the_newest_of_many_saves_is_loaded)
{
    ck_assert_int_eq(open_store(), PARAM_STORE_EMPTY);
    for (uint32_t serial = 1; serial <= 20; serial++) {
        save(serial);
        assert_holds(serial);
    }
}
END_TEST

START_TEST(saving_is_refused_while_moving)
{
    struct payload payload = make_payload(2);

    ck_assert_int_eq(open_store(), PARAM_STORE_EMPTY);
    save(1);
    uint32_t operations = memory.operations;
    ck_assert_int_eq(save_payload(&payload, false), PARAM_STORE_MOVING);
    ck_assert_uint_eq(memory.operations, operations);
    assert_holds(1);
}
END_TEST

START_TEST(another_version_or_size_is_not_loaded_but_can_be_replaced)
{
    struct payload payload = make_payload(1);

    open_store();
    save(1);
    ck_assert_int_eq(param_store_open(&store, &nv, VERSION + 1, sizeof payload),
                     PARAM_STORE_VERSION);
    ck_assert_int_eq(load_payload(&payload), PARAM_STORE_VERSION);
    ck_assert_int_eq(param_store_open(&store, &nv, VERSION, sizeof payload - 1),
                     PARAM_STORE_VERSION);
    ck_assert_int_eq(param_store_open(&store, &nv, VERSION + 1, sizeof payload),
                     PARAM_STORE_VERSION);
    ck_assert_int_eq(save_payload(&payload, true), PARAM_STORE_OK);
    ck_assert_int_eq(param_store_open(&store, &nv, VERSION + 1, sizeof payload), PARAM_STORE_OK);
}
END_TEST

START_TEST(a_payload_that_does_not_fit_is_refused)
{
    uint16_t too_large = (NV_MEMORY_WORDS - 2) * NV_WORD_BYTES + 1;

    ck_assert_int_eq(param_store_open(&store, &nv, VERSION, too_large), PARAM_STORE_TOO_LARGE);
    ck_assert_int_eq(param_store_open(&store, &nv, VERSION, (uint16_t)(too_large - 1)),
                     PARAM_STORE_EMPTY);
}
END_TEST

START_TEST(the_sequence_may_wrap)
{
    open_store();
    store.sequence = UINT32_MAX - 1U;
    store.crc = 1; /* as if a copy with that number were there */
    save(1);       /* number UINT32_MAX */
    save(2);       /* number 0 */
    assert_holds(2);
    save(3);
    assert_holds(3);
}
END_TEST

/* Number 0 is a number like the others: a copy of it is not taken for an empty memory. */
START_TEST(a_wrapped_copy_of_another_version_is_not_an_empty_memory)
{
    struct payload payload = make_payload(1);

    open_store();
    store.sequence = UINT32_MAX;
    save(1); /* number 0 */
    ck_assert_int_eq(param_store_open(&store, &nv, VERSION + 1, sizeof payload),
                     PARAM_STORE_VERSION);
    ck_assert_uint_eq(store.sequence, 0);
    ck_assert_int_eq(load_payload(&payload), PARAM_STORE_VERSION);
}
END_TEST

/* A checksum of 0 is a checksum like the others: the copy it belongs to is not written over. */
START_TEST(a_copy_whose_checksum_is_0_is_kept)
{
    struct payload payload = make_payload(3);

    open_store();
    save(1);
    save(2);
    const uint32_t bank = store.active_bank;
    store.crc = 0;
    memory.torn = NV_TORN_OLD;
    memory.power_fails_at = memory.operations + 3;
    ck_assert_int_eq(save_payload(&payload, true), PARAM_STORE_FAILED);
    nv_memory_power_up(&memory);
    assert_holds(2);
    ck_assert_uint_eq(store.active_bank, bank);
}
END_TEST

/* The same copy twice, as when one bank was made from the other: either will do. */
START_TEST(two_copies_of_one_number_are_one)
{
    open_store();
    save(1);
    memcpy(memory.words[1], memory.words[0], sizeof memory.words[0]);
    assert_holds(1);
    save(2);
    assert_holds(2);
    save(3);
    assert_holds(3);
}
END_TEST

START_TEST(what_does_not_fit_is_not_begun)
{
    struct payload payload = make_payload(1);

    open_store();
    save(1);
    const uint32_t operations = memory.operations;
    ck_assert_int_eq(param_store_open(&store, &nv, VERSION, UINT16_MAX), PARAM_STORE_TOO_LARGE);
    ck_assert_int_eq(save_payload(&payload, true), PARAM_STORE_TOO_LARGE);
    ck_assert_uint_eq(memory.operations, operations);
    assert_holds(1);
}
END_TEST

static struct nv_store_ops deaf_ops; /* a write-protected memory: all goes well, nothing changes */

static enum nv_result erase_nothing(void *context, uint32_t bank)
{
    (void)context;
    (void)bank;
    return NV_OK;
}

static enum nv_result write_nothing(void *context, uint32_t bank, uint32_t index,
                                    const uint8_t *word)
{
    (void)context;
    (void)bank;
    (void)index;
    (void)word;
    return NV_OK;
}

/* It reads back whole, but it is an old copy: that is no success. */
START_TEST(a_memory_that_keeps_its_old_copy_is_noticed)
{
    struct payload payload = make_payload(3);

    open_store();
    save(1);
    save(2);
    deaf_ops = *nv.ops;
    deaf_ops.erase = erase_nothing;
    deaf_ops.write_word = write_nothing;
    store.nv.ops = &deaf_ops;
    ck_assert_int_eq(save_payload(&payload, true), PARAM_STORE_FAILED);
    ck_assert_uint_eq(store.sequence, 2);
    assert_holds(2);
}
END_TEST

/* One save: erase, header, 8 payload words of 61 bytes, commit. */
enum { OPERATIONS_OF_A_SAVE = 1 + 1 + 8 + 1 };

START_TEST(power_may_fail_at_any_operation)
{
    enum nv_memory_torn torn = (enum nv_memory_torn)(_i % 4);
    uint32_t cut = (uint32_t)_i / 4U;
    struct payload payload = make_payload(3), got;

    open_store();
    save(1);
    save(2);
    memory.torn = torn;
    memory.power_fails_at = memory.operations + cut;
    ck_assert_int_eq(save_payload(&payload, true), PARAM_STORE_FAILED);
    nv_memory_power_up(&memory);

    ck_assert_int_eq(open_store(), PARAM_STORE_OK);
    ck_assert_int_eq(load_payload(&got), PARAM_STORE_OK);
    /* The new copy may count only if its last word was complete. */
    if (got.serial == 3) {
        ck_assert_uint_eq(cut, OPERATIONS_OF_A_SAVE - 1);
        ck_assert_int_eq(torn, NV_TORN_NEW);
        ck_assert_mem_eq(&got, &payload, sizeof got);
    } else {
        payload = make_payload(2);
        ck_assert_mem_eq(&got, &payload, sizeof got);
    }
    if (torn == NV_TORN_CORRUPT && cut == OPERATIONS_OF_A_SAVE - 1) {
        ck_assert_uint_gt(store.corrupt_words, 0);
    }
    save(4); /* and the store works on */
    assert_holds(4);
}
END_TEST

START_TEST(power_may_fail_during_the_very_first_save)
{
    enum nv_memory_torn torn = (enum nv_memory_torn)(_i % 4);
    struct payload payload = make_payload(1);

    open_store();
    memory.torn = torn;
    memory.power_fails_at = (uint32_t)_i / 4U;
    ck_assert_int_eq(save_payload(&payload, true), PARAM_STORE_FAILED);
    nv_memory_power_up(&memory);
    if (open_store() == PARAM_STORE_OK) {
        ck_assert_int_eq(torn, NV_TORN_NEW);
        ck_assert_int_eq(_i / 4, OPERATIONS_OF_A_SAVE - 1);
    }
    save(5);
    assert_holds(5);
}
END_TEST

START_TEST(one_flipped_bit_anywhere_falls_back_to_the_other_copy)
{
    open_store();
    save(1);
    save(2);
    uint32_t bank = store.active_bank;
    for (uint32_t word = 0; word < OPERATIONS_OF_A_SAVE - 1; word++) {
        for (int bit = 0; bit < 8 * NV_WORD_BYTES; bit++) {
            uint8_t *byte = &memory.words[bank][word][bit / 8];
            *byte = (uint8_t)(*byte ^ (1 << (bit % 8)));
            assert_holds(1);
            *byte = (uint8_t)(*byte ^ (1 << (bit % 8)));
        }
    }
    assert_holds(2);
}
END_TEST

START_TEST(parts_are_loaded_and_found_in_place)
{
    struct payload payload = make_payload(1);
    uint8_t part[sizeof payload];

    open_store();
    ck_assert_ptr_null(param_store_map(&store, 0));
    save(1);
    for (uint32_t from = 0; from <= sizeof payload; from++) {
        for (uint32_t length = 0; from + length <= sizeof payload; length += 5) {
            ck_assert_int_eq(param_store_load(&store, from, part, length), PARAM_STORE_OK);
            ck_assert_mem_eq(part, (const uint8_t *)&payload + from, length);
        }
    }
    ck_assert_int_eq(param_store_load(&store, 1, part, sizeof payload), PARAM_STORE_TOO_LARGE);
    ck_assert_int_eq(param_store_load(&store, UINT32_MAX, part, 2), PARAM_STORE_TOO_LARGE);
    ck_assert_mem_eq(param_store_map(&store, 7), (const uint8_t *)&payload + 7, sizeof payload - 7);
    ck_assert_ptr_null(param_store_map(&store, sizeof payload));
}
END_TEST

START_TEST(the_crc_names_the_set)
{
    open_store();
    ck_assert_uint_eq(store.crc, 0);
    save(1);
    uint32_t first = store.crc;
    save(2);
    ck_assert_uint_ne(store.crc, first);
    uint32_t second = store.crc;
    open_store();
    ck_assert_uint_eq(store.crc, second);
}
END_TEST

/* A word that the error correction gives up (RM0440: ECCD) spoils its copy, wherever it is. */
START_TEST(one_corrupt_word_anywhere_falls_back_to_the_other_copy)
{
    open_store();
    save(1);
    save(2);
    const uint32_t bank = store.active_bank;
    for (uint32_t word = 0; word < OPERATIONS_OF_A_SAVE - 1; word++) {
        memory.corrupt[bank][word] = 1;
        assert_holds(1);
        ck_assert_uint_gt(store.corrupt_words, 0);
        memory.corrupt[bank][word] = 0;
    }
    assert_holds(2);
}
END_TEST

/* Gone bad after it was found good: it is not loaded, and the count stays at its end. */
START_TEST(a_word_that_goes_bad_later_is_not_loaded)
{
    struct payload payload;

    open_store();
    save(1);
    memory.corrupt[store.active_bank][2] = 1; /* the first behind commit and header */
    store.corrupt_words = UINT32_MAX;
    ck_assert_int_eq(load_payload(&payload), PARAM_STORE_EMPTY);
    ck_assert_uint_eq(store.corrupt_words, UINT32_MAX);
}
END_TEST

START_TEST(settings_are_forgotten_at_standstill_only_and_wholly)
{
    open_store();
    save(1);
    save(2);
    ck_assert_int_eq(param_store_forget(&store, false), PARAM_STORE_MOVING);
    assert_holds(2);
    for (uint32_t cut = 0; cut < 2; cut++) {
        memory.torn = NV_TORN_OLD;
        memory.power_fails_at = memory.operations + cut;
        ck_assert_int_eq(param_store_forget(&store, true), PARAM_STORE_FAILED);
        nv_memory_power_up(&memory);
        assert_holds(2); /* the newest goes last: no older one comes back */
    }
    ck_assert_int_eq(param_store_forget(&store, true), PARAM_STORE_OK);
    ck_assert_int_eq(open_store(), PARAM_STORE_EMPTY);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("param_store");
    TCase *tcase = tcase_create("param_store");

    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, an_erased_memory_is_empty);
    tcase_add_test(tcase, the_newest_of_many_saves_is_loaded);
    tcase_add_test(tcase, saving_is_refused_while_moving);
    tcase_add_test(tcase, another_version_or_size_is_not_loaded_but_can_be_replaced);
    tcase_add_test(tcase, a_payload_that_does_not_fit_is_refused);
    tcase_add_test(tcase, the_sequence_may_wrap);
    tcase_add_loop_test(tcase, power_may_fail_at_any_operation, 0, 4 * OPERATIONS_OF_A_SAVE);
    tcase_add_loop_test(tcase, power_may_fail_during_the_very_first_save, 0,
                        4 * OPERATIONS_OF_A_SAVE);
    tcase_add_test(tcase, one_flipped_bit_anywhere_falls_back_to_the_other_copy);
    tcase_add_test(tcase, one_corrupt_word_anywhere_falls_back_to_the_other_copy);
    tcase_add_test(tcase, a_word_that_goes_bad_later_is_not_loaded);
    tcase_add_test(tcase, settings_are_forgotten_at_standstill_only_and_wholly);
    tcase_add_test(tcase, parts_are_loaded_and_found_in_place);
    tcase_add_test(tcase, a_wrapped_copy_of_another_version_is_not_an_empty_memory);
    tcase_add_test(tcase, a_copy_whose_checksum_is_0_is_kept);
    tcase_add_test(tcase, two_copies_of_one_number_are_one);
    tcase_add_test(tcase, what_does_not_fit_is_not_begun);
    tcase_add_test(tcase, a_memory_that_keeps_its_old_copy_is_noticed);
    tcase_add_test(tcase, the_crc_names_the_set);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
