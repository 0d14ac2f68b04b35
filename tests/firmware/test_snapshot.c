/* The snapshot's size and its copies, and the recorder's bus in front of another: what it hands
 * on and where a tick ends. */
#include "firmware/bus_recorder.h"

#include <string.h>

#include "hal/bus/frame_table.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

static struct control_task task;
static struct device_drives drives;
static const struct snapshot_source source = {&task, &drives};
static _Alignas(8) uint8_t first[BLACK_BOX_SNAPSHOT_MAX + 8], second[BLACK_BOX_SNAPSHOT_MAX + 8];

/* Bytes without a pattern: each differs from its neighbours and from those eight words on. */
static void fill(void)
{
    uint32_t state = 12345;
    memset(&task, 0, sizeof task);
    memset(&drives, 0, sizeof drives);
    for (size_t i = 0; i < sizeof task.controller; i++) {
        state = state * 1664525u + 1013904223u; /* Numerical Recipes' linear congruence */
        ((uint8_t *)&task.controller)[i] = (uint8_t)(state >> 24);
    }
}

START_TEST(a_size_that_does_not_fit_changes_nothing)
{
    const size_t size = snapshot_size(&source);
    fill();
    memset(first, 0xA5, sizeof first);
    ck_assert_uint_gt(size, 0);
    ck_assert_uint_le(size, BLACK_BOX_SNAPSHOT_MAX);
    ck_assert_uint_eq(snapshot_save(&source, first, size - 1), 0);
    for (size_t i = 0; i < sizeof first; i++) {
        ck_assert_uint_eq(first[i], 0xA5);
    }
    static struct control_task before;
    memcpy(&before, &task, sizeof task);
    ck_assert_int_eq(snapshot_restore(&source, first, size - 1), -1);
    ck_assert_int_eq(snapshot_restore(&source, first, size + 1), -1);
    ck_assert_mem_eq(&before, &task, sizeof task);
}
END_TEST

/* By words or by bytes, a copy is a copy. */
START_TEST(where_it_is_put_makes_no_difference)
{
    const size_t size = snapshot_size(&source);
    fill();
    ck_assert_uint_eq(snapshot_save(&source, first, size), size);
    for (size_t at = 1; at < 8; at++) {
        memset(second, 0, sizeof second);
        ck_assert_uint_eq(snapshot_save(&source, second + at, size), size);
        ck_assert_mem_eq(second + at, first, size);
    }
}
END_TEST

/* What was saved is there again in another task, and what was read from stays as it is. */
START_TEST(what_was_saved_comes_back)
{
    const size_t size = snapshot_size(&source);
    fill();
    task.node.objects.params.leg_length_m = 0.125f;
    task.node.objects.params.r0_max_m = 0.0625f;
    memset(&drives.state, 0x5A, sizeof drives.state);
    ck_assert_uint_eq(snapshot_save(&source, first, size), size);
    memcpy(second, first, size);
    memset(&task, 0, sizeof task);
    memset(&drives.state, 0, sizeof drives.state);
    ck_assert_int_eq(snapshot_restore(&source, first, size), 0);
    ck_assert_mem_eq(first, second, size);
    assert_close(task.node.objects.params.leg_length_m, 0.125, 0.0, 0.0);
    assert_close(task.node.objects.params.r0_max_m, 0.0625, 0.0, 0.0);
    memset(second, 0, sizeof second);
    ck_assert_uint_eq(snapshot_save(&source, second, size), size);
    ck_assert_mem_eq(second, first, size);
}
END_TEST

START_TEST(the_recorder_hands_on_what_the_bus_says_and_is_asked)
{
    static struct black_box box;
    struct bus_recorder recorder;
    struct fake_bus fake;
    struct can_bus_status status = {0};
    fill();
    fake_bus_init(&fake);
    fake.status.tx_error_count = 97;
    const struct can_bus inner = fake_bus_interface(&fake);
    bus_recorder_init(&recorder, &inner, &box, &source);
    const struct can_bus bus = bus_recorder_interface(&recorder);
    can_bus_get_status(&bus, &status);
    ck_assert_uint_eq(status.tx_error_count, 97);
    can_bus_recover(&bus);
    ck_assert_uint_eq(fake.recoveries, 1);
}
END_TEST

/* Somebody else's SYNC begins no tick; the own one does, until the next frame is asked for. */
START_TEST(only_the_own_sync_begins_a_tick)
{
    static struct black_box box;
    struct bus_recorder recorder;
    struct fake_bus fake;
    struct can_msg frame = {.id = FRAME_SYNC};
    fake_bus_init(&fake);
    memset(&task, 0, sizeof task);
    const struct can_bus inner = fake_bus_interface(&fake);
    black_box_start(&box, 1, 2);
    bus_recorder_init(&recorder, &inner, &box, &source);
    const struct can_bus bus = bus_recorder_interface(&recorder);
    fake_bus_put(&fake, &frame);
    frame.flags = CAN_FRAME_OWN;
    fake_bus_put(&fake, &frame);
    ck_assert_int_eq(can_bus_receive(&bus, &frame, NULL), CAN_OK);
    ck_assert(!recorder.in_tick);
    ck_assert_int_eq(can_bus_receive(&bus, &frame, NULL), CAN_OK);
    ck_assert(recorder.in_tick);
    ck_assert_int_ne(can_bus_receive(&bus, &frame, NULL), CAN_OK);
    ck_assert(!recorder.in_tick);
}
END_TEST

/* A fault freezes the recording some ticks later; that it has gone is none. */
START_TEST(only_a_fault_that_comes_freezes_the_recording)
{
    static struct black_box box;
    static const enum supervisor_fault told[] = {SUPERVISOR_FAULT_NONE, SUPERVISOR_FAULT_DRIVE,
                                                 SUPERVISOR_FAULT_DRIVE, SUPERVISOR_FAULT_NONE,
                                                 SUPERVISOR_FAULT_NONE};
    struct bus_recorder recorder;
    struct fake_bus fake;
    struct can_msg sync = {.id = FRAME_SYNC, .flags = CAN_FRAME_OWN};
    memset(&task, 0, sizeof task);
    fake_bus_init(&fake);
    const struct can_bus inner = fake_bus_interface(&fake);
    black_box_start(&box, 1, 2);
    bus_recorder_init(&recorder, &inner, &box, &source);
    const struct can_bus bus = bus_recorder_interface(&recorder);
    for (unsigned i = 0; i < sizeof told / sizeof told[0]; i++) {
        struct can_msg message;
        fake_bus_put(&fake, &sync);
        ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
        task.tick++;
        task.output.fault = told[i];
        ck_assert_int_ne(can_bus_receive(&bus, &message, NULL), CAN_OK); /* the tick ends */
        ck_assert_uint_eq(recorder.fault, told[i]);
        ck_assert_uint_eq(box.header.reason, i == 0 ? 0u : 1u << SUPERVISOR_FAULT_DRIVE);
        ck_assert_uint_eq(box.header.trigger_tick, i == 0 ? 0u : 2u);
        if (i == 3) {
            black_box_start(&box, 1, 2); /* fetched and started anew: what was is no reason again */
            box.header.reason = 1u << SUPERVISOR_FAULT_DRIVE;
            box.header.trigger_tick = 2;
        }
    }
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING);
}
END_TEST

/* So many answers, and the tick of the own SYNC. */
static bool period(struct bus_recorder *recorder, struct fake_bus *fake, unsigned answers,
                   uint32_t id)
{
    const struct can_bus bus = bus_recorder_interface(recorder);
    const struct can_msg sync = {.id = FRAME_SYNC, .flags = CAN_FRAME_OWN};
    struct can_msg answer = {.id = id, .length = 8}, message;
    fake_bus_clear(fake);
    for (unsigned i = 0; i < answers; i++) {
        answer.data[i % 8]++;
        fake_bus_put(fake, &answer);
    }
    fake_bus_put(fake, &sync);
    for (unsigned i = 0; i < answers + 1u; i++) {
        ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    }
    task.tick++;
    ck_assert_int_ne(can_bus_receive(&bus, &message, NULL), CAN_OK);
    return bus_recorder_take_quiet(recorder);
}

static void begin(struct bus_recorder *recorder, struct fake_bus *fake, struct black_box *box)
{
    memset(&task, 0, sizeof task);
    task.controller.derate.tick = task.controller.observer.model.since_tick = UINT32_MAX;
    fake_bus_init(fake);
    const struct can_bus inner = fake_bus_interface(fake);
    black_box_start(box, 1, 2);
    bus_recorder_init(recorder, &inner, box, &source);
}

/* The nodes sample at the SYNC: it must not wait for a copy that is made now and then. The copy is made
 * behind a tick, before anything else is fetched. */
START_TEST(no_sync_waits_for_a_snapshot)
{
    static struct black_box box;
    struct bus_recorder recorder;
    struct fake_bus fake;
    const struct can_msg sync = {.id = FRAME_SYNC},
                         echo = {.id = FRAME_SYNC, .flags = CAN_FRAME_OWN},
                         answer = {.id = 0x181, .length = 6};
    struct can_msg message;
    begin(&recorder, &fake, &box);
    const struct can_bus bus = bus_recorder_interface(&recorder);
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(can_bus_send(&bus, &sync), CAN_OK);
        ck_assert_uint_eq(box.header.next_sequence, 0);
        ck_assert_int_ne(can_bus_receive(&bus, &message, NULL), CAN_OK);
        ck_assert_uint_eq(box.header.next_sequence, 0);
    }
    fake_bus_put(&fake, &echo);
    fake_bus_put(&fake, &answer);
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    task.tick++;
    ck_assert_uint_eq(box.header.next_sequence, 0);
    ck_assert_int_eq(can_bus_receive(&bus, &message, NULL), CAN_OK);
    ck_assert_uint_eq(message.id, 0x181);
    ck_assert_uint_eq(box.header.next_sequence, 1);
    ck_assert_uint_eq(box.blocks[0].first_tick, 1);
    ck_assert(box.blocks[0].used > box.blocks[0].snapshot_bytes); /* the answer is behind it */
}
END_TEST

/* Whatever a device has on the bus: its usual periods are the quiet ones, and the box goes on from block to block. */
START_TEST(a_device_with_more_on_the_bus_is_recorded_on)
{
    static struct black_box box;
    struct bus_recorder recorder;
    struct fake_bus fake;
    begin(&recorder, &fake, &box);
    unsigned quiet = 0;
    for (int i = 0; i < 3000; i++) {
        quiet += period(&recorder, &fake, 12, 0x181) ? 1u : 0u;
    }
    ck_assert_uint_gt(box.header.next_sequence, (uint32_t)BLACK_BOX_BLOCK_COUNT);
    ck_assert_uint_eq(box.header.lost_frames, 0);
    ck_assert_uint_gt(quiet, 2800);
}
END_TEST

/* An answer to a tool, a heartbeat or one frame more than usual: nothing that can wait is done. */
START_TEST(a_period_with_more_than_usual_is_not_quiet)
{
    static struct black_box box;
    struct bus_recorder recorder;
    struct fake_bus fake;
    begin(&recorder, &fake, &box);
    for (int i = 0; i < 200; i++) {
        (void)period(&recorder, &fake, 6, 0x181);
    }
    const uint32_t blocks = box.header.next_sequence;
    ck_assert(period(&recorder, &fake, 6, 0x181));
    ck_assert(!period(&recorder, &fake, 7, 0x181));
    ck_assert(!period(&recorder, &fake, 1, 0x610));
    ck_assert(!period(&recorder, &fake, 1, 0x701));
    task.audit.under_way = true;
    ck_assert(!period(&recorder, &fake, 6, 0x181));
    task.audit.under_way = false;
    ck_assert(period(&recorder, &fake, 6, 0x181));
    ck_assert_uint_eq(box.header.next_sequence, blocks);
}
END_TEST

/* Never quiet, the block that is full is followed by another all the same; not while a node is asked. */
START_TEST(a_full_block_does_not_wait_for_a_quiet_period)
{
    static struct black_box box;
    struct bus_recorder recorder;
    struct fake_bus fake;
    begin(&recorder, &fake, &box);
    for (int i = 0; i < 2000; i++) {
        (void)period(&recorder, &fake, 5, 0x701);
    }
    ck_assert_uint_gt(box.header.next_sequence, (uint32_t)BLACK_BOX_BLOCK_COUNT);
    ck_assert_uint_eq(box.header.lost_frames, 0);
    const uint32_t blocks = box.header.next_sequence;
    task.audit.under_way = true;
    for (int i = 0; i < 2000; i++) {
        (void)period(&recorder, &fake, 5, 0x701);
    }
    ck_assert_uint_eq(box.header.next_sequence, blocks);
    ck_assert_uint_gt(box.header.lost_frames, 0);
}
END_TEST

/* The last blocks before a fault are kept by the same rules: a snapshot that asks for a node's answer would not replay. */
START_TEST(a_recording_that_ends_opens_no_block_while_a_node_is_asked)
{
    static struct black_box box;
    struct bus_recorder recorder;
    struct fake_bus fake;
    begin(&recorder, &fake, &box);
    (void)period(&recorder, &fake, 6, 0x181);
    struct black_box_block *block = &box.blocks[box.header.current];
    block->used = (uint32_t)sizeof block->data - (uint32_t)BLACK_BOX_TICK_RESERVE + 1u;
    const uint32_t blocks = box.header.next_sequence;
    black_box_trigger(&box, 1, task.tick, 3);
    task.audit.under_way = true;
    (void)period(&recorder, &fake, 6, 0x181);
    ck_assert_uint_eq(box.header.next_sequence, blocks);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_CLOSING);
    for (int i = 0; i < 3; i++) {
        (void)period(&recorder, &fake, 6, 0x181);
    }
    ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
    ck_assert_uint_eq(box.header.next_sequence, blocks);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("snapshot");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_size_that_does_not_fit_changes_nothing);
    tcase_add_test(tests, where_it_is_put_makes_no_difference);
    tcase_add_test(tests, what_was_saved_comes_back);
    tcase_add_test(tests, the_recorder_hands_on_what_the_bus_says_and_is_asked);
    tcase_add_test(tests, no_sync_waits_for_a_snapshot);
    tcase_add_test(tests, a_device_with_more_on_the_bus_is_recorded_on);
    tcase_add_test(tests, a_period_with_more_than_usual_is_not_quiet);
    tcase_add_test(tests, a_full_block_does_not_wait_for_a_quiet_period);
    tcase_add_test(tests, a_recording_that_ends_opens_no_block_while_a_node_is_asked);
    tcase_add_test(tests, only_the_own_sync_begins_a_tick);
    tcase_add_test(tests, only_a_fault_that_comes_freezes_the_recording);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
