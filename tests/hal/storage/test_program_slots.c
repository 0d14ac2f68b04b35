/* A program and its successor in a plain memory, and in one that says it has written and has not. */
#include "hal/storage/program_slots.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/storage/crc.h"
#include "tests/support/assert_close.h"

enum { PAGE = 2048, ROOM = 2 * PAGE, SLOT = 0, STAGE = ROOM, MARK = 2 * ROOM, IMAGE_BYTES = 2000 };

static uint8_t memory[2 * ROOM + PAGE];
static bool slot_is_stuck;
static struct program_slots slots;

static bool read_word(void *context, uint32_t address, uint8_t *out)
{
    (void)context;
    memcpy(out, memory + address, PROGRAM_WORD_BYTES);
    return true;
}

static bool erase(void *context, uint32_t address)
{
    (void)context;
    if (!slot_is_stuck || address >= STAGE) {
        memset(memory + address, 0xFF, PAGE);
    }
    return true;
}

static bool write_word(void *context, uint32_t address, const uint8_t *word)
{
    (void)context;
    if (!slot_is_stuck || address >= STAGE) {
        memcpy(memory + address, word, PROGRAM_WORD_BYTES);
    }
    return true;
}

static uint32_t put_image(uint32_t at, uint32_t version)
{
    uint8_t *image = memory + at;
    for (uint32_t i = 0; i < IMAGE_BYTES; i++) {
        image[i] = (uint8_t)(i * 11u + version);
    }
    bytes_put_u32(image + 0x200, 0x474D4941);
    bytes_put_u32(image + 0x204, 7);
    bytes_put_u32(image + 0x208, version);
    bytes_put_u32(image + 0x210, IMAGE_BYTES);
    const uint32_t crc =
        crc32_update(crc32_update(CRC32_INIT, image, 0x21C), image + 0x220, IMAGE_BYTES - 0x220);
    bytes_put_u32(image + 0x21C, crc);
    return crc;
}

static uint32_t order(void)
{
    memset(memory, 0xFF, sizeof memory);
    slot_is_stuck = false;
    slots = (struct program_slots){.memory = {read_word, erase, write_word, NULL, PAGE},
                                   .slot = SLOT,
                                   .stage = STAGE,
                                   .room = ROOM,
                                   .mark = MARK,
                                   .hardware = 7};
    (void)put_image(SLOT, 5);
    const uint32_t crc = put_image(STAGE, 6);
    ck_assert(program_slots_commit(&slots, crc));
    ck_assert(program_slots_is_ordered(&slots));
    return crc;
}

static uint32_t installed_version(void)
{
    struct program_header header;
    return program_slots_check(&slots, &header) == PROGRAM_GOOD ? header.version : 0;
}

START_TEST(an_order_is_carried_out_once)
{
    (void)order();
    ck_assert(program_slots_install(&slots));
    ck_assert_uint_eq(installed_version(), 6);
    ck_assert(!program_slots_is_ordered(&slots));
    ck_assert(!program_slots_install(&slots));
}
END_TEST

/* The old program is whole, but it is not the one that was ordered: nothing is done, and the order stands. */
START_TEST(a_slot_that_keeps_the_old_program_is_not_done)
{
    (void)order();
    slot_is_stuck = true;
    ck_assert(!program_slots_install(&slots));
    ck_assert_uint_eq(installed_version(), 5);
    ck_assert(program_slots_is_ordered(&slots));
    slot_is_stuck = false;
    ck_assert(program_slots_install(&slots));
    ck_assert_uint_eq(installed_version(), 6);
}
END_TEST

/* Another image in the stage than was ordered is left there. */
START_TEST(another_image_than_was_ordered_is_not_installed)
{
    (void)order();
    (void)put_image(STAGE, 9);
    ck_assert(!program_slots_install(&slots));
    ck_assert_uint_eq(installed_version(), 5);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("program slots");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, an_order_is_carried_out_once);
    tcase_add_test(tests, a_slot_that_keeps_the_old_program_is_not_done);
    tcase_add_test(tests, another_image_than_was_ordered_is_not_installed);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
