/* The recorder against its reader: what went in comes out, from any point on. */
#include "hal/storage/black_box.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "hal/storage/black_box_reader.h"
#include "tests/support/assert_close.h"

/* A message without the padding at its end. */
enum { MESSAGE_BYTES = offsetof(struct can_msg, data) + CAN_FRAME_DATA_MAX };

static struct black_box box;
static struct black_box_reader reader;

/* A walk's traffic of one tick, from a small generator. */
static uint32_t noise_state;

static uint32_t noise(void)
{
    noise_state = noise_state * 1664525U + 1013904223U;
    return noise_state >> 8;
}

static struct can_msg frame(uint32_t id, uint8_t length, uint32_t low)
{
    struct can_msg message = {id, length, 0, {0}};

    for (uint8_t i = 0; i < length; i++) {
        message.data[i] = (uint8_t)(low >> (8 * (i % 3)));
    }
    return message;
}

enum { FRAMES_OF_A_TICK = 6 };

static void traffic(uint32_t tick, struct can_msg out[FRAMES_OF_A_TICK])
{
    struct can_msg sync = {FRAME_SYNC, 0, CAN_FRAME_OWN, {0}};

    noise_state = tick;
    out[0] = sync;
    out[1] = frame(FRAME_DRIVE_TARGETS, 8, noise() & 0x3FFU);
    out[1].flags = CAN_FRAME_OWN;
    out[2] = frame(FRAME_DRIVE_STATE_LEFT, 6, noise() & 0xFFFFU);
    out[3] = frame(FRAME_DRIVE_STATE_RIGHT, 6, noise() & 0xFFFFU);
    out[4] = frame(FRAME_LEG_STATE_LEFT, 5, noise());
    out[5] = frame(FRAME_LEG_STATE_RIGHT, 5, noise());
}

static size_t snapshot_of_tick(const void *context, uint8_t *out, size_t capacity)
{
    const uint32_t *tick = context;

    ck_assert_uint_ge(capacity, 700);
    memset(out, (int)(*tick & 0xFFU), 700);
    memcpy(out, tick, sizeof *tick);
    return 700;
}

static void record_ticks(uint32_t first, uint32_t count)
{
    struct can_msg frames[FRAMES_OF_A_TICK];

    for (uint32_t tick = first; tick < first + count; tick++) {
        traffic(tick, frames);
        for (int i = 0; i < FRAMES_OF_A_TICK; i++) {
            black_box_record(&box, &frames[i]);
        }
        black_box_end_tick(&box, tick, snapshot_of_tick, &tick);
    }
}

/* Reads everything; checks each frame against the generator. Returns ticks read. */
static uint32_t verify(uint32_t last_tick)
{
    struct can_msg frames[FRAMES_OF_A_TICK];
    enum black_box_item item;
    uint32_t ticks = 0, place = 0;

    while ((item = black_box_reader_next(&reader)) != BLACK_BOX_END) {
        if (item == BLACK_BOX_SNAPSHOT) {
            uint32_t tick;
            ck_assert_uint_eq(reader.snapshot_bytes, 700);
            memcpy(&tick, reader.snapshot, sizeof tick);
            ck_assert_uint_eq(tick, reader.tick);
            ck_assert_uint_eq(place, 0);
            continue;
        }
        if (place == 0) {
            traffic(reader.tick, frames);
            ticks++;
        }
        /* One assertion a frame costs Check more than all the rest. */
        if (item != BLACK_BOX_FRAME ||
            memcmp(&reader.message, &frames[place], MESSAGE_BYTES) != 0) {
            ck_abort_msg("tick %u, frame %u", reader.tick, place);
        }
        place = (place + 1) % FRAMES_OF_A_TICK;
    }
    ck_assert_uint_eq(reader.tick, last_tick);
    return ticks;
}

START_TEST(fresh_memory_is_no_image)
{
    memset(&box, 0xA5, sizeof box);
    ck_assert(!black_box_is_valid(&box));
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 0);
    black_box_start(&box, 1, 2);
    ck_assert(black_box_is_valid(&box));
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 0);
    ck_assert_int_eq(black_box_reader_next(&reader), BLACK_BOX_END);
}
END_TEST

START_TEST(a_short_recording_is_read_whole)
{
    black_box_start(&box, 1, 2);
    record_ticks(100, 50); /* the first tick only opens the first block */
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 1);
    ck_assert_uint_eq(verify(149), 49);
}
END_TEST

START_TEST(a_long_recording_keeps_the_last_seconds)
{
    black_box_start(&box, 1, 2);
    record_ticks(5, 20000);
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), BLACK_BOX_BLOCK_COUNT);
    uint32_t ticks = verify(20004);
    /* Frames whose every byte changes at random: a walk's do not, and more of it fits. */
    ck_assert_msg(ticks >= 1200, "only %u ticks kept", ticks);
    ck_assert_uint_eq(box.header.lost_frames, 0);
}
END_TEST

START_TEST(it_freezes_after_the_trigger_and_the_first_trigger_counts)
{
    black_box_start(&box, 1, 2);
    record_ticks(1, 3000);
    black_box_trigger(&box, 0x40, 3000, 200);
    record_ticks(3001, 100);
    black_box_trigger(&box, 0x80, 3100, 500);
    record_ticks(3101, 5000);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
    ck_assert_uint_eq(box.header.reason, 0x40);
    ck_assert_uint_eq(box.header.trigger_tick, 3000);
    ck_assert_uint_gt(black_box_reader_open(&reader, &box), 0);
    verify(3200);
}
END_TEST

START_TEST(a_reset_at_any_moment_leaves_a_readable_image)
{
    static struct black_box saved;

    black_box_start(&box, 1, 2);
    record_ticks(1, 4000);
    for (uint32_t tick = 4001; tick < 4400; tick += 7) {
        saved = box; /* the reset comes here: nothing is written any more */
        black_box_freeze(&saved, 0x7);
        ck_assert(black_box_is_valid(&saved));
        ck_assert_uint_gt(black_box_reader_open(&reader, &saved), 1);
        verify(tick - 1);
        record_ticks(tick, 7);
    }
}
END_TEST

START_TEST(a_torn_length_costs_one_block_only)
{
    black_box_start(&box, 1, 2);
    record_ticks(1, 9000);
    uint32_t blocks = black_box_reader_open(&reader, &box);
    box.blocks[box.header.current].used += 5; /* and its complement was not written */
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), blocks - 1);
}
END_TEST

START_TEST(frames_of_any_kind_come_back)
{
    struct can_msg odd[] = {{0x123, 3, 0, {1, 2, 3}},
                            {0x12345678, 8, CAN_FRAME_EXTENDED, {9, 8, 7, 6, 5, 4, 3, 2}},
                            {FRAME_LEG_STATE_LEFT, 4, 0, {1, 2, 3, 4}}, /* a wrong length */
                            {0, 4, CAN_FRAME_ERROR, {1, 2, 3, 4}},
                            {FRAME_LEG_STATE_LEFT, 5, CAN_FRAME_REMOTE, {0}},
                            {FRAME_HEARTBEAT_DRIVE_LEFT, 1, 0, {5}},
                            {FRAME_HEARTBEAT_DRIVE_LEFT, 1, 0, {5}},
                            {FRAME_HEARTBEAT_DRIVE_LEFT, 1, 0, {0}},
                            {FRAME_SYNC, 0, CAN_FRAME_OWN, {0}},
                            {FRAME_DRIVE_TARGETS, 8, CAN_FRAME_OWN, {1}},
                            {FRAME_DRIVE_TARGETS, 8, 0, {1}}, /* a foreign node's */
                            {FRAME_SYNC, 0, 0, {0}}};         /* this, too: no tick of ours */
    uint32_t tick = 7;

    black_box_start(&box, 1, 2);
    black_box_end_tick(&box, tick, NULL, NULL);
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        black_box_record(&box, &odd[i]);
    }
    ck_assert_uint_eq(black_box_reader_open(&reader, &box), 1);
    ck_assert_int_eq(black_box_reader_next(&reader), BLACK_BOX_SNAPSHOT);
    ck_assert_uint_eq(reader.snapshot_bytes, 0);
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        ck_assert_int_eq(black_box_reader_next(&reader), BLACK_BOX_FRAME);
        ck_assert_mem_eq(&reader.message, &odd[i], MESSAGE_BYTES);
    }
    ck_assert_uint_eq(reader.tick, 8);
    ck_assert_int_eq(black_box_reader_next(&reader), BLACK_BOX_END);
}
END_TEST

START_TEST(a_flood_is_counted_not_written_past_the_block)
{
    struct can_msg message = {0x555, 8, 0, {1, 2, 3, 4, 5, 6, 7, 8}};

    black_box_start(&box, 1, 2);
    black_box_end_tick(&box, 1, NULL, NULL);
    for (int i = 0; i < 2000; i++) {
        black_box_record(&box, &message);
    }
    ck_assert_uint_gt(box.header.lost_frames, 0);
    ck_assert_uint_le(box.blocks[0].used, sizeof box.blocks[0].data);
    ck_assert_uint_eq(box.blocks[1].magic, 0);
}
END_TEST

START_TEST(arbitrary_bytes_never_lead_the_reader_astray)
{
    black_box_start(&box, 1, 2);
    record_ticks(1, 3000);
    srand(4711);
    for (int round = 0; round < 300; round++) {
        static struct black_box damaged;
        damaged = box;
        for (int i = 0; i < 40; i++) {
            ((uint8_t *)&damaged)[(size_t)rand() % sizeof damaged] = (uint8_t)rand();
        }
        black_box_reader_open(&reader, &damaged);
        int items = 0;
        while (black_box_reader_next(&reader) != BLACK_BOX_END) {
            if (++items > 2 * BLACK_BOX_BYTES || reader.message.length > 8) {
                ck_abort_msg("item %d of round %d", items, round);
            }
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("black_box");
    TCase *tcase = tcase_create("black_box");

    tcase_add_test(tcase, fresh_memory_is_no_image);
    tcase_add_test(tcase, a_short_recording_is_read_whole);
    tcase_add_test(tcase, a_long_recording_keeps_the_last_seconds);
    tcase_add_test(tcase, it_freezes_after_the_trigger_and_the_first_trigger_counts);
    tcase_add_test(tcase, a_reset_at_any_moment_leaves_a_readable_image);
    tcase_add_test(tcase, a_torn_length_costs_one_block_only);
    tcase_add_test(tcase, frames_of_any_kind_come_back);
    tcase_add_test(tcase, a_flood_is_counted_not_written_past_the_block);
    tcase_add_test(tcase, arbitrary_bytes_never_lead_the_reader_astray);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
