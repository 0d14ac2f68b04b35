/* The black box from end to end: a walk on the in-process bus is recorded, a tool on the same
 * bus fetches the box over SDO, and the log that comes of it replays from the middle of the
 * walk, bit by bit. */
#include <string.h>

#include "firmware/bus_recorder.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/log/replay.h"
#include "sim_host/log/sdo_upload.h"
#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

enum { WALK_TICKS = 12000, PATIENCE = 20 };

static struct loop loop;
static struct loop_config config;
static struct subject subject;
static struct control_params params;
static struct black_box box, fetched;
static struct bus_recorder recorder;
static struct can_bus tool;
static struct replay replay;
static struct black_box_summary summary;
static char message[LOOP_MESSAGE_MAX], version[BLACK_BOX_VERSION_MAX + 1];

static struct can_bus record(void *context, struct can_bus bus)
{
    const struct snapshot_source source = {&loop.rig.task, &loop.rig.drives};
    (void)context;
    bus_recorder_init(&recorder, &bus, &box, &source);
    return bus_recorder_interface(&recorder);
}

static bool let_it_run(void *context, unsigned waits)
{
    (void)context;
    loop_tick(&loop);
    return waits < PATIENCE;
}

static void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        loop_tick(&loop);
    }
}

static void start(void)
{
    ck_assert_int_eq(subject_read(&subject, "sim_host/persons/paper.ini",
                                  "sim_host/devices/virtual.ini", message),
                     0);
    ck_assert_msg(subject_control_params(&subject, &params, message) == 0, "%s", message);
    ck_assert_msg(loop_configure(&config, &subject, &params, 0.8, SENSORS_17BIT, 7, message) == 0,
                  "%s", message);
    config.wrap_bus = record;
    black_box_start(&box, 0xB01D, params_guard_crc(&params));
    ck_assert_int_eq(loop_init(&loop, &config, NULL, message), 0);
    controller_node_attach(&loop.rig.task.node, NULL, NULL, &box, NULL, NULL);
    tool = sim_bus_port(&loop.bus, sim_bus_attach(&loop.bus, "tool", NULL, NULL));
}

static void fetch(bool freeze)
{
    ck_assert_msg(black_box_fetch(&tool, let_it_run, NULL, freeze, &fetched, version, message,
                                  sizeof message) == 0,
                  "%s", message);
    ck_assert_mem_eq(&fetched, &box, sizeof box);
}

static enum replay_verdict replay_box(void)
{
    FILE *log = tmpfile();
    ck_assert_ptr_nonnull(log);
    ck_assert_int_eq(black_box_log_write(&fetched, version, "can0", log, &summary), 0);
    rewind(log);
    /* Another subject's speed: all that counts comes with the snapshot. */
    ck_assert_int_eq(replay_init(&replay, &subject, &params, 0.5), 0);
    const enum replay_verdict verdict = replay_run(&replay, log);
    fclose(log);
    return verdict;
}

START_TEST(what_was_recorded_replays_from_the_middle)
{
    start();
    run(WALK_TICKS);
    fetch(true);
    ck_assert_msg(replay_box() == REPLAY_EQUAL, "%s", replay.message);
    ck_assert_uint_eq(replay.snapshots, 1);
    ck_assert_uint_eq(replay.build_id, 0xB01D);
    ck_assert_uint_eq(replay.parameter_crc, loop.rig.task.node.objects.params_crc);
    ck_assert_uint_eq(summary.lost_frames + summary.damaged, 0);
    ck_assert_uint_gt(summary.first_tick, 2000);                     /* not from the start */
    ck_assert_uint_gt(summary.last_tick - summary.first_tick, 1500); /* three of its blocks */
    ck_assert_uint_gt(replay.compared, summary.last_tick - summary.first_tick);
    ck_assert_str_eq(version, loop.rig.task.node.objects.version);
}
END_TEST

/* Begun in the middle of a node's set-up, as after a reset: what was asked of the node is in no record, its answer
 * would mean nothing to a replay. The first snapshot waits. */
START_TEST(begun_in_a_set_up_it_replays_from_behind_it)
{
    start();
    for (int i = 0; i < 1000 && !loop.rig.task.bring_up.setup.under_way; i++) {
        loop_tick(&loop);
    }
    ck_assert(loop.rig.task.bring_up.setup.under_way);
    const uint32_t begun = loop.rig.task.tick;
    black_box_start(&box, 0xB01D, params_guard_crc(&params));
    run(1500);
    fetch(true);
    ck_assert_msg(replay_box() == REPLAY_EQUAL, "%s", replay.message);
    ck_assert_uint_gt(summary.first_tick, begun);
    ck_assert_uint_gt(replay.compared, 1000);
}
END_TEST

/* A fault freezes it; what was written over SDO meanwhile is part of the recording. */
START_TEST(a_fault_freezes_it_and_written_values_replay)
{
    struct sdo_upload sdo = {.bus = &tool, .node = 16, .wait = let_it_run};
    const float slower = 0.79f;
    uint32_t bits;
    start();
    run(WALK_TICKS);
    memcpy(&bits, &slower, sizeof bits);
    ck_assert_int_eq(sdo_write(&sdo, 0x2000, 1, bits, 4), SDO_UPLOAD_DONE);
    run(500);
    loop.rig.stop_pressed = true;
    run(1000);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
    fetch(false);
    ck_assert_uint_eq(fetched.header.reason, 1u << SUPERVISOR_FAULT_EMERGENCY_STOP);
    ck_assert_msg(replay_box() == REPLAY_EQUAL, "%s", replay.message);
    ck_assert_uint_ge(summary.last_tick, summary.trigger_tick + BUS_RECORDER_AFTER_FAULT_TICKS - 1);
    ck_assert_int_eq(replay.rig.task.output.fault, SUPERVISOR_FAULT_EMERGENCY_STOP);
    ck_assert(replay.rig.task.node.objects.desired_speed_rad_s == slower);
    /* Released, it records anew. */
    ck_assert_int_eq(black_box_release(&tool, let_it_run, NULL, message, sizeof message), 0);
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING);
}
END_TEST

/* Another node speaks with the controller's identifiers, in the middle between two SYNCs. */
static void intrude(const struct can_msg *frames, unsigned count)
{
    const uint64_t us = 1000;
    sim_bus_run_until(&loop.bus, sim_bus_now_ns(&loop.bus) + 500 * us);
    for (unsigned i = 0; i < count; i++) {
        ck_assert_int_eq(can_bus_send(&tool, &frames[i]), CAN_OK);
    }
    sim_bus_run_until(&loop.bus, sim_bus_now_ns(&loop.bus) + 400 * us);
}

/* The controller hears them, stops, and freezes its box; the replay hears them too. A SYNC of
 * theirs is no tick of its own. */
START_TEST(what_a_foreign_master_said_replays)
{
    static const struct can_msg all[] = {
        {.id = 0x301, .length = 6, .data = {0x0F, 0, 0, 0, 1, 0}},
        {.id = 0x201, .length = 8, .data = {1, 2, 3}},
        {.id = 0x710, .length = 1, .data = {5}},
        {.id = 0x080},
    };
    enum { ALL = sizeof all / sizeof all[0] };
    for (unsigned first = 0; first < ALL; first++) {
        start();
        run(WALK_TICKS);
        intrude(&all[first], 1);
        run(20);
        intrude(all, ALL);
        run(1000);
        ck_assert_uint_eq(box.header.state, BLACK_BOX_FROZEN);
        fetch(false);
        ck_assert_uint_eq(fetched.header.reason, 1u << SUPERVISOR_FAULT_FOREIGN);
        ck_assert_msg(replay_box() == REPLAY_EQUAL, "%s", replay.message);
        ck_assert_uint_eq(replay.foreign_frames, 1 + ALL);
        ck_assert_uint_gt(summary.last_tick, summary.trigger_tick + 100);
        ck_assert_int_eq(replay.rig.task.output.fault, SUPERVISOR_FAULT_FOREIGN);
    }
}
END_TEST

START_TEST(a_changed_bit_is_found)
{
    start();
    run(WALK_TICKS);
    fetch(true);
    const struct black_box good = fetched;
    ck_assert_msg(replay_box() == REPLAY_EQUAL, "%s", replay.message);
    for (uint32_t i = 0; i < BLACK_BOX_BLOCK_COUNT; i++) {
        struct black_box_block *block = &fetched.blocks[i];
        if (i == fetched.header.current) {
            continue; /* nothing follows its last frame that could tell */
        }
        /* The last byte of a frame's data. */
        block->data[block->used - 1] ^= 1;
        ck_assert_int_ne(replay_box(), REPLAY_EQUAL);
        fetched = good;
    }
}
END_TEST

START_TEST(it_is_not_given_while_it_records)
{
    start();
    run(3000);
    ck_assert_int_eq(
        black_box_fetch(&tool, let_it_run, NULL, false, &fetched, version, message, sizeof message),
        -1);
    ck_assert_ptr_nonnull(strstr(message, "08000022"));
    ck_assert_uint_eq(box.header.state, BLACK_BOX_RECORDING);
}
END_TEST

START_TEST(who_does_not_answer_is_told)
{
    start();
    run(100);
    sim_bus_connect(&loop.bus, LOOP_PORT_CONTROLLER, false);
    ck_assert_int_eq(
        black_box_fetch(&tool, let_it_run, NULL, true, &fetched, version, message, sizeof message),
        -1);
    ck_assert_ptr_nonnull(strstr(message, "does not answer"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("black_box_replay");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120.0);
    tcase_add_test(tests, what_was_recorded_replays_from_the_middle);
    tcase_add_test(tests, begun_in_a_set_up_it_replays_from_behind_it);
    tcase_add_test(tests, a_fault_freezes_it_and_written_values_replay);
    tcase_add_test(tests, what_a_foreign_master_said_replays);
    tcase_add_test(tests, a_changed_bit_is_found);
    tcase_add_test(tests, it_is_not_given_while_it_records);
    tcase_add_test(tests, who_does_not_answer_is_told);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
