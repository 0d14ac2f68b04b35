/* The black box and its reader where a word was changed or a record cut: records by hand, as
 * hal/storage/black_box.h lays them out. */
#include "hal/storage/black_box_reader.h"

#include <string.h>

#include "hal/bus/frame_table.h"
#include "tests/support/assert_close.h"

static struct black_box box;
static struct black_box_reader reader;

static void setup(void)
{
    memset(&box, 0, sizeof box);
    black_box_start(&box, 1, 2);
    black_box_end_tick(&box, 1, NULL, NULL);
}

static struct black_box_block *block(void)
{
    return &box.blocks[box.header.current];
}

/* One block whose only record is these bytes. */
static void put(const uint8_t *bytes, uint32_t length)
{
    setup();
    memcpy(block()->data, bytes, length);
    block()->used = length;
    block()->used_inverted = ~length;
}

static enum black_box_item first_item(void)
{
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 1);
    ck_assert_int_eq(black_box_reader_next(&reader), BLACK_BOX_SNAPSHOT);
    return black_box_reader_next(&reader);
}

/* Every frame of the bus has a row, in the order of the frame table, if it has its length. */
START_TEST(every_frame_of_the_bus_has_its_row)
{
    static const struct {
        uint32_t id;
        uint8_t bytes;
    } frames[] = {
#define FRAME(name, id, bytes, period_us, deadline_us, node, kind) {id, bytes},
        FRAME_TABLE(FRAME)
#undef FRAME
    };
    for (int i = 0; i < (int)(sizeof frames / sizeof frames[0]); i++) {
        ck_assert_int_eq(black_box_row(frames[i].id, frames[i].bytes), i);
        ck_assert_int_eq(black_box_row(frames[i].id, (uint8_t)(frames[i].bytes + 1)), -1);
        ck_assert_int_eq(black_box_row(frames[i].id + 0x800, frames[i].bytes), -1);
    }
}
END_TEST

START_TEST(only_the_states_that_there_are_make_an_image)
{
    static const uint32_t none[] = {0, BLACK_BOX_FROZEN + 1, UINT32_MAX};
    for (uint32_t state = BLACK_BOX_RECORDING; state <= BLACK_BOX_FROZEN; state++) {
        box.header.state = state;
        ck_assert(black_box_is_valid(&box));
    }
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        box.header.state = none[i];
        ck_assert(!black_box_is_valid(&box));
    }
}
END_TEST

/* A flipped bit of what the sum guards, or of the sum itself, makes it none. */
START_TEST(a_damaged_header_is_no_image)
{
    uint32_t *const guarded[] = {&box.header.magic, &box.header.build_id, &box.header.parameter_crc,
                                 &box.header.check};
    ck_assert(black_box_is_valid(&box));
    for (size_t i = 0; i < sizeof guarded / sizeof guarded[0]; i++) {
        for (unsigned bit = 0; bit < 32; bit++) {
            *guarded[i] ^= 1u << bit;
            ck_assert(!black_box_is_valid(&box));
            *guarded[i] ^= 1u << bit;
        }
    }
    ck_assert(black_box_is_valid(&box));
}
END_TEST

START_TEST(the_first_reason_to_freeze_stays)
{
    black_box_freeze(&box, 5);
    black_box_freeze(&box, 9);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
    ck_assert_uint_eq(box.header.reason, 5);
}
END_TEST

START_TEST(the_count_of_lost_frames_stays_at_its_end)
{
    const struct can_msg message = {0x555, 8, 0, {1, 2, 3, 4, 5, 6, 7, 8}};
    while (box.header.lost_frames == 0) {
        black_box_record(&box, &message);
    }
    box.header.lost_frames = UINT32_MAX;
    black_box_record(&box, &message);
    ck_assert_uint_eq(box.header.lost_frames, UINT32_MAX);
}
END_TEST

/* A block that can just wait for another tick takes all that a full bus carries in one, whatever the length
 * of its frames: bits by ISO 11898-1, without stuff bits, with three of intermission. */
START_TEST(a_tick_of_a_full_bus_fits_what_is_left)
{
    const struct can_msg message = {
        .id = 0x555, .length = (uint8_t)_i, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
    const int bits = 44 + 8 * _i + 3;
    const int in_a_tick = TICK_PERIOD_US * (BUS_BITRATE / 1000) / 1000 / bits + 1;

    while (!black_box_is_full(&box)) {
        block()->used++;
    }
    block()->used--;
    ck_assert(!black_box_is_full(&box));
    for (int i = 0; i < 2 * in_a_tick; i++) {
        black_box_record(&box, &message);
    }
    ck_assert_uint_eq(box.header.lost_frames, 0);
    ck_assert_uint_le(block()->used, sizeof block()->data);
}
END_TEST

/* So it takes all error frames of a disturbed bus, too: an error flag of 6 bits behind a start bit, its delimiter of 8,
 * three of intermission, and two of the flag's echo at least (ISO 11898-1). The port's poll tells of 4 bytes each. */
START_TEST(a_tick_of_error_frames_fits_what_is_left)
{
    const struct can_msg error = {.flags = CAN_FRAME_ERROR, .length = 4};
    const struct can_msg own = {.id = 0x80, .length = 0};
    const int bits = TICK_PERIOD_US * (BUS_BITRATE / 1000) / 1000;

    while (!black_box_is_full(&box)) {
        block()->used++;
    }
    block()->used--;
    for (int i = 0; i < bits / 47; i++) {
        black_box_record(&box, &own); /* before they are on the bus */
    }
    for (int i = 0; i < bits / 20; i++) {
        black_box_record(&box, &error);
    }
    ck_assert_uint_eq(box.header.lost_frames, 0);
}
END_TEST

static size_t too_large(const void *context, uint8_t *out, size_t capacity)
{
    (void)context;
    (void)out;
    return capacity + 1;
}

START_TEST(a_snapshot_larger_than_its_room_is_none)
{
    memset(&box, 0, sizeof box);
    black_box_start(&box, 1, 2);
    black_box_end_tick(&box, 1, too_large, NULL);
    ck_assert_uint_eq(block()->snapshot_bytes, 0);
    ck_assert_uint_eq(block()->used, 0);
}
END_TEST

/* More bytes than a frame holds: no frame of a bus; kept without them. */
START_TEST(a_length_beyond_a_frame_s_copies_nothing)
{
    struct can_msg message = {0x555, CAN_FRAME_DATA_MAX + 1, 0, {1, 2, 3}};
    black_box_record(&box, &message);
    ck_assert_int_eq(first_item(), BLACK_BOX_FRAME);
    ck_assert_uint_eq(reader.message.id, 0x555);
    ck_assert_uint_eq(reader.message.length, 0);
}
END_TEST

START_TEST(a_whole_record_is_read_a_cut_one_is_damage)
{
    static const uint8_t raw[] = {BLACK_BOX_RAW, 0, 2, 0x55, 0x05, 0, 0, 0xAB, 0xCD};
    static const uint8_t row[] = {0, 0x01, 0x77}; /* the first row's first byte has changed */
    put(raw, sizeof raw);
    ck_assert_int_eq(first_item(), BLACK_BOX_FRAME);
    ck_assert_uint_eq(reader.message.id, 0x555);
    ck_assert_uint_eq(reader.message.data[1], 0xCD);
    for (uint32_t length = 1; length < sizeof raw; length++) {
        put(raw, length);
        ck_assert_int_eq(first_item(), BLACK_BOX_DAMAGED);
        ck_assert_int_eq(black_box_reader_next(&reader), BLACK_BOX_END);
    }
    put(raw, sizeof raw);
    block()->data[2] = CAN_FRAME_DATA_MAX + 1;
    ck_assert_int_eq(first_item(), BLACK_BOX_DAMAGED);
    for (uint32_t length = 1; length < sizeof row; length++) {
        put(row, length);
        ck_assert_int_eq(first_item(), BLACK_BOX_DAMAGED);
    }
}
END_TEST

/* Lengths that contradict each other make no block. */
START_TEST(a_block_of_impossible_lengths_is_passed_over)
{
    put((const uint8_t[]){0}, 1);
    block()->used = sizeof block()->data + 1;
    block()->used_inverted = ~block()->used;
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 0);
    put((const uint8_t[]){0}, 1);
    block()->snapshot_bytes = 2; /* of one byte in all */
    block()->check = black_box_block_check(block());
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 0);
}
END_TEST

/* A new recording has nothing of the one before: its blocks are the new one's alone. */
START_TEST(a_new_recording_forgets_the_last_one)
{
    setup();
    for (uint32_t i = 0; i < BLACK_BOX_BLOCK_COUNT; i++) {
        if (i != box.header.current) {
            box.blocks[i] = *block();
        }
    }
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), BLACK_BOX_BLOCK_COUNT);
    memset(&box.header, 0xA5, sizeof box.header);
    black_box_start(&box, 1, 2);
    for (uint32_t i = 0; i < BLACK_BOX_BLOCK_COUNT; i++) {
        ck_assert_uint_eq(box.blocks[i].magic, 0);
    }
    ck_assert_uint_eq(box.header.reason, 0);
    ck_assert_uint_eq(box.header.trigger_tick, 0);
    ck_assert_uint_eq(box.header.close_tick, 0);
    ck_assert_uint_eq(box.header.next_sequence, 0);
    ck_assert_uint_eq(box.header.lost_frames, 0);
    for (int row = 0; row < BLACK_BOX_ROW_MAX; row++) {
        ck_assert_uint_eq(box.header.last[row][0], 0);
    }
    black_box_end_tick(&box, 1, NULL, NULL);
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("black_box_edges");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, every_frame_of_the_bus_has_its_row);
    tcase_add_test(tests, only_the_states_that_there_are_make_an_image);
    tcase_add_test(tests, a_damaged_header_is_no_image);
    tcase_add_test(tests, the_first_reason_to_freeze_stays);
    tcase_add_test(tests, the_count_of_lost_frames_stays_at_its_end);
    tcase_add_test(tests, a_tick_of_error_frames_fits_what_is_left);
    tcase_add_loop_test(tests, a_tick_of_a_full_bus_fits_what_is_left, 0, CAN_FRAME_DATA_MAX + 1);
    tcase_add_test(tests, a_snapshot_larger_than_its_room_is_none);
    tcase_add_test(tests, a_length_beyond_a_frame_s_copies_nothing);
    tcase_add_test(tests, a_whole_record_is_read_a_cut_one_is_damage);
    tcase_add_test(tests, a_block_of_impossible_lengths_is_passed_over);
    tcase_add_test(tests, a_new_recording_forgets_the_last_one);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
