/* The flash driver against the model of the peripheral, and the parameter store
 * on top of it with the power failing at every erase and every word. */
#include "hal/port_stm32g474/flash_store.h"

#include <math.h>
#include <string.h>

#include "hal/storage/param_store.h"
#include "sim_host/emulator/g474/flash_model.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "tests/support/assert_close.h"

static struct flash_model model;
static struct flash_store flash;
static struct nv_store nv;
static int fatal_nmis;

/* What the board's handler does. */
static void nmi_handler(void *context)
{
    if (!flash_store_survives_nmi(context)) {
        fatal_nmis++;
        model.eccr = 0;
    }
}

static void setup(void)
{
    mmio_model_reset();
    flash_model_init(&model);
    flash_store_init(&flash);
    model.nmi = nmi_handler;
    model.nmi_context = &flash;
    nv = flash_store_interface(&flash);
    fatal_nmis = 0;
}

static void teardown(void)
{
    ck_assert_int_eq(mmio_model_locked(), 0);
    ck_assert_uint_eq(model.foreign_erases, 0);
    ck_assert_int_ge(model.keys, 0);
    ck_assert_int_eq(fatal_nmis, 0);
}

static enum nv_result write_word(uint32_t bank, uint32_t index, uint8_t seed)
{
    uint8_t word[NV_WORD_BYTES];

    for (uint8_t i = 0; i < NV_WORD_BYTES; i++) {
        word[i] = (uint8_t)(seed + i);
    }
    return nv.ops->write_word(nv.context, bank, index, word);
}

static void assert_word(uint32_t bank, uint32_t index, int seed)
{
    uint8_t word[NV_WORD_BYTES];

    ck_assert_int_eq(nv.ops->read_word(nv.context, bank, index, word), NV_OK);
    for (int i = 0; i < NV_WORD_BYTES; i++) {
        ck_assert_uint_eq(word[i], seed < 0 ? 0xFFu : (uint8_t)(seed + i));
    }
}

START_TEST(words_are_written_read_and_erased_bank_by_bank)
{
    uint32_t last = nv.ops->bank_words(nv.context) - 1;

    ck_assert_uint_eq(last, 511);
    assert_word(0, 0, -1); /* now it is in the cache */
    ck_assert_int_eq(write_word(0, 0, 1), NV_OK);
    ck_assert_int_eq(write_word(0, last, 2), NV_OK);
    ck_assert_int_eq(write_word(1, 0, 3), NV_OK);
    assert_word(0, 0, 1);
    assert_word(0, last, 2);
    assert_word(1, 0, 3);
    ck_assert_int_eq(nv.ops->erase(nv.context, 0), NV_OK);
    assert_word(0, 0, -1);
    assert_word(0, last, -1);
    assert_word(1, 0, 3);
    ck_assert_uint_eq(model.word[MODEL_STORE_PAGE + 2][0], 0x0A09080706050403u);
    ck_assert_msg((model.cr & 0x80000000u) != 0, "left unlocked");
    ck_assert_uint_eq(model.cr & 0xFFFu, 0);
    ck_assert_uint_eq(model.acr, 0x00040601u);
}
END_TEST

START_TEST(what_does_not_exist_is_out_of_range)
{
    uint8_t word[NV_WORD_BYTES] = {0};

    ck_assert_int_eq(nv.ops->read_word(nv.context, 2, 0, word), NV_OUT_OF_RANGE);
    ck_assert_int_eq(nv.ops->read_word(nv.context, 0, 512, word), NV_OUT_OF_RANGE);
    ck_assert_int_eq(nv.ops->write_word(nv.context, 1, 512, word), NV_OUT_OF_RANGE);
    ck_assert_int_eq(nv.ops->erase(nv.context, 2), NV_OUT_OF_RANGE);
    ck_assert_uint_eq(model.operations, 0);
}
END_TEST

START_TEST(a_word_is_written_once)
{
    ck_assert_int_eq(write_word(0, 5, 1), NV_OK);
    ck_assert_int_eq(write_word(0, 5, 2), NV_FAILED);
    assert_word(0, 5, 1);
    ck_assert_uint_eq(flash.failures, 1);
    ck_assert_int_eq(write_word(0, 6, 2), NV_OK); /* the old error does not stick */
}
END_TEST

START_TEST(an_old_error_does_not_block_an_erase)
{
    model.sr = 0x88; /* somebody's PROGERR and PGSERR */
    ck_assert_int_eq(nv.ops->erase(nv.context, 1), NV_OK);
    model.sr = 0x88;
    ck_assert_int_eq(write_word(1, 0, 1), NV_OK);
}
END_TEST

START_TEST(with_one_bank_nothing_is_touched)
{
    model.optr &= ~(1u << 22);
    ck_assert_int_eq(nv.ops->erase(nv.context, 0), NV_FAILED);
    ck_assert_int_eq(write_word(0, 0, 1), NV_FAILED);
    ck_assert_uint_eq(model.operations, 0);
}
END_TEST

START_TEST(a_flash_that_stays_busy_is_given_up)
{
    model.busy = UINT32_MAX;
    ck_assert_int_eq(write_word(0, 0, 1), NV_FAILED);
    ck_assert_uint_eq(model.operations, 0);
}
END_TEST

/* The bound in polls is one in time: half as long again as the longest erase at the fastest
 * clock, 4 cycles a poll. */
START_TEST(the_longest_erase_is_waited_for)
{
    ck_assert_double_ge(4.0 * FLASH_STORE_POLLS / 170e6, 1.5e-9 * MODEL_ERASE_NS);
    model.busy_time = FLASH_STORE_POLLS - 1;
    ck_assert_int_eq(write_word(0, 0, 1), NV_OK);
}
END_TEST

/* What goes on may still read flash meanwhile: the data cache stays off until it is over. */
START_TEST(an_operation_that_does_not_end_leaves_the_data_cache_off)
{
    model.busy_time = UINT32_MAX;
    ck_assert_int_eq(write_word(0, 0, 1), NV_FAILED);
    ck_assert_uint_eq(model.acr & (1u << 10), 0);
    model.busy = 0;
    model.busy_time = 20;
    ck_assert_int_eq(write_word(0, 1, 1), NV_OK);
    ck_assert_uint_eq(model.acr, 0x00040601u);
}
END_TEST

START_TEST(a_locked_interface_fails)
{
    model.keys = -1;
    ck_assert_int_eq(write_word(0, 0, 1), NV_FAILED);
    ck_assert_int_eq(nv.ops->erase(nv.context, 0), NV_FAILED);
    model.keys = 0; /* for teardown */
}
END_TEST

static void read_torn(uint8_t *word)
{
    model.power_fails_at = model.operations;
    write_word(0, 9, 1);
    flash_model_power_up(&model);
    ck_assert_int_eq(nv.ops->read_word(nv.context, 0, 9, word), NV_CORRUPT);
}

START_TEST(a_torn_word_reads_as_corrupt_and_the_nmi_is_survived)
{
    uint8_t word[NV_WORD_BYTES], zero[NV_WORD_BYTES] = {0};

    read_torn(word);
    ck_assert_mem_eq(word, zero, sizeof word);
    ck_assert_uint_eq(model.eccr, 0);
    assert_word(0, 10, -1); /* and the next word is fine */
}
END_TEST

START_TEST(the_driver_notices_even_when_no_nmi_comes)
{
    uint8_t word[NV_WORD_BYTES];

    model.nmi = NULL;
    read_torn(word);
    ck_assert_uint_eq(model.eccr, 0);
}
END_TEST

START_TEST(an_error_that_is_not_the_stores_is_not_survived)
{
    ck_assert(!flash_store_survives_nmi(&flash));
    model.eccr = 0x80000000u; /* somebody read a bad word of the program */
    ck_assert(!flash_store_survives_nmi(&flash));
    ck_assert_uint_eq(model.eccr, 0x80000000u);
    flash.reading = true;
    model.eccr = 0;
    ck_assert(!flash_store_survives_nmi(&flash)); /* another NMI during a read */
}
END_TEST

/* ---- The parameter store on top ------------------------------------------------ */

struct payload {
    uint8_t bytes[100];
};

enum { OPERATIONS_OF_A_SAVE = 2 + 1 + 13 + 1 /* erases, header, payload, commit */ };

static void source(const void *context, uint32_t offset, uint8_t *out)
{
    for (uint32_t i = 0; i < NV_WORD_BYTES; i++, offset++) {
        out[i] = offset < sizeof(struct payload) ? ((const uint8_t *)context)[offset] : 0xFF;
    }
}

static struct payload make_payload(int serial)
{
    struct payload payload;
    memset(&payload, serial, sizeof payload);
    return payload;
}

START_TEST(power_may_fail_at_any_word_of_a_save)
{
    struct param_store store;
    struct payload payload, got;

    model.torn_raises_nmi = _i % 2 == 0;
    ck_assert_int_eq(param_store_open(&store, &nv, 1, sizeof payload), PARAM_STORE_EMPTY);
    for (int serial = 1; serial <= 2; serial++) {
        payload = make_payload(serial);
        ck_assert_int_eq(param_store_save(&store, source, &payload, true), PARAM_STORE_OK);
    }
    payload = make_payload(3);
    model.power_fails_at = model.operations + (uint32_t)(_i / 2);
    /* The processor does not live to see the result. */
    (void)param_store_save(&store, source, &payload, true);
    ck_assert(model.power_off);
    flash_model_power_up(&model);
    flash_store_init(&flash);

    ck_assert_int_eq(param_store_open(&store, &nv, 1, sizeof payload), PARAM_STORE_OK);
    ck_assert_int_eq(param_store_load(&store, 0, &got, sizeof got), PARAM_STORE_OK);
    payload = make_payload(2);
    ck_assert_mem_eq(&got, &payload, sizeof got);
    payload = make_payload(4);
    ck_assert_int_eq(param_store_save(&store, source, &payload, true), PARAM_STORE_OK);
    ck_assert_int_eq(param_store_open(&store, &nv, 1, sizeof payload), PARAM_STORE_OK);
    ck_assert_int_eq(param_store_load(&store, 0, &got, sizeof got), PARAM_STORE_OK);
    ck_assert_mem_eq(&got, &payload, sizeof got);
}
END_TEST

/* The board's watchdog waits 120 ms, its RC oscillator is some 10 % off, and a tick comes before
 * and behind: nothing may keep the loop for longer than 60 ms. */
static double fed_ms, longest_ms;

static void between(void *context)
{
    (void)context;
    longest_ms = fmax(longest_ms, model.elapsed_ms - fed_ms);
    fed_ms = model.elapsed_ms;
}

static void nothing(const void *context, uint32_t offset, uint8_t *out)
{
    (void)context;
    (void)offset;
    memset(out, 0x55, NV_WORD_BYTES);
}

START_TEST(neither_saving_nor_forgetting_blocks_for_long)
{
    struct param_store store;

    ck_assert_int_eq(param_store_open(&store, &nv, 1, 510 * NV_WORD_BYTES), PARAM_STORE_EMPTY);
    store.between = between;
    for (int save = 0; save < 2; save++) {
        fed_ms = model.elapsed_ms;
        longest_ms = 0;
        ck_assert_int_eq(param_store_save(&store, nothing, NULL, true), PARAM_STORE_OK);
        ck_assert_double_gt(model.elapsed_ms, 90); /* of the largest payload there can be */
        between(NULL);
        ck_assert_double_le(longest_ms, 60);
        model.elapsed_ms = 0;
    }
    fed_ms = longest_ms = 0;
    ck_assert_int_eq(param_store_forget(&store, true), PARAM_STORE_OK);
    ck_assert_double_gt(model.elapsed_ms, 90);
    between(NULL);
    ck_assert_double_le(longest_ms, 60);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("flash_store");
    TCase *tcase = tcase_create("flash_store");

    tcase_set_timeout(tcase, 60);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, words_are_written_read_and_erased_bank_by_bank);
    tcase_add_test(tcase, what_does_not_exist_is_out_of_range);
    tcase_add_test(tcase, a_word_is_written_once);
    tcase_add_test(tcase, an_old_error_does_not_block_an_erase);
    tcase_add_test(tcase, with_one_bank_nothing_is_touched);
    tcase_add_test(tcase, a_flash_that_stays_busy_is_given_up);
    tcase_add_test(tcase, the_longest_erase_is_waited_for);
    tcase_add_test(tcase, an_operation_that_does_not_end_leaves_the_data_cache_off);
    tcase_add_test(tcase, a_locked_interface_fails);
    tcase_add_test(tcase, a_torn_word_reads_as_corrupt_and_the_nmi_is_survived);
    tcase_add_test(tcase, the_driver_notices_even_when_no_nmi_comes);
    tcase_add_test(tcase, an_error_that_is_not_the_stores_is_not_survived);
    tcase_add_loop_test(tcase, power_may_fail_at_any_word_of_a_save, 0, 2 * OPERATIONS_OF_A_SAVE);
    tcase_add_test(tcase, neither_saving_nor_forgetting_blocks_for_long);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
