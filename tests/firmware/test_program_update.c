/* A program over CAN, as the objects 0x1F50 to 0x1F57 take it: what is refused, and with what. */
#include "firmware/program_update.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"
#include "hal/storage/crc.h"
#include "tests/support/assert_close.h"

enum { PAGE = 2048, ROOM = 8 * PAGE, SLOT = 0, STAGE = ROOM, MARK = 2 * ROOM, IMAGE_BYTES = 4000 };

static uint8_t memory[2 * ROOM + PAGE];
static bool refuses;
static unsigned erases;
static struct program_slots slots;
static struct program_update update;
static uint8_t image[IMAGE_BYTES];

static bool read_word(void *context, uint32_t address, uint8_t *out)
{
    (void)context;
    memcpy(out, memory + address, PROGRAM_WORD_BYTES);
    return true;
}

static bool erase(void *context, uint32_t address)
{
    (void)context;
    ck_assert_uint_eq(address % PAGE, 0);
    ck_assert_uint_ge(address, STAGE); /* never what runs */
    erases++;
    memset(memory + address, 0xFF, PAGE);
    return !refuses;
}

static bool write_word(void *context, uint32_t address, const uint8_t *word)
{
    (void)context;
    for (int i = 0; i < PROGRAM_WORD_BYTES; i++) {
        ck_assert_uint_eq(memory[address + (uint32_t)i], 0xFF);
    }
    memcpy(memory + address, word, PROGRAM_WORD_BYTES);
    return !refuses;
}

static void make_image(uint32_t version, uint32_t hardware)
{
    for (uint32_t i = 0; i < IMAGE_BYTES; i++) {
        image[i] = (uint8_t)(i * 11u + version);
    }
    bytes_put_u32(image + 0x200, 0x474D4941);
    bytes_put_u32(image + 0x204, hardware);
    bytes_put_u32(image + 0x208, version);
    bytes_put_u32(image + 0x210, IMAGE_BYTES);
    bytes_put_u32(image + 0x21C, crc32_update(crc32_update(CRC32_INIT, image, 0x21C), image + 0x220,
                                              IMAGE_BYTES - 0x220));
}

static void setup(void)
{
    memset(memory, 0xFF, sizeof memory);
    refuses = false;
    erases = 0;
    slots = (struct program_slots){.memory = {read_word, erase, write_word, NULL, PAGE},
                                   .slot = SLOT,
                                   .stage = STAGE,
                                   .room = ROOM,
                                   .mark = MARK,
                                   .hardware = 7};
    make_image(5, 7);
    memcpy(memory + SLOT, image, IMAGE_BYTES);
    program_update_init(&update, &slots);
}

static uint32_t send(size_t length)
{
    uint32_t verdict = program_update_begin(&update, (uint32_t)length);

    for (size_t done = 0; done < length && verdict == CO_ABORT_NONE; done += 7) {
        const unsigned part = length - done < 7 ? (unsigned)(length - done) : 7u;
        verdict = program_update_take(&update, image + done, part, done + part == length);
    }
    return verdict;
}

START_TEST(a_newer_program_is_ordered_once_it_is_whole)
{
    ck_assert_uint_eq(update.identification, bytes_get_u32(memory + SLOT + 0x21C));
    ck_assert_uint_eq(update.version, 5);
    make_image(6, 7);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START),
                      CO_ABORT_DEVICE_STATE); /* nothing was received */
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_NONE);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_GOOD);
    ck_assert_uint_eq(erases, 1 + 2); /* the mark's page, and those that it takes */
    ck_assert(!program_slots_is_ordered(&slots));
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START), CO_ABORT_NONE);
    ck_assert(program_slots_is_ordered(&slots));
    for (int tick = 1; tick < PROGRAM_RESTART_TICKS; tick++) { /* the answer leaves first */
        program_update_tick(&update);
        ck_assert(!update.restart_now);
    }
    program_update_tick(&update);
    ck_assert(update.restart_now);
}
END_TEST

START_TEST(an_older_one_needs_another_word)
{
    make_image(4, 7);
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_NONE);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START),
                      CO_ABORT_DEVICE_STATE);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_OLDER);
    ck_assert(!program_slots_is_ordered(&slots));
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START_OLDER), CO_ABORT_NONE);
    ck_assert(program_slots_is_ordered(&slots));
    setup(); /* the same version again is no older one */
    make_image(5, 7);
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_NONE);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START), CO_ABORT_NONE);
}
END_TEST

START_TEST(what_is_no_whole_image_for_this_board_is_refused)
{
    make_image(6, 8);
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_VALUE);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_OTHER_BOARD);
    make_image(6, 7);
    image[3000] ^= 1;
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_VALUE);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_DAMAGED);
    make_image(6, 7);
    ck_assert_uint_eq(send(IMAGE_BYTES - 8), CO_ABORT_VALUE); /* cut short */
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_DAMAGED);
    image[0x200] ^= 1;
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_VALUE);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_FORMAT);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START_OLDER),
                      CO_ABORT_DEVICE_STATE);
    ck_assert_uint_eq(program_update_begin(&update, ROOM + 1), CO_ABORT_TOO_LONG);
    ck_assert_uint_eq(program_update_control(&update, 0), CO_ABORT_VALUE);
    ck_assert_uint_eq(program_update_control(&update, 2), CO_ABORT_VALUE);
}
END_TEST

START_TEST(more_than_there_is_room_for_ends_in_an_error)
{
    const uint8_t part[7] = {0};
    uint32_t verdict = program_update_begin(&update, 0); /* no length was told */

    for (unsigned i = 0; i < ROOM / 7 + 8 && verdict == CO_ABORT_NONE; i++) {
        verdict = program_update_take(&update, part, 7, false);
    }
    ck_assert_uint_eq(verdict, CO_ABORT_NOT_STORED);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_WRITE);
    ck_assert_uint_eq(memory[MARK], 0xFF);
    ck_assert_uint_eq(program_update_take(&update, part, 7, false), CO_ABORT_DEVICE_STATE);
}
END_TEST

START_TEST(clearing_takes_an_order_back)
{
    make_image(6, 7);
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_NONE);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START), CO_ABORT_NONE);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_CLEAR), CO_ABORT_NONE);
    ck_assert(!program_slots_is_ordered(&slots));
    for (int tick = 0; tick < 2 * PROGRAM_RESTART_TICKS; tick++) {
        program_update_tick(&update);
    }
    ck_assert(!update.restart_now);
}
END_TEST

START_TEST(a_memory_that_refuses_and_a_device_without_one_say_so)
{
    make_image(6, 7);
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_NONE);
    refuses = true;
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START), CO_ABORT_NOT_STORED);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_WRITE);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_CLEAR), CO_ABORT_NOT_STORED);
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_NOT_STORED);
    program_update_init(&update, NULL);
    ck_assert_uint_eq(update.identification, 0);
    ck_assert_uint_eq(send(IMAGE_BYTES), CO_ABORT_DEVICE_STATE);
    ck_assert_uint_eq(program_update_take(&update, image, 7, false), CO_ABORT_DEVICE_STATE);
    ck_assert_uint_eq(program_update_control(&update, PROGRAM_CONTROL_START),
                      CO_ABORT_DEVICE_STATE);
}
END_TEST

/* After power-on nothing valid was received, whatever this memory held before; without slots nothing is read. */
START_TEST(nothing_was_received_at_power_on)
{
    memset(&update, 0xA5, sizeof update);
    program_update_init(&update, &slots);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_NONE);
    ck_assert_uint_eq(update.received, 0);
    ck_assert_uint_eq(update.filled, 0);
    ck_assert_uint_eq(update.restart_in, 0);
    ck_assert(!update.restart_now);
    ck_assert_uint_eq(update.version, 5);
    ck_assert_uint_eq(update.identification, bytes_get_u32(image + 0x21C));
    memset(&update, 0xA5, sizeof update);
    program_update_init(&update, NULL);
    ck_assert_uint_eq(update.status, PROGRAM_STATUS_NONE);
    ck_assert_uint_eq(update.version, 0);
    ck_assert_uint_eq(update.identification, 0);
    ck_assert_uint_eq(program_update_begin(&update, 100), CO_ABORT_DEVICE_STATE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("program_update");
    TCase *tests = tcase_create("program_update");

    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, a_newer_program_is_ordered_once_it_is_whole);
    tcase_add_test(tests, an_older_one_needs_another_word);
    tcase_add_test(tests, what_is_no_whole_image_for_this_board_is_refused);
    tcase_add_test(tests, more_than_there_is_room_for_ends_in_an_error);
    tcase_add_test(tests, clearing_takes_an_order_back);
    tcase_add_test(tests, a_memory_that_refuses_and_a_device_without_one_say_so);
    tcase_add_test(tests, nothing_was_received_at_power_on);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
