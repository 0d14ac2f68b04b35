/* The SEA drive as a CiA 402 device on the bus. The statusword values are those of
 * can-facts, which the Python package canopen shares. */
#include <check.h>
#include <string.h>

#include "hal/bus/bytes.h"
#include "sim_host/nodes/drive_node.h"
#include "tests/support/assert_close.h"
#include "tests/support/node_bench.h"

enum { COUNTS_PER_M = 1000000, NODE = 1 };

static struct bench bench;
static struct drive_node node;
static struct drive_axis_command command;
static double motor_m; /* a motor that reaches its demand within the period */
static bool motor_is_stuck;
static double fastest_m_per_s; /* of the demand since it was last cleared */
static uint64_t powered_ticks;

static void poll_node(void *context, uint64_t now_ns)
{
    (void)drive_node_poll(context, now_ns);
}

static void measure(void)
{
    const struct drive_axis_feedback feedback = {.position_m = motor_m,
                                                 .temperature_degC = 25.0,
                                                 .dc_link_V = 48.0,
                                                 .force_N = 20.0 * motor_m,
                                                 .latch_holds = true};
    drive_node_measure(&node, &feedback);
}

static void period(void *context)
{
    drive_node_command(context, BENCH_TICK_NS, &command);
    if (command.powered && !motor_is_stuck) {
        const double moved = command.target_m - motor_m;
        const double speed = (moved < 0 ? -moved : moved) * 1000.0;
        fastest_m_per_s = speed > fastest_m_per_s ? speed : fastest_m_per_s;
        motor_m = command.target_m;
    }
    powered_ticks += command.powered ? 1 : 0;
    measure();
}

static void setup(void)
{
    const struct drive_node_config config = {.side = SIDE_LEFT,
                                             .node_id = NODE,
                                             .counts_per_m = COUNTS_PER_M,
                                             .stroke_m = 0.3,
                                             .max_speed_m_per_s = 2.0,
                                             .rated_force_N = 10.0,
                                             .following_error_m = 0.02,
                                             .unload_rate_m_per_s = 0.5,
                                             .temperature_limit_degC = 100.0,
                                             .dc_link_minimum_V = 20.0};
    motor_m = 0.0;
    motor_is_stuck = false;
    bench_init(&bench, NODE, poll_node, period, &node);
    ck_assert_int_eq(drive_node_init(&node, &config, bench.node_bus, 0), 0);
    measure();
    bench.syncs = true;
    bench.heartbeats = true;
}

static unsigned status(void)
{
    const struct can_msg *frame = bench_last(&bench, 0x181);
    return frame == NULL ? 0xFFFFU : bytes_get_u16(frame->data);
}

static void control(uint16_t word)
{
    uint8_t data[6] = {0};
    bytes_put_u16(data, word);
    bench_send(&bench, 0x301, 6, data);
    bench_run(&bench, 2);
}

static void control_armed(uint16_t word)
{
    uint8_t data[6] = {0};
    bytes_put_u16(data, word);
    data[4] = 1;
    bench_send(&bench, 0x301, 6, data);
    bench_run(&bench, 2);
}

static void target(double position_m)
{
    uint8_t data[8] = {0};
    bytes_put_u32(data, (uint32_t)(int32_t)(position_m * COUNTS_PER_M));
    bytes_put_u32(data + 4, 0x55555555); /* the other drive's */
    bench_send(&bench, 0x201, 8, data);
    bench_run(&bench, 1);
}

/* Holds a target for some ticks, as a living master would. */
static void hold(double position_m, unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        target(position_m);
    }
}

static void enable(void)
{
    bench_nmt(&bench, 1);
    control(0x06);
    ck_assert_uint_eq(status() & 0x6F, 0x21);
    control(0x07);
    ck_assert_uint_eq(status() & 0x6F, 0x23);
    control(0x0F);
    ck_assert_uint_eq(status() & 0x6F, 0x27);
}

static unsigned last_emcy(void)
{
    const struct can_msg *frame = bench_last(&bench, 0x081);
    return frame == NULL ? 0xFFFFU : bytes_get_u16(frame->data);
}

START_TEST(boots_as_cia_301_says)
{
    bench_run(&bench, 1);
    ck_assert_uint_eq(bench.seen[0].id, 0x701);
    ck_assert_uint_eq(bench.seen[0].data[0], 0);
    bench_run(&bench, 120);
    ck_assert_uint_eq(bench_last(&bench, 0x701)->data[0], 127);
    ck_assert_ptr_null(bench_last(&bench, 0x181));
    bench_nmt(&bench, 1);
    bench_run(&bench, 110);
    ck_assert_uint_eq(bench_last(&bench, 0x701)->data[0], 5);
    ck_assert_uint_eq(status() & 0x4F, 0x40);
    bench_nmt(&bench, 2);
    bench_run(&bench, 110);
    ck_assert_uint_eq(bench_last(&bench, 0x701)->data[0], 4);
    bench_forget(&bench);
    bench_nmt(&bench, 129);
    bench_run(&bench, 1);
    ck_assert_uint_eq(bench_last(&bench, 0x701)->data[0], 0);
}
END_TEST

/* Every state, and what each controlword does there. 0: stays. */
START_TEST(every_transition_of_the_state_machine)
{
    static const struct {
        unsigned from; /* controlwords that lead there, as nibbles of a walk */
        uint16_t word;
        unsigned mask, value;
    } edges[] = {
        {0, 0x00, 0x4F, 0x40}, {0, 0x02, 0x4F, 0x40}, {0, 0x06, 0x6F, 0x21}, {0, 0x07, 0x4F, 0x40},
        {0, 0x0F, 0x4F, 0x40}, {0, 0x80, 0x4F, 0x40}, {1, 0x00, 0x4F, 0x40}, {1, 0x02, 0x4F, 0x40},
        {1, 0x06, 0x6F, 0x21}, {1, 0x07, 0x6F, 0x23}, {1, 0x0F, 0x6F, 0x27}, {2, 0x00, 0x4F, 0x40},
        {2, 0x02, 0x4F, 0x40}, {2, 0x06, 0x6F, 0x21}, {2, 0x07, 0x6F, 0x23}, {2, 0x0F, 0x6F, 0x27},
        {3, 0x00, 0x4F, 0x40}, {3, 0x02, 0x4F, 0x40}, {3, 0x06, 0x6F, 0x21}, {3, 0x07, 0x6F, 0x23},
        {3, 0x0F, 0x6F, 0x27},
    };
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
        static const uint16_t walk[] = {0x06, 0x07, 0x0F};
        setup();
        bench_nmt(&bench, 1);
        for (unsigned step = 0; step < edges[i].from; step++) {
            control(walk[step]);
        }
        control(edges[i].word);
        bench_run(&bench, 5);
        ck_assert_msg((status() & edges[i].mask) == edges[i].value,
                      "from state %u by 0x%02X: statusword 0x%04X, expected 0x%02X", edges[i].from,
                      edges[i].word, status(), edges[i].value);
    }
}
END_TEST

START_TEST(targets_act_at_the_sync_behind_them_and_the_other_half_is_ignored)
{
    enable();
    bench_forget(&bench);
    bench.syncs = false;
    target(0.001);
    assert_close(motor_m, 0.0, 1e-9, 0); /* received, not yet in effect */
    bench.syncs = true;
    bench_run(&bench, 1);
    assert_close(motor_m, 0.001, 1e-9, 0);
    bench_run(&bench, 1);
    ck_assert_int_eq(bytes_get_i32(bench_last(&bench, 0x181)->data + 2), 1000);
}
END_TEST

START_TEST(targets_are_held_to_limits_and_speed)
{
    enable();
    fastest_m_per_s = 0;
    hold(0.4, 400);
    assert_close(motor_m, 0.3, 1e-9, 0);
    ck_assert_uint_ne(status() & 1U << 11, 0);
    assert_close(fastest_m_per_s, 2.0, 1e-6, 0);
    hold(-0.1, 400);
    assert_close(motor_m, 0.0, 1e-9, 0);
}
END_TEST

START_TEST(the_latch_is_armed_only_while_enabled)
{
    bench_nmt(&bench, 1);
    control_armed(0x06);
    ck_assert(!command.latch_armed);
    control_armed(0x07);
    ck_assert(!command.latch_armed);
    control_armed(0x0F);
    ck_assert(command.latch_armed);
    control(0x0F);
    ck_assert(!command.latch_armed);
    control_armed(0x0F);
    control_armed(0x02); /* quick stop with the bit set */
    ck_assert(!command.latch_armed);
}
END_TEST

START_TEST(no_kick_when_the_first_target_is_far_away)
{
    motor_m = 0.1;
    measure();
    bench_nmt(&bench, 1);
    control(0x06);
    control(0x07);
    target(0.0);
    control(0x0F);
    bench_run(&bench, 3);
    ck_assert_uint_eq(status() & 0x4F, 0x08);
    ck_assert_uint_eq(last_emcy(), 0x8611);
    assert_close(motor_m, 0.1, 1e-9, 0);
}
END_TEST

static void check_unloads_by_itself(unsigned final_mask, unsigned final_value)
{
    fastest_m_per_s = 0;
    unsigned ticks = 0;
    while (command.powered && ticks < 2000) {
        hold(0.15, 1); /* what the master goes on sending does not matter */
        ck_assert(!command.latch_armed);
        ticks++;
    }
    assert_close(fastest_m_per_s, 0.5, 1e-6, 0);
    ck_assert_double_le(motor_m, 0.3 / 100 + 1e-9);
    bench_run(&bench, 2);
    ck_assert_uint_eq(status() & final_mask, final_value);
}

START_TEST(a_lost_heartbeat_unloads_the_spring_at_the_bounded_rate)
{
    enable();
    hold(0.15, 200);
    control_armed(0x0F);
    hold(0.15, 10);
    ck_assert(command.latch_armed);
    bench.heartbeats = false;
    unsigned waited = 0;
    while ((status() & 0x4F) != 0x0F && waited < 400) {
        hold(0.15, 1);
        waited++;
    }
    ck_assert_uint_le(waited, 260);
    check_unloads_by_itself(0x4F, 0x08);
    ck_assert_uint_eq(last_emcy(), 0x8130);
    ck_assert_uint_eq(bench_value(&bench, 0x603F, 0), 0x8130);
    ck_assert_uint_eq(bench_value(&bench, 0x1001, 0) & 0x11, 0x11);
}
END_TEST

START_TEST(missing_targets_unload_the_spring_too)
{
    enable();
    hold(0.15, 200);
    bench_run(&bench, 55); /* heartbeats go on */
    ck_assert_uint_eq(last_emcy(), 0x8250);
    check_unloads_by_itself(0x4F, 0x08);
}
END_TEST

START_TEST(leaving_operational_unloads_the_spring)
{
    enable();
    hold(0.15, 200);
    bench_nmt(&bench, 128);
    fastest_m_per_s = 0;
    bench_run(&bench, 400);
    ck_assert(!command.powered);
    assert_close(fastest_m_per_s, 0.5, 1e-6, 0);
    ck_assert_uint_eq(bench_value(&bench, 0x6041, 0) & 0x4F, 0x08);
}
END_TEST

/* Stopped because somebody else speaks: whatever targets and commands come, it unloads. */
START_TEST(stopped_it_unloads_and_obeys_nobody)
{
    enable();
    hold(0.15, 200);
    control_armed(0x0F);
    bench_nmt(&bench, 2);
    fastest_m_per_s = 0;
    for (int tick = 0; tick < 400; tick++) {
        target(0.15);
        control_armed(0x0F);
        control_armed(0x80);
        ck_assert(!command.latch_armed);
    }
    ck_assert(!command.powered);
    assert_close(fastest_m_per_s, 0.5, 1e-6, 0);
    bench_nmt(&bench, 1);
    bench_run(&bench, 2);
    ck_assert_uint_eq(status() & 0x4F, 0x08);
}
END_TEST

START_TEST(options_choose_the_reaction)
{
    ck_assert_uint_eq(bench_write(&bench, 0x6007, 0, 3, 2), 0); /* quick stop */
    enable();
    hold(0.15, 200);
    bench_run(&bench, 55);
    ck_assert_uint_eq(status() & 0x6F, 0x07);
    check_unloads_by_itself(0x4F, 0x40);

    setup();
    ck_assert_uint_eq(bench_write(&bench, 0x6007, 0, 0, 2), 0); /* none */
    enable();
    hold(0.15, 200);
    bench_run(&bench, 300);
    ck_assert_uint_eq(status() & 0x6F, 0x27);
    ck_assert_uint_eq(bench_write(&bench, 0x6007, 0, 4, 2), 0x06090031);
}
END_TEST

START_TEST(quick_stop_unloads_and_shutdown_does_so_before_the_torque_goes)
{
    enable();
    hold(0.15, 200);
    control(0x02);
    ck_assert_uint_eq(status() & 0x6F, 0x07);
    check_unloads_by_itself(0x4F, 0x40);

    setup();
    enable();
    hold(0.15, 200);
    control(0x06);
    ck_assert_uint_eq(status() & 0x6F, 0x27);
    ck_assert(command.powered);
    check_unloads_by_itself(0x6F, 0x21);

    setup();
    enable();
    hold(0.15, 200);
    control(0x00); /* disable voltage: at once */
    ck_assert(!command.powered);
    ck_assert_uint_eq(status() & 0x4F, 0x40);
}
END_TEST

START_TEST(a_fault_is_reset_by_a_rising_edge_only_and_not_while_it_lasts)
{
    enable();
    drive_node_inject_fault(&node, 0x4310);
    bench_run(&bench, 10);
    ck_assert_uint_eq(status() & 0x4F, 0x08);
    ck_assert_uint_eq(last_emcy(), 0x4310);
    ck_assert_uint_eq(bench_value(&bench, 0x1001, 0), 0x09);
    control(0x80);
    ck_assert_uint_eq(status() & 0x4F, 0x08); /* still hot */
    drive_node_inject_fault(&node, 0);
    control(0x80); /* no edge */
    ck_assert_uint_eq(status() & 0x4F, 0x08);
    control(0x0F); /* nor does any other command clear it */
    ck_assert_uint_eq(status() & 0x4F, 0x08);
    control(0x80);
    ck_assert_uint_eq(status() & 0x4F, 0x40);
    bench_run(&bench, 20);
    ck_assert_uint_eq(last_emcy(), 0x0000);
    ck_assert_uint_eq(bench_value(&bench, 0x1001, 0), 0);
    ck_assert_uint_eq(bench_value(&bench, 0x1003, 0), 1);
    ck_assert_uint_eq(bench_value(&bench, 0x1003, 1) & 0xFFFF, 0x4310);
    ck_assert_uint_eq(bench_write(&bench, 0x1003, 0, 3, 1), 0x06090030);
    ck_assert_uint_eq(bench_write(&bench, 0x1003, 0, 0, 1), 0);
    ck_assert_uint_eq(bench_value(&bench, 0x1003, 0), 0);
}
END_TEST

START_TEST(a_stuck_motor_is_a_following_error)
{
    enable();
    hold(0.01, 50);
    motor_is_stuck = true;
    hold(0.1, 80);
    ck_assert_uint_eq(status() & 0x6F, 0x27);
    ck_assert_uint_ne(status() & 1U << 13, 0);
    hold(0.1, 60);
    ck_assert_uint_eq(last_emcy(), 0x8611);
    ck_assert_uint_eq(status() & 0x4F, 0x0F);
    motor_is_stuck = false;
    bench_run(&bench, 200);
    ck_assert_uint_eq(status() & 0x4F, 0x08);
}
END_TEST

START_TEST(a_wrong_mode_is_refused_and_the_mode_is_shown)
{
    ck_assert_uint_eq(bench_value(&bench, 0x6061, 0), 8);
    ck_assert_uint_eq(bench_write(&bench, 0x6060, 0, 1, 1), 0x06090030);
    ck_assert_uint_eq(bench_value(&bench, 0x6060, 0), 8);
    ck_assert_uint_eq(bench_write(&bench, 0x6060, 0, 8, 1), 0);
    ck_assert_uint_eq(bench_value(&bench, 0x6502, 0), 1U << 7);
}
END_TEST

START_TEST(the_scaling_can_be_read_back)
{
    const double increments =
        (double)bench_value(&bench, 0x608F, 1) / bench_value(&bench, 0x608F, 2);
    const double gear = (double)bench_value(&bench, 0x6091, 1) / bench_value(&bench, 0x6091, 2);
    const double feed_m =
        (double)bench_value(&bench, 0x6092, 1) / bench_value(&bench, 0x6092, 2) * 1e-9;
    assert_close(increments * gear / feed_m, COUNTS_PER_M, 0, 1e-7);
}
END_TEST

START_TEST(a_coarse_scaling_fits_its_objects_too)
{
    const uint32_t counts_per_m[] = {1000, 20000, 65535, 65536, 13107200, 100000000};
    for (unsigned i = 0; i < sizeof counts_per_m / sizeof counts_per_m[0]; i++) {
        struct drive_node other;
        struct drive_node_config config = node.config;
        config.counts_per_m = counts_per_m[i];
        ck_assert_int_eq(drive_node_init(&other, &config, node.device.bus, 0), 0);
        assert_close(other.objects.encoder_increments * 1e9 / other.objects.feed, counts_per_m[i],
                     0, 1e-6);
    }
}
END_TEST

START_TEST(slow_values_come_every_hundred_syncs)
{
    bench_nmt(&bench, 1);
    bench_forget(&bench);
    motor_m = 0.1;
    bench_run(&bench, 300);
    ck_assert_uint_eq(bench_count(&bench, 0x381), 3);
    const struct can_msg *slow = bench_last(&bench, 0x381);
    ck_assert_uint_eq(slow->length, 8);
    ck_assert_int_eq(bytes_get_i16(slow->data), 200); /* 2 N of 10 N */
    ck_assert_int_eq(bytes_get_i16(slow->data + 2), 250);
    ck_assert_uint_eq(bytes_get_u32(slow->data + 4), 48000);
}
END_TEST

START_TEST(an_rpdo_of_a_wrong_length_is_told_and_the_short_one_not_used)
{
    enable();
    uint8_t data[8] = {0x10, 0x27};
    bench_send(&bench, 0x201, 4, data);
    bench_run(&bench, 3);
    assert_close(motor_m, 0.0, 1e-9, 0);
    ck_assert_uint_eq(last_emcy(), 0x8210);
    target(0.001);
    bench_run(&bench, 20);
    ck_assert_uint_eq(last_emcy(), 0x0000);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("drive_node");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, boots_as_cia_301_says);
    tcase_add_test(tcase, every_transition_of_the_state_machine);
    tcase_add_test(tcase, targets_act_at_the_sync_behind_them_and_the_other_half_is_ignored);
    tcase_add_test(tcase, targets_are_held_to_limits_and_speed);
    tcase_add_test(tcase, the_latch_is_armed_only_while_enabled);
    tcase_add_test(tcase, no_kick_when_the_first_target_is_far_away);
    tcase_add_test(tcase, a_lost_heartbeat_unloads_the_spring_at_the_bounded_rate);
    tcase_add_test(tcase, missing_targets_unload_the_spring_too);
    tcase_add_test(tcase, leaving_operational_unloads_the_spring);
    tcase_add_test(tcase, stopped_it_unloads_and_obeys_nobody);
    tcase_add_test(tcase, options_choose_the_reaction);
    tcase_add_test(tcase, quick_stop_unloads_and_shutdown_does_so_before_the_torque_goes);
    tcase_add_test(tcase, a_fault_is_reset_by_a_rising_edge_only_and_not_while_it_lasts);
    tcase_add_test(tcase, a_stuck_motor_is_a_following_error);
    tcase_add_test(tcase, a_wrong_mode_is_refused_and_the_mode_is_shown);
    tcase_add_test(tcase, the_scaling_can_be_read_back);
    tcase_add_test(tcase, a_coarse_scaling_fits_its_objects_too);
    tcase_add_test(tcase, slow_values_come_every_hundred_syncs);
    tcase_add_test(tcase, an_rpdo_of_a_wrong_length_is_told_and_the_short_one_not_used);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
