/* A program and its successor in the model of the flash: what is told of images that are not whole,
 * and an update whose power fails in every operation. */
#include <string.h>

#include "hal/port_stm32g474/flash_store.h"
#include "hal/storage/crc.h"
#include "sim_host/emulator/g474/flash_model.h"
#include "sim_host/emulator/g474/mmio_model.h"
#include "tests/support/assert_close.h"

enum { IMAGE_BYTES = 5000, SLOT = 0x08002000, STAGE = 0x08040000, STAGE_PAGE = 128 };

static struct flash_model model;
static struct flash_store flash;
static struct program_slots slots;
static uint8_t image[IMAGE_BYTES];

static void nmi_handler(void *context)
{
    ck_assert(flash_store_survives_nmi(context));
}

static void setup(void)
{
    mmio_model_reset();
    flash_model_init(&model);
    flash_store_init(&flash);
    model.nmi = nmi_handler;
    model.nmi_context = &flash;
    model.first_page = 4; /* the starter is nobody's */
    model.busy_time = 1;
    slots = flash_store_programs(&flash);
}

static void teardown(void)
{
    ck_assert_uint_eq(model.foreign_erases, 0);
}

static void put_u32(uint32_t at, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        image[at + (uint32_t)i] = (uint8_t)(value >> (8 * i));
    }
}

/* As scripts/seal-image makes one: the CRC is the last word of the header. */
static void make_image(uint8_t seed, uint32_t version)
{
    for (uint32_t i = 0; i < IMAGE_BYTES; i++) {
        image[i] = (uint8_t)(seed + i * 7u);
    }
    put_u32(0x200, 0x474D4941);
    put_u32(0x204, 1);
    put_u32(0x208, version);
    put_u32(0x20C, 0xB01D);
    put_u32(0x210, IMAGE_BYTES);
    put_u32(0x21C, crc32_update(crc32_update(CRC32_INIT, image, 0x21C), image + 0x220,
                                IMAGE_BYTES - 0x220));
}

static void write_image(uint32_t base)
{
    for (uint32_t i = 0; i < IMAGE_BYTES; i += 8) {
        if (i % 2048 == 0) {
            ck_assert_int_eq(flash_store_erase_at(&flash, base + i), NV_OK);
        }
        ck_assert_int_eq(flash_store_write_at(&flash, base + i, image + i), NV_OK);
    }
}

static enum program_verdict verdict_of_slot(uint32_t *version)
{
    struct program_header header;
    const enum program_verdict verdict = program_slots_check(&slots, &header);
    *version = header.version;
    return verdict;
}

START_TEST(only_a_whole_image_for_this_board_is_good)
{
    struct program_header header;

    ck_assert_int_eq(program_slots_check(&slots, &header), PROGRAM_NO_HEADER);
    make_image(1, 0x000200);
    write_image(SLOT);
    ck_assert_int_eq(program_slots_check(&slots, &header), PROGRAM_GOOD);
    ck_assert_uint_eq(header.version, 0x000200);
    ck_assert_uint_eq(header.length, IMAGE_BYTES);
    slots.hardware = 2;
    ck_assert_int_eq(program_slots_check(&slots, &header), PROGRAM_OTHER_HARDWARE);
    slots.hardware = 1;
    slots.room = 4096;
    ck_assert_int_eq(program_slots_check(&slots, &header), PROGRAM_BAD_LENGTH);
}
END_TEST

/* Every bit of the image counts, those of header and CRC, too. */
START_TEST(one_changed_bit_is_noticed)
{
    static const uint32_t words[] = {0, 1, 63, 64, 65, 66, 67, 68, 300, IMAGE_BYTES / 8 - 1};
    uint32_t version;

    make_image(1, 1);
    write_image(SLOT);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        for (unsigned bit = 0; bit < 64; bit += 13) {
            uint64_t *word = &model.word[4 + words[i] / 256][words[i] % 256];
            *word ^= UINT64_C(1) << bit;
            memset(model.in_cache, 0, sizeof model.in_cache);
            /* What is reserved in the header is covered by the CRC alone. */
            ck_assert_int_ne(verdict_of_slot(&version), PROGRAM_GOOD);
            *word ^= UINT64_C(1) << bit;
        }
    }
    memset(model.in_cache, 0, sizeof model.in_cache);
    ck_assert_int_eq(verdict_of_slot(&version), PROGRAM_GOOD);
}
END_TEST

START_TEST(a_scan_in_slices_finds_the_same)
{
    struct program_scan scan;
    unsigned slices = 0;

    make_image(1, 1);
    write_image(SLOT);
    program_scan_begin(&scan, &slots.memory, SLOT, slots.room, 1);
    for (; !scan.done; slices++) {
        program_scan_go_on(&scan, &slots.memory, 2);
    }
    ck_assert_int_eq(scan.verdict, PROGRAM_GOOD);
    ck_assert_uint_eq(slices, (IMAGE_BYTES / 8 + 1) / 2);
    model.state[5][17] = WORD_TORN;
    memset(model.in_cache, 0, sizeof model.in_cache);
    program_scan_begin(&scan, &slots.memory, SLOT, slots.room, 1);
    while (!scan.done) {
        program_scan_go_on(&scan, &slots.memory, 2);
    }
    ck_assert_int_eq(scan.verdict, PROGRAM_TORN);
}
END_TEST

static void power_up(void)
{
    flash_model_power_up(&model);
    flash_store_init(&flash);
}

enum { PAGES = 3, OPERATIONS = 2 /* commit */ + PAGES + IMAGE_BYTES / 8 + 1 /* done */ };

/* In each operation of ordering and copying, once: a start later the program is whole, the old one
 * or the new one; once the order is given and power stays, it is the new one. */
START_TEST(power_may_fail_in_every_operation_of_an_update)
{
    uint32_t version;

    model.torn_raises_nmi = _i % 2 == 0;
    make_image(1, 1);
    write_image(SLOT);
    make_image(2, 2);
    write_image(STAGE);
    model.power_fails_at = model.operations + (uint32_t)_i;
    /* An order names the CRC of what it orders: this one is of something else. */
    (void)program_slots_commit(&slots, 0);
    power_up();
    ck_assert(!program_slots_install(&slots));
    ck_assert_int_eq(verdict_of_slot(&version), PROGRAM_GOOD);
    ck_assert_uint_eq(version, 1);

    struct program_header header;
    ck_assert_int_eq(program_slots_check_stage(&slots, &header), PROGRAM_GOOD);
    model.power_fails_at = model.operations + (uint32_t)_i;
    (void)program_slots_commit(&slots, header.crc);
    if (!model.power_off) {
        (void)program_slots_install(&slots);
    }
    ck_assert(model.power_off);
    power_up();
    const bool ordered = program_slots_is_ordered(&slots);
    (void)program_slots_install(&slots);
    ck_assert_int_eq(verdict_of_slot(&version), PROGRAM_GOOD);
    ck_assert(version == 2 || (version == 1 && !ordered && _i < 2));
    ck_assert(!program_slots_is_ordered(&slots) || !ordered);
    /* And it can be done again. */
    ck_assert(program_slots_commit(&slots, header.crc));
    ck_assert(program_slots_install(&slots));
    ck_assert(!program_slots_install(&slots)); /* once */
    ck_assert_int_eq(verdict_of_slot(&version), PROGRAM_GOOD);
    ck_assert_uint_eq(version, 2);
}
END_TEST

START_TEST(what_is_not_whole_is_not_installed)
{
    struct program_header header;
    uint32_t version;

    make_image(1, 1);
    write_image(SLOT);
    make_image(2, 2);
    write_image(STAGE);
    ck_assert_int_eq(program_slots_check_stage(&slots, &header), PROGRAM_GOOD);
    ck_assert(program_slots_commit(&slots, header.crc));
    model.word[STAGE_PAGE + 1][9] ^= 1;
    memset(model.in_cache, 0, sizeof model.in_cache);
    ck_assert(!program_slots_install(&slots));
    ck_assert_int_eq(verdict_of_slot(&version), PROGRAM_GOOD);
    ck_assert_uint_eq(version, 1);
}
END_TEST

/* What runs is what was ordered already, and what lies staged is not whole: nothing was installed, so no mark says it. */
START_TEST(a_stage_that_is_not_whole_marks_nothing_as_done)
{
    struct program_header header;
    make_image(2, 2);
    write_image(SLOT);
    write_image(STAGE);
    ck_assert_int_eq(program_slots_check_stage(&slots, &header), PROGRAM_GOOD);
    ck_assert(program_slots_commit(&slots, header.crc));
    model.word[STAGE_PAGE + 1][9] ^= 1;
    memset(model.in_cache, 0, sizeof model.in_cache);
    ck_assert(!program_slots_install(&slots));
    ck_assert(program_slots_is_ordered(&slots));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("programs");
    TCase *tcase = tcase_create("programs");

    tcase_set_timeout(tcase, 60);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, only_a_whole_image_for_this_board_is_good);
    tcase_add_test(tcase, one_changed_bit_is_noticed);
    tcase_add_test(tcase, a_scan_in_slices_finds_the_same);
    tcase_add_loop_test(tcase, power_may_fail_in_every_operation_of_an_update, 0, OPERATIONS);
    tcase_add_test(tcase, what_is_not_whole_is_not_installed);
    tcase_add_test(tcase, a_stage_that_is_not_whole_marks_nothing_as_done);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
