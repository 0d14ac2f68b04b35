/* The tick's boundary is the own SYNC on the bus, and what goes out is always safe. */
#include "firmware/control_task.h"
#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/devices/sea_drive_cia402.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

#include <string.h>

struct bench {
    struct fake_bus fake;
    struct control_params params;
    struct cia402_drives cia402;
    struct control_task task;
    bool stop_pressed;
};

static bool is_pressed(void *context)
{
    return ((const struct bench *)context)->stop_pressed;
}

static const struct emergency_stop_ops stop_ops = {is_pressed};

static struct control_params some_params(void)
{
    struct control_params params = {0};
    /* The middle of every range is a valid value of its field. */
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *d = &control_param_descriptors[i];
        *(real *)((char *)&params + d->offset) = d->minimum;
    }
    params.leg_length_m = 1.0f;
    params.angle_zero_left_rad = 0.0f;
    params.angle_zero_right_rad = 0.0f;
    params.ankle_zero_left_m = 0.0f;
    params.ankle_zero_right_m = 0.0f;
    params.law = (float)LAW_PROPORTIONAL;
    params.kp_m_s_rad = 0.042f;
    params.start_r0_m = 0.05f;
    params.r0_min_m = 0.01f;
    params.r0_max_m = 0.3f;
    params.r0_change_max_m = 0.05f;
    params.apex_window_s = 0.02f;
    params.angle_hysteresis_rad = 0.01f;
    params.sea_speed_max_m_s = 1.0f;
    params.sea_acceleration_m_s2 = 10.0f;
    params.sea_tolerance_m = 0.001f;
    params.sensor_age_max_s = 0.01f;
    params.step_timeout_s = 3.0f;
    params.fall_angle_rad = 1.2f;
    params.unload_timeout_s = 0.5f;
    params.table.count = SPEED_TABLE_MAX;
    params.table.r0_min_m = 0.01f;
    params.table.r0_step_m = 0.005f;
    for (int i = 0; i < SPEED_TABLE_MAX; i++) {
        params.table.speed_rad_s[i] = 0.2f + 0.015f * (float)i;
    }
    return params;
}

static void start(struct bench *b)
{
    static const struct cia402_axis_config axes[SIDE_COUNT] = {
        {.counts_per_m = 1.0e6f, .zero_counts = 0, .direction = 1, .rated_force_N = 0.0f},
        {.counts_per_m = 1.0e6f, .zero_counts = 0, .direction = 1, .rated_force_N = 0.0f}};
    memset(b, 0, sizeof *b);
    fake_bus_init(&b->fake);
    b->params = some_params();
    cia402_drives_init(&b->cia402, axes);
    struct control_task_config config = {
        .params = &b->params,
        .bus = fake_bus_interface(&b->fake),
        .drives = cia402_drives_interface(&b->cia402),
        .stop = {&stop_ops, b},
        .leg_sensor = {{.angle_direction = 1}, {.angle_direction = 1}},
        .desired_speed_rad_s = 0.4f,
        .walk_requested = true};
    ck_assert_int_eq(control_task_init(&b->task, &config), CONTROL_PARAMS_OK);
    /* As if on for long enough: a walk may begin. */
    b->task.now_ns = (uint64_t)CONTROL_TASK_START_TICK * TICK_PERIOD_US * 1000u;
    ck_assert_uint_eq(fake_bus_count(&b->fake, 0x710), 1); /* its boot-up message */
    fake_bus_clear(&b->fake);
}

static void put(struct bench *b, uint32_t id, uint8_t length, uint64_t data)
{
    struct can_msg frame = {.id = id, .length = length};
    memcpy(frame.data, &data, length);
    fake_bus_put(&b->fake, &frame);
}

static void put_own_sync(struct bench *b)
{
    const struct can_msg sync = {.id = 0x080, .flags = CAN_FRAME_OWN};
    fake_bus_put(&b->fake, &sync);
}

/* All four answers: drives at position 0 with this statusword, left leg ahead. */
static void put_answers(struct bench *b, uint16_t statusword)
{
    put(b, 0x181, 6, statusword);
    put(b, 0x182, 6, statusword);
    put(b, 0x283, 5, 0x050000); /* +0.12 rad */
    put(b, 0x284, 5, 0xFB0000); /* -0.12 rad */
}

static void put_heartbeats(struct bench *b)
{
    for (uint32_t node = 1; node <= 4; node++) {
        put(b, 0x700 + node, 1, 5);
    }
}

static void run_ticks(struct bench *b, int count, uint16_t statusword)
{
    for (int i = 0; i < count; i++) {
        put_heartbeats(b);
        put_answers(b, statusword);
        put_own_sync(b);
        if (b->fake.sent_count > FAKE_BUS_FRAMES - 16) {
            fake_bus_clear(&b->fake);
        }
        ck_assert(control_task_poll(&b->task) & CONTROL_TASK_TICKED);
    }
}

START_TEST(start_cycle_sends_an_empty_sync)
{
    struct bench b;
    start(&b);
    ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_OK);
    ck_assert_uint_eq(b.fake.sent_count, 1);
    ck_assert_uint_eq(b.fake.sent[0].id, 0x080);
    ck_assert_uint_eq(b.fake.sent[0].length, 0);
    /* While it has not been on the bus there is no other: no burst after a blocked bus. */
    for (int i = 1; i < CONTROL_TASK_SYNC_WAIT; i++) {
        ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_FULL);
    }
    ck_assert_uint_eq(b.fake.sent_count, 1);
    ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_OK); /* it seems lost */
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    b.fake.verdict = CAN_DOWN;
    ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_DOWN);
    ck_assert_uint_eq(b.task.node.objects.counters.syncs_refused, CONTROL_TASK_SYNC_WAIT);
    /* One that was under way when the bus went off is lost, not waited for. */
    b.fake.verdict = CAN_OK;
    ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_OK);
    ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_FULL);
    b.fake.verdict = CAN_DOWN;
    b.fake.status.error_state = CAN_BUS_OFF;
    ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_DOWN);
    b.fake.verdict = CAN_OK;
    b.fake.status.error_state = CAN_ERROR_ACTIVE;
    ck_assert_int_eq(control_task_start_cycle(&b.task), CAN_OK);
}
END_TEST

START_TEST(a_tick_runs_at_the_own_sync_and_only_there)
{
    struct bench b;
    start(&b);
    put_answers(&b, 0x0240);
    const struct can_msg foreign_sync = {.id = 0x080};
    fake_bus_put(&b.fake, &foreign_sync);
    ck_assert_uint_eq(control_task_poll(&b.task), 0);
    ck_assert_uint_eq(b.task.tick, 0);
    ck_assert_uint_eq(b.fake.sent_count, 0);
    put_own_sync(&b);
    ck_assert(control_task_poll(&b.task) & CONTROL_TASK_TICKED);
    ck_assert_uint_eq(b.task.tick, 1);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x201));
}
END_TEST

START_TEST(frames_belong_to_the_tick_of_the_next_sync)
{
    struct bench b;
    start(&b);
    put_own_sync(&b);
    put_answers(&b, 0x0240);
    (void)control_task_poll(&b.task);
    ck_assert(control_task_cycle_complete(&b.task));
    /* None had come before the first SYNC; but nobody was operational. */
    ck_assert_uint_eq(b.task.node.objects.counters.late_answers, 0);
    put_heartbeats(&b);
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    ck_assert(!control_task_cycle_complete(&b.task));
    ck_assert_uint_eq(b.task.node.objects.counters.late_answers, 0);
    put(&b, 0x283, 5, 0);
    put(&b, 0x284, 5, 0);
    put(&b, 0x181, 6, 0x0240);
    (void)control_task_poll(&b.task);
    ck_assert_msg(!control_task_cycle_complete(&b.task), "one answer is missing");
    put(&b, 0x182, 6, 0x0240);
    (void)control_task_poll(&b.task);
    ck_assert(control_task_cycle_complete(&b.task));
    put_own_sync(&b);
    put_own_sync(&b); /* in this cycle nobody answered: both legs */
    (void)control_task_poll(&b.task);
    ck_assert_uint_eq(b.task.node.objects.counters.late_answers, 2);
}
END_TEST

START_TEST(engages_when_all_is_well_and_loads_the_leg_in_front)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 60, 0x0240);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
    run_ticks(&b, 100, 0x1227);
    ck_assert(b.task.output.sea[SIDE_LEFT].enable && b.task.output.sea[SIDE_RIGHT].enable);
    assert_close(b.task.output.sea[SIDE_LEFT].precompression_m, 0.05, 0.03, 0.0);
    ck_assert(b.task.output.sea[SIDE_LEFT].precompression_m > 0.01f);
    ck_assert(b.task.output.sea[SIDE_RIGHT].precompression_m == 0.0f);
    ck_assert_msg(!b.task.output.sea[SIDE_LEFT].latch_armed, "armed before any apex");
}
END_TEST

/* A walk that is asked for at power-on waits, however early all is well. */
START_TEST(no_walk_begins_right_after_power_on)
{
    struct bench b;
    start(&b);
    b.task.now_ns = 0;
    run_ticks(&b, CONTROL_TASK_START_TICK - 1, 0x0240);
    ck_assert_uint_eq(b.task.tick, CONTROL_TASK_START_TICK - 1);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_STANDBY);
    run_ticks(&b, 2, 0x0240);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
}
END_TEST

START_TEST(emergency_stop_is_obeyed_and_told)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
    b.stop_pressed = true;
    fake_bus_clear(&b.fake);
    run_ticks(&b, 1, 0x1227);
    const struct can_msg *state = fake_bus_last(&b.fake, 0x290);
    ck_assert_ptr_nonnull(state);
    ck_assert_uint_eq(state->data[0], 0x80 | SUPERVISOR_UNLOADING);
    ck_assert_uint_eq(state->data[1], SUPERVISOR_FAULT_EMERGENCY_STOP);
    b.stop_pressed = false;
    run_ticks(&b, 1000, 0x1227);
    ck_assert_msg(b.task.output.state == SUPERVISOR_FAULT, "let go, and it forgot: state %d",
                  (int)b.task.output.state);
    ck_assert(!b.task.output.sea[SIDE_LEFT].enable && !b.task.output.sea[SIDE_RIGHT].enable);
    ck_assert_int_eq(b.cia402.axis[SIDE_LEFT].sender.sent_controlword,
                     0x06); /* out of operation enabled */
}
END_TEST

/* Loses one leg's frames for n ticks; says the state after. */
static enum supervisor_state lose_leg_frames(int ticks)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    for (int i = 0; i < ticks; i++) {
        put_heartbeats(&b);
        put(&b, 0x181, 6, 0x1227);
        put(&b, 0x182, 6, 0x1227);
        put(&b, 0x284, 5, 0xFB0000);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
    }
    return b.task.output.state;
}

START_TEST(a_lost_frame_is_bridged_a_lost_sensor_is_not)
{
    ck_assert_int_eq(lose_leg_frames(1), SUPERVISOR_ENGAGING);
    ck_assert_int_eq(lose_leg_frames(10), SUPERVISOR_ENGAGING);
    ck_assert_int_eq(lose_leg_frames(11), SUPERVISOR_UNLOADING);
    ck_assert_int_eq(lose_leg_frames(12), SUPERVISOR_UNLOADING); /* until the references are back */
    ck_assert_int_eq(lose_leg_frames(400), SUPERVISOR_FAULT);
}
END_TEST

/* Each leg whose sensor or drive has not answered in its tick counts once. */
START_TEST(late_answers_are_counted_by_leg)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 20, 0x0250);
    const uint32_t before = b.task.node.objects.counters.late_answers;
    put_heartbeats(&b);
    put(&b, 0x182, 6, 0x0250);
    put(&b, 0x283, 5, 0x050000); /* of the left leg the sensor alone, of the right the drive */
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    ck_assert_uint_eq(b.task.node.objects.counters.late_answers, before + 2);
    run_ticks(&b, 20, 0x0250);
    ck_assert_uint_eq(b.task.node.objects.counters.late_answers, before + 2);
}
END_TEST

/* Whatever only the controller may send. All nodes are stopped in the same tick: no command
 * of ours could outdo the other's. */
static const struct {
    uint32_t id;
    uint8_t length;
} masters[] = {{0x080, 0}, {0x201, 8}, {0x301, 6}, {0x302, 6}, {0x710, 1}, {0x201, 3}};

START_TEST(somebody_elses_commands_are_a_fault)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
    ck_assert_ptr_null(fake_bus_last(&b.fake, 0x000));
    fake_bus_clear(&b.fake);
    put(&b, masters[_i].id, masters[_i].length, 5);
    run_ticks(&b, 1, 0x1227);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_UNLOADING);
    ck_assert_int_eq(b.task.output.fault, SUPERVISOR_FAULT_FOREIGN);
    const struct can_msg *stop = fake_bus_last(&b.fake, 0x000);
    ck_assert_ptr_nonnull(stop);
    ck_assert_uint_eq(stop->data[0], 2);
    ck_assert_uint_eq(stop->data[1], 0);
    ck_assert_uint_eq(b.task.node.objects.counters.forced_stops, 1);
}
END_TEST

static void put_sdo(struct bench *b, uint32_t id, uint8_t command, uint16_t index, uint8_t sub)
{
    struct can_msg message = {.id = id, .length = 8, .data = {command}};
    bytes_put_u16(message.data + 1, index);
    message.data[3] = sub;
    fake_bus_put(&b->fake, &message);
}

/* Whatever it writes and however it begins. The links are alive: the controller unloads by its own
 * targets and stops nobody, for what was written may be what a drive does when it is stopped. */
START_TEST(a_tool_that_writes_to_a_node_is_a_fault)
{
    static const uint8_t downloads[] = {0x2B, 0x23, 0x22, 0x21, 0x20, 0x00, 0x1F, 0xC6, 0xC1};
    for (uint32_t node = 1; node <= 4; node++) {
        struct bench b;
        start(&b);
        run_ticks(&b, 110, 0x1227);
        ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
        fake_bus_clear(&b.fake);
        put_sdo(&b, 0x600 + node, downloads[_i], 0x6007, 0);
        run_ticks(&b, 1, 0x1227);
        ck_assert_int_eq(b.task.output.state, SUPERVISOR_UNLOADING);
        ck_assert_int_eq(b.task.output.fault, SUPERVISOR_FAULT_NODE_WRITTEN);
        ck_assert_ptr_null(fake_bus_last(&b.fake, 0x000));
        ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x201));
        ck_assert_ptr_nonnull(
            fake_bus_last(&b.fake, 0x301)); /* told again: it may have been told */
        ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x302)); /* otherwise */
        ck_assert_uint_eq(b.task.node.objects.tool_node, node);
        const bool named = downloads[_i] >> 5 == 1;
        ck_assert_uint_eq(b.task.node.objects.tool_index, named ? 0x6007 : 0);
        ck_assert_uint_eq(b.task.node.objects.counters.foreign_downloads, 1);
        const struct can_msg *told = fake_bus_last(&b.fake, 0x090);
        ck_assert_ptr_nonnull(told);
        ck_assert_uint_eq(told->data[4], SUPERVISOR_FAULT_NODE_WRITTEN);
        ck_assert_uint_eq(told->data[5], node);
        ck_assert_uint_eq(bytes_get_u16(told->data + 6), named ? 0x6007 : 0);
    }
}
END_TEST

/* By the numbers that the nodes have, whatever these are. */
START_TEST(a_tool_is_noticed_whatever_the_nodes_numbers)
{
    static const uint8_t numbers[NETWORK_NODES] = {21, 22, 33, 34};
    struct bench b;
    start(&b);
    network_set_nodes(&b.task.network, numbers);
    for (int i = 0; i < 110; i++) {
        for (int node = 0; node < 4; node++) {
            put(&b, 0x700u + numbers[node], 1, 5);
        }
        put_answers(&b, 0x1227);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
    }
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
    put_sdo(&b, 0x600 + 5, 0x2B, 0x6007, 0); /* of no node of this device */
    put_answers(&b, 0x1227);
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
    put_sdo(&b, 0x600u + numbers[_i], 0x2B, 0x6007, 0);
    put_answers(&b, 0x1227);
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_UNLOADING);
    ck_assert_int_eq(b.task.output.fault, SUPERVISOR_FAULT_NODE_WRITTEN);
    ck_assert_uint_eq(b.task.node.objects.tool_node, numbers[_i]);
}
END_TEST

/* Loaded, and its motor stands: a tick with the left drive at 0.2 m. */
static void run_stuck_ticks(struct bench *b, int count)
{
    for (int i = 0; i < count; i++) {
        put_heartbeats(b);
        put(b, 0x181, 6, UINT64_C(200000) << 16 | 0x1227);
        put(b, 0x182, 6, 0x1227);
        put(b, 0x283, 5, 0x050000);
        put(b, 0x284, 5, 0xFB0000);
        put_own_sync(b);
        (void)control_task_poll(&b->task);
    }
}

START_TEST(a_written_drive_that_does_not_follow_is_stopped)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    put_sdo(&b, 0x601, 0x23, 0x6080, 0);
    run_stuck_ticks(&b, 1);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_UNLOADING);
    fake_bus_clear(&b.fake);
    run_stuck_ticks(&b, 25);
    ck_assert_ptr_null(fake_bus_last(&b.fake, 0x000)); /* it has time to */
    run_stuck_ticks(&b, 100);
    const struct can_msg *stop = fake_bus_last(&b.fake, 0x000);
    ck_assert_ptr_nonnull(stop);
    ck_assert_uint_eq(stop->data[0], 2);
    ck_assert_uint_eq(stop->data[1], 1); /* that one alone */
}
END_TEST

/* For that it is stopped while the controller unloads, and not in another state: at power-up there is nothing to
 * follow, and in FAULT a drive is given 50 ms to obey, whoever wrote to it. */
START_TEST(a_written_drive_is_to_follow_while_it_unloads_only)
{
    struct bench b;
    start(&b);
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    put_sdo(&b, 0x601, 0x23, 0x6080, 0);
    for (int i = 0; i < 100; i++) {
        put(&b, 0x181, 6, UINT64_C(200000) << 16 | 0x1227);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
        ck_assert_int_eq(b.task.output.state, SUPERVISOR_INIT);
        ck_assert_ptr_null(fake_bus_last(&b.fake, 0x000));
        fake_bus_clear(&b.fake);
    }
    start(&b);
    run_ticks(&b, 110, 0x1227);
    b.stop_pressed = true;
    run_ticks(&b, 600, 0x0221);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_FAULT);
    const uint32_t before = b.task.node.objects.counters.forced_stops;
    put_sdo(&b, 0x601, 0x23, 0x6080, 0);
    for (int i = 1; i <= 50; i++) {
        ck_assert_uint_eq(b.task.node.objects.counters.forced_stops, before);
        run_stuck_ticks(&b, 1);
        fake_bus_clear(&b.fake);
    }
    ck_assert_uint_eq(b.task.node.objects.counters.forced_stops, before + 2); /* both are enabled */
}
END_TEST

/* What it does when it is stopped is no longer known: it is shut down by its controlword. */
START_TEST(where_a_stop_may_mean_nothing_a_drive_is_shut_down)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    put_sdo(&b, 0x601, 0x2B, 0x6007, 0);
    run_stuck_ticks(&b, 126);
    ck_assert_ptr_null(fake_bus_last(&b.fake, 0x000));
    ck_assert_uint_eq(bytes_get_u16(fake_bus_last(&b.fake, 0x301)->data), 0x06);
    ck_assert_uint_eq(bytes_get_u16(fake_bus_last(&b.fake, 0x302)->data), 0x0F);
}
END_TEST

START_TEST(a_tool_that_reads_is_counted_and_no_more)
{
    static const uint8_t uploads[] = {0x40, 0x60, 0x70, 0x80, 0xA0};
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    fake_bus_clear(&b.fake);
    for (uint32_t node = 1; node <= 4; node++) {
        for (size_t i = 0; i < sizeof uploads; i++) {
            put_sdo(&b, 0x600 + node, uploads[i], 0x6041, 0);
        }
    }
    put(&b, 0x601, 7, 0x2B); /* no SDO: it has not eight bytes */
    run_ticks(&b, 5, 0x1227);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING);
    ck_assert_uint_eq(b.task.node.objects.counters.foreign_uploads, 20);
    ck_assert_uint_eq(b.task.node.objects.counters.foreign_downloads, 0);
    ck_assert_uint_eq(b.task.node.objects.counters.foreign_frames, 1);
    ck_assert_uint_eq(b.task.node.objects.tool_node, 0);
}
END_TEST

/* Two different answers of one node in a cycle, twice. */
START_TEST(somebody_elses_answers_are_a_fault)
{
    static const uint32_t ids[] = {0x181, 0x182, 0x283, 0x284};
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    put(&b, ids[_i], _i < 2 ? 6 : 5, 0x1226);
    run_ticks(&b, 1, 0x1227);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_ENGAGING); /* one may have been late */
    put(&b, ids[_i], _i < 2 ? 6 : 5, 0x1226);
    run_ticks(&b, 1, 0x1227);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_UNLOADING);
    ck_assert_int_eq(b.task.output.fault, SUPERVISOR_FAULT_FOREIGN);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x000));
}
END_TEST

/* A drive in fault from power-up on: not waited for without end. */
START_TEST(what_is_wrong_with_the_nodes_at_power_up_is_a_fault)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 450, 0x0218);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_INIT);
    run_ticks(&b, 100, 0x0218);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_FAULT);
    ck_assert_int_eq(b.task.output.fault, SUPERVISOR_FAULT_DRIVE);
    start(&b);
    put(&b, 0x082, 8, 0x4310); /* as its emergency says it */
    run_ticks(&b, 550, 0x0240);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_FAULT);
    ck_assert_int_eq(b.task.output.fault, SUPERVISOR_FAULT_NODE_LOST);
    start(&b);
    for (int i = 0; i < 5000; i++) { /* a node that is not there may still come */
        put(&b, 0x701, 1, 5);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
        fake_bus_clear(&b.fake);
    }
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_INIT);
}
END_TEST

/* Enabled 50 ticks after the controller is in FAULT: out of NMT operational. */
START_TEST(a_drive_that_stays_enabled_is_stopped)
{
    struct bench b;
    start(&b);
    run_ticks(&b, 110, 0x1227);
    b.stop_pressed = true;
    run_ticks(&b, 500, 0x1227);
    ck_assert_int_eq(b.task.output.state, SUPERVISOR_FAULT);
    for (int i = 0; i < 30; i++) { /* a corrupt statusword now and then does not hide it */
        run_ticks(&b, 4, 0x1227);
        run_ticks(&b, 1, 0x0221);
    }
    ck_assert_uint_gt(b.task.node.objects.counters.forced_stops, 0);
    const struct can_msg *stop = fake_bus_last(&b.fake, 0x000);
    ck_assert_ptr_nonnull(stop);
    ck_assert_uint_eq(stop->data[0], 2);
    ck_assert_uint_ge(stop->data[1], 1);
    ck_assert_uint_le(stop->data[1], 2);
    for (int i = 0; i < 200; i++) { /* gone silent: what it said last is of the past */
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
        fake_bus_clear(&b.fake);
    }
    const uint32_t stops = b.task.node.objects.counters.forced_stops;
    for (int i = 0; i < 500; i++) {
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
        fake_bus_clear(&b.fake);
    }
    ck_assert_uint_eq(b.task.node.objects.counters.forced_stops, stops);
}
END_TEST

/* A drive that hangs, or keeps its torque, after a stop: only the hardware can help. */
START_TEST(the_power_must_go_when_a_drive_cannot_be_trusted)
{
    static const uint16_t statuswords[] = {0x1227, 0x0207, 0x020F, 0x0223};
    struct bench b;
    for (int silent = 0; silent < 2; silent++) {
        for (size_t i = 0; i < sizeof statuswords / sizeof statuswords[0]; i++) {
            start(&b);
            run_ticks(&b, 110, 0x1227);
            b.stop_pressed = true;
            run_ticks(&b, 600, 0x0221);
            ck_assert_int_eq(b.task.output.state, SUPERVISOR_FAULT);
            ck_assert(!control_task_power_must_go(&b.task)); /* both are off */
            for (int tick = 0; tick <= DRIVE_WATCH_POWER_TICKS + 60; tick++) {
                fake_bus_clear(&b.fake);
                ck_assert(tick >= DRIVE_WATCH_POWER_TICKS || !control_task_power_must_go(&b.task));
                put_heartbeats(&b);
                put(&b, 0x181, 6, 0x0221);
                if (!silent) {
                    put(&b, 0x182, 6, statuswords[i]);
                }
                put_own_sync(&b);
                (void)control_task_poll(&b.task);
            }
            ck_assert(control_task_power_must_go(&b.task));
            /* Without torque it reports that it is off: the power stays away until the relay has fallen, too. */
            run_ticks(&b, DRIVE_WATCH_HOLD_TICKS, 0x0218);
            ck_assert(control_task_power_must_go(&b.task));
            run_ticks(&b, 1, 0x0218);
            ck_assert(!control_task_power_must_go(&b.task));
        }
    }
}
END_TEST

/* A drive that comes down is led to an empty spring, however long that may take; one that answers and stands has half
 * a second, as one that is silent, and not the time of an unload. */
START_TEST(a_drive_that_is_led_keeps_its_power_while_it_unloads)
{
    const bool stands = _i == 1;
    struct bench b;
    start(&b);
    b.params.unload_timeout_s = 2.0f;
    b.task.node.objects.params.unload_timeout_s = 2.0f;
    b.task.node.objects.params_crc = params_guard_crc(&b.task.node.objects.params);
    run_ticks(&b, 110, 0x1227);
    ck_assert(supervisor_may_enable(b.task.output.state));
    int unloading = 0;
    bool over = false;
    for (int64_t counts = 0; !control_task_power_must_go(&b.task) && !over;) {
        counts += b.stop_pressed ? (stands ? 0 : -20) : 2000;
        b.stop_pressed = b.stop_pressed || counts >= 40000; /* 40 mm of spring */
        fake_bus_clear(&b.fake);
        put_heartbeats(&b);
        put(&b, 0x181, 6, 0x1227 | (uint64_t)(counts > 0 ? counts : 0) << 16);
        put(&b, 0x182, 6, 0x1227);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
        unloading += b.task.output.state == SUPERVISOR_UNLOADING ? 1 : 0;
        over = unloading > 0 && b.task.output.state != SUPERVISOR_UNLOADING;
    }
    ck_assert(over != stands);
    if (stands) {
        ck_assert_int_ge(unloading, DRIVE_WATCH_POWER_TICKS);
        ck_assert_int_le(unloading, DRIVE_WATCH_POWER_TICKS +
                                        TICKS_OF_MS(150)); /* its target leaves it first */
    } else {
        ck_assert_int_ge(unloading, 1900);
    }
}
END_TEST

START_TEST(parameters_out_of_range_are_refused)
{
    struct bench b;
    start(&b);
    struct control_task_config config = b.task.config;
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        struct control_params params = some_params();
        real *field = (real *)((char *)&params + control_param_descriptors[i].offset);
        config.params = &params;
        *field = control_param_descriptors[i].maximum * 1.01f + 1e-6f;
        ck_assert_int_eq(control_task_init(&b.task, &config), i);
        *field = (real)(0.0f / 0.0f);
        ck_assert_int_eq(control_task_init(&b.task, &config), i);
    }
}
END_TEST

/* 49.7 days after its start the tick counter wraps; nothing else may notice. */
START_TEST(the_tick_counter_may_wrap)
{
    static struct bench wraps, does_not;
    start(&wraps);
    start(&does_not);
    wraps.task.tick = UINT32_MAX - 50;
    for (int i = 0; i < 12; i++) {
        fake_bus_clear(&wraps.fake);
        fake_bus_clear(&does_not.fake);
        run_ticks(&wraps, 25, 0x1227);
        run_ticks(&does_not, 25, 0x1227);
        ck_assert_uint_eq(wraps.fake.sent_count, does_not.fake.sent_count);
        for (unsigned k = 0; k < wraps.fake.sent_count; k++) {
            ck_assert_mem_eq(&wraps.fake.sent[k], &does_not.fake.sent[k], sizeof(struct can_msg));
        }
        ck_assert_int_eq(wraps.task.output.state, does_not.task.output.state);
    }
    ck_assert_uint_lt(wraps.task.tick, 1000);
}
END_TEST

/* A drive that says 402 to every question, or nothing. */
static void run_setup(struct bench *b, int ticks, bool answers)
{
    for (int i = 0; i < ticks; i++) {
        fake_bus_clear(&b->fake);
        put(b, 0x701, 1, 127);
        put_own_sync(b);
        (void)control_task_poll(&b->task);
        const struct can_msg *request = fake_bus_last(&b->fake, 0x601);
        if (request != NULL && answers) {
            uint64_t answer = UINT64_C(402) << 32; /* the profile, as 0x1000 says it */
            memcpy(&answer, request->data, 4);
            answer = (answer & ~UINT64_C(0xFF)) | (request->data[0] == 0x40 ? 0x43 : 0x60);
            put(b, 0x581, 8, answer);
        }
    }
}

START_TEST(a_node_that_was_silent_at_set_up_is_asked_again)
{
    struct bench b;
    start(&b);
    b.task.config.configure_nodes = true;
    run_setup(&b, 1, false);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x601));
    run_setup(&b, 10 * SETUP_TIMEOUT_MS, false); /* however often it repeats: it gives up */
    ck_assert_uint_eq(b.task.node.objects.refused_node, 1);
    ck_assert_uint_eq(b.task.node.objects.refused_verdict, 3);
    run_setup(&b, SETUP_TIMEOUT_MS + SETUP_SETTLE_MS + 10, true);
    ck_assert_uint_eq(b.task.node.objects.refused_index,
                      0x1017); /* past the question that was lost */
}
END_TEST

/* Powered before the controller, heartbeat time 0 (the default of every drive in CiA 402's field): it says nothing until
 * it is asked. */
START_TEST(a_node_that_says_nothing_is_found_by_asking)
{
    struct bench b;
    unsigned asked[5] = {0};
    start(&b);
    b.task.config.configure_nodes = true;
    for (int i = 0; i < 3000; i++) {
        fake_bus_clear(&b.fake);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
        for (uint32_t node = 1; node <= 4; node++) {
            const struct can_msg *request = fake_bus_last(&b.fake, 0x600 + node);
            if (request != NULL) {
                /* Upload of 0x1000, or the abort of one that nobody answered: neither changes anything. */
                ck_assert(request->data[0] == 0x40 || request->data[0] == 0x80);
                ck_assert_uint_eq(request->data[1] | request->data[2] << 8, 0x1000);
                asked[node]++;
            }
        }
        ck_assert_ptr_null(fake_bus_last(&b.fake, 0x301)); /* and no command before */
        ck_assert_ptr_null(fake_bus_last(&b.fake, 0x201));
    }
    for (int node = 1; node <= 4; node++) {
        ck_assert_uint_ge(asked[node], 2);
    }
    ck_assert_uint_eq(b.task.node.objects.refused_node, 0); /* absent is not refused */
    /* One answers: its set-up goes on, though no heartbeat has come yet. */
    bool found = false;
    for (int i = 0; i < 3000 && !found; i++) {
        fake_bus_clear(&b.fake);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
        const struct can_msg *request = fake_bus_last(&b.fake, 0x602);
        if (request != NULL) {
            uint64_t answer = UINT64_C(402) << 32;
            memcpy(&answer, request->data, 4);
            answer = (answer & ~UINT64_C(0xFF)) | (request->data[0] == 0x40 ? 0x43 : 0x60);
            put(&b, 0x582, 8, answer);
            found = request->data[1] == 0x17; /* producer heartbeat time */
        }
    }
    ck_assert(found);
}
END_TEST

/* Somebody who waits to be set up does not wait for the silent ones. */
START_TEST(a_scan_gives_way_to_a_node_that_speaks)
{
    struct bench b;
    start(&b);
    b.task.config.configure_nodes = true;
    for (int i = 0; i < HEARTBEAT_TIMEOUT_MS + 5; i++) {
        fake_bus_clear(&b.fake);
        put_own_sync(&b);
        (void)control_task_poll(&b.task);
    }
    ck_assert(b.task.bring_up.scanning);
    fake_bus_clear(&b.fake);
    put(&b, 0x704, 1, 0);
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    ck_assert(!b.task.bring_up.scanning);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x604));
}
END_TEST

/* Error frames carry the controller's counters, not a node's words; the count stays at its end. */
START_TEST(error_frames_are_counted_and_used_for_nothing)
{
    const struct can_msg error = {.id = 0x080, .length = 8, .flags = CAN_FRAME_ERROR};
    const struct can_msg own = {.id = 0x201, .length = 6, .flags = CAN_FRAME_OWN};
    struct bench b;
    start(&b);
    fake_bus_put(&b.fake, &error);
    fake_bus_put(&b.fake, &own); /* its own, but no SYNC: no tick either */
    ck_assert_uint_eq(control_task_poll(&b.task) & CONTROL_TASK_TICKED, 0);
    ck_assert_uint_eq(b.task.node.objects.counters.error_frames, 1);
    ck_assert_uint_eq(b.task.node.objects.counters.foreign_frames, 0);
    b.task.node.objects.counters.error_frames = UINT32_MAX;
    fake_bus_put(&b.fake, &error);
    (void)control_task_poll(&b.task);
    ck_assert_uint_eq(b.task.node.objects.counters.error_frames, UINT32_MAX);
}
END_TEST

/* A node that boots while it is being set up has forgotten what it was told: from the start. */
START_TEST(a_node_that_boots_during_its_set_up_starts_over)
{
    struct bench b;
    start(&b);
    b.task.config.configure_nodes = true;
    run_setup(&b, 20, true);
    ck_assert_uint_eq(b.task.bring_up.setup.node, 1);
    const unsigned step = b.task.bring_up.setup.step;
    ck_assert_uint_gt(step, 0);
    put(&b, 0x701, 1, 0); /* boot-up */
    run_setup(&b, 1, true);
    ck_assert_uint_eq(b.task.bring_up.setup.node, 1);
    ck_assert_uint_lt(b.task.bring_up.setup.step, step);
}
END_TEST

/* A stopped node answers no SDO (CiA 301): nothing is asked of it until it may be started. */
START_TEST(a_node_that_is_stopped_is_set_up_later)
{
    struct bench b;
    start(&b);
    b.task.config.configure_nodes = true;
    run_setup(&b, 2, true);
    ck_assert_uint_eq(b.task.bring_up.setup.node, 1);
    ck_assert_int_eq(network_stop_all(&b.task.network, &b.task.config.bus), CAN_OK);
    for (int tick = 1; tick < NETWORK_STOP_TICKS; tick++) {
        run_setup(&b, 1, false);
        ck_assert_ptr_null(fake_bus_last(&b.fake, 0x601));
    }
    ck_assert_uint_eq(b.task.node.objects.refused_node, 0); /* it was not silent: not asked */
    run_setup(&b, 2, false);
    ck_assert_uint_eq(b.task.bring_up.setup.node, 1);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x601));
}
END_TEST

/* What 0x2020:sub says over SDO. */
static uint32_t counter_of(struct bench *b, uint8_t sub)
{
    put(b, 0x610, 8, UINT64_C(0x00202040) | (uint64_t)sub << 24);
    (void)control_task_poll(&b->task);
    const struct can_msg *answer = fake_bus_last(&b->fake, 0x590);
    ck_assert_ptr_nonnull(answer);
    ck_assert_uint_eq(answer->data[0], sub == 0 ? 0x4F : 0x43); /* expedited, 1 or 4 bytes */
    ck_assert_uint_eq(answer->data[3], sub);
    uint32_t value;
    memcpy(&value, answer->data + 4, sizeof value);
    return value;
}

static uint32_t word_of(struct bench *b, uint16_t index, uint8_t sub)
{
    put(b, 0x610, 8, UINT64_C(0x40) | (uint64_t)index << 8 | (uint64_t)sub << 24);
    (void)control_task_poll(&b->task);
    const struct can_msg *answer = fake_bus_last(&b->fake, 0x590);
    ck_assert_ptr_nonnull(answer);
    ck_assert_uint_eq(answer->data[0] & 0xE3, 0x43);
    return answer->data[4] | (uint32_t)answer->data[5] << 8;
}

START_TEST(what_the_drives_tell_of_themselves_can_be_read)
{
    struct bench b;
    start(&b);
    put(&b, 0x381, 8, UINT64_C(0x00005D8E01C80000)); /* 45.6 degC, 23.95 V */
    put_answers(&b, 0x02B7);                         /* with a warning */
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    ck_assert_uint_eq(word_of(&b, 0x2021, 1), 456);
    ck_assert_uint_eq(word_of(&b, 0x2021, 2), 0);
    ck_assert_uint_eq(word_of(&b, 0x2021, 3), 2395);
    ck_assert_uint_eq(word_of(&b, 0x2021, 5) & 0xFF, 3);
}
END_TEST

START_TEST(what_was_counted_can_be_read_over_the_bus)
{
    const struct can_msg error = {.id = 0x080, .length = 8, .flags = CAN_FRAME_ERROR};
    struct bench b;
    start(&b);
    run_ticks(&b, 3, 0x0240);
    ck_assert_uint_eq(counter_of(&b, 0), 29);
    control_task_show_cycles(&b.task, 9000);
    control_task_show_cycles(&b.task, 8000); /* the most counts */
    ck_assert_uint_eq(counter_of(&b, 28), 9000);
    ck_assert_uint_eq(counter_of(&b, 1), 3); /* ticks */
    for (uint8_t sub = 2; sub <= 12; sub++) {
        ck_assert_uint_eq(counter_of(&b, sub), 0);
    }
    fake_bus_put(&b.fake, &error);
    put(&b, 0x7FF, 0, 0); /* nobody's */
    put(&b, 0x181, 5, 0); /* too short: a drive's, */
    put(&b, 0x283, 8, 0); /* too long: a sensor's, */
    put(&b, 0x610, 3, 0); /* too short: to this node */
    put(&b, 0x284, 4, 0);
    put_own_sync(&b); /* without answers of both legs */
    b.fake.status = (struct can_bus_status){.tx_refused = 5, .rx_overflow = 6, .bus_off_count = 7};
    control_task_show_missed(&b.task, 8);
    b.task.node.objects.counters.forced_stops = 9;
    static const uint32_t expected[] = {4, 0, 0, 1, 1, 2, 9, 8, 4, 5, 6, 7};
    for (uint8_t sub = 1; sub <= 12; sub++) {
        ck_assert_uint_eq(counter_of(&b, sub), expected[sub - 1]);
    }
    b.fake.verdict = CAN_FULL; /* the bus takes neither commands nor the next SYNC */
    put_own_sync(&b);
    (void)control_task_poll(&b.task);
    (void)control_task_start_cycle(&b.task);
    b.fake.verdict = CAN_OK;
    ck_assert_uint_eq(counter_of(&b, 2), 1);
    ck_assert_uint_eq(counter_of(&b, 3), 1);
    b.task.sensors.rx_malformed = UINT32_MAX; /* the sum stays at its end, too */
    ck_assert_uint_eq(counter_of(&b, 9), UINT32_MAX);
}
END_TEST

START_TEST(a_poll_is_bounded)
{
    struct bench b;
    start(&b);
    for (int i = 0; i < FAKE_BUS_FRAMES; i++) {
        put(&b, 0x7FF, 0, 0);
    }
    (void)control_task_poll(&b.task);
    ck_assert_uint_eq(b.task.node.objects.counters.foreign_frames, CONTROL_TASK_POLL_FRAMES);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("control_task");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, start_cycle_sends_an_empty_sync);
    tcase_add_test(tests, a_tick_runs_at_the_own_sync_and_only_there);
    tcase_add_test(tests, frames_belong_to_the_tick_of_the_next_sync);
    tcase_add_test(tests, engages_when_all_is_well_and_loads_the_leg_in_front);
    tcase_add_test(tests, emergency_stop_is_obeyed_and_told);
    tcase_add_test(tests, a_lost_frame_is_bridged_a_lost_sensor_is_not);
    tcase_add_test(tests, late_answers_are_counted_by_leg);
    tcase_add_loop_test(tests, somebody_elses_commands_are_a_fault, 0,
                        (int)(sizeof masters / sizeof masters[0]));
    tcase_add_loop_test(tests, a_tool_that_writes_to_a_node_is_a_fault, 0, 9);
    tcase_add_loop_test(tests, a_tool_is_noticed_whatever_the_nodes_numbers, 0, 4);
    tcase_add_test(tests, a_tool_that_reads_is_counted_and_no_more);
    tcase_add_test(tests, a_written_drive_that_does_not_follow_is_stopped);
    tcase_add_test(tests, where_a_stop_may_mean_nothing_a_drive_is_shut_down);
    tcase_add_test(tests, a_written_drive_is_to_follow_while_it_unloads_only);
    tcase_add_loop_test(tests, somebody_elses_answers_are_a_fault, 0, 4);
    tcase_add_test(tests, what_is_wrong_with_the_nodes_at_power_up_is_a_fault);
    tcase_add_test(tests, a_drive_that_stays_enabled_is_stopped);
    tcase_add_test(tests, the_power_must_go_when_a_drive_cannot_be_trusted);
    tcase_add_loop_test(tests, a_drive_that_is_led_keeps_its_power_while_it_unloads, 0, 2);
    tcase_add_test(tests, parameters_out_of_range_are_refused);
    tcase_add_test(tests, the_tick_counter_may_wrap);
    tcase_add_test(tests, a_node_that_was_silent_at_set_up_is_asked_again);
    tcase_add_test(tests, error_frames_are_counted_and_used_for_nothing);
    tcase_add_test(tests, a_node_that_boots_during_its_set_up_starts_over);
    tcase_add_test(tests, a_node_that_is_stopped_is_set_up_later);
    tcase_add_test(tests, what_was_counted_can_be_read_over_the_bus);
    tcase_add_test(tests, a_poll_is_bounded);
    tcase_add_test(tests, a_node_that_says_nothing_is_found_by_asking);
    tcase_add_test(tests, a_scan_gives_way_to_a_node_that_speaks);
    tcase_add_test(tests, what_the_drives_tell_of_themselves_can_be_read);
    tcase_add_test(tests, no_walk_begins_right_after_power_on);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
