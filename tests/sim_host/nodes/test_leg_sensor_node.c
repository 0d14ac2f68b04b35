/* The leg sensor as a CiA 406 device on the bus. */
#include <check.h>
#include <math.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/nodes/leg_sensor_node.h"
#include "tests/support/assert_close.h"
#include "tests/support/node_bench.h"

static struct bench bench;
static struct leg_sensor_node node;

static void poll_node(void *context, uint64_t now_ns)
{
    (void)leg_sensor_node_poll(context, now_ns);
}

static void setup(void)
{
    const struct leg_sensor_node_config config = {.side = SIDE_LEFT, .node_id = 3};
    bench_init(&bench, 3, poll_node, NULL, &node);
    ck_assert_int_eq(leg_sensor_node_init(&node, &config, bench.node_bus, 0), 0);
    bench.syncs = true;
}

START_TEST(sync_is_answered_with_five_bytes_when_operational)
{
    bench_run(&bench, 5);
    ck_assert_ptr_null(bench_last(&bench, 0x283));
    bench_nmt(&bench, 1);
    leg_sensor_node_measure(&node, -0.25, 0.0123);
    bench_run(&bench, 1);
    const struct can_msg *answer = bench_last(&bench, 0x283);
    ck_assert_ptr_nonnull(answer);
    ck_assert_uint_eq(answer->length, 5);
    assert_close(bytes_get_i24(answer->data) * 6.283185307179586 / 16777216.0, -0.25, 1.9e-7, 0);
    ck_assert_int_eq(bytes_get_i16(answer->data + 3), 1230);
}
END_TEST

START_TEST(values_saturate_and_a_bad_one_raises_an_alarm)
{
    bench_nmt(&bench, 1);
    leg_sensor_node_measure(&node, 7.0, 1.0);
    bench_run(&bench, 1);
    ck_assert_int_eq(bytes_get_i24(bench_last(&bench, 0x283)->data), 0x7FFFFF);
    ck_assert_int_eq(bytes_get_i16(bench_last(&bench, 0x283)->data + 3), 32767);
    leg_sensor_node_measure(&node, 0.5, 0.0);
    leg_sensor_node_measure(&node, (double)NAN, 0.0);
    bench_run(&bench, 2);
    assert_close(bytes_get_i24(bench_last(&bench, 0x283)->data) * 6.283185307179586 / 16777216.0,
                 0.5, 1.9e-7, 0);
    ck_assert_uint_eq(bytes_get_u16(bench_last(&bench, 0x083)->data), 0x5000);
    ck_assert_uint_eq(bench_value(&bench, 0x6503, 0), 1);
    leg_sensor_node_measure(&node, 0.5, 0.0);
    bench_run(&bench, 20);
    ck_assert_uint_eq(bytes_get_u16(bench_last(&bench, 0x083)->data), 0);
}
END_TEST

START_TEST(a_preset_moves_the_zero_and_the_code_sequence_turns_the_sign)
{
    bench_nmt(&bench, 1);
    leg_sensor_node_measure(&node, 0.1, 0.0);
    ck_assert_uint_eq(bench_write(&bench, 0x6003, 0, 0, 4), 0);
    ck_assert_int_eq((int32_t)bench_value(&bench, 0x6004, 0), 0);
    const int32_t offset = (int32_t)bench_value(&bench, 0x6509, 0);
    ck_assert_int_eq(offset, -267018); /* -0.1 rad in 2*pi/2^24 */
    ck_assert_uint_eq(bench_write(&bench, 0x6000, 0, 1, 2), 0);
    ck_assert_int_eq((int32_t)bench_value(&bench, 0x6004, 0), 2 * offset);
    ck_assert_uint_eq(bench_write(&bench, 0x6000, 0, 2, 2), 0x06090031);
    bench_nmt(&bench, 129);
    ck_assert_int_eq((int32_t)bench_value(&bench, 0x6004, 0), 267018);
}
END_TEST

START_TEST(the_cyclic_timer_drives_tpdo1)
{
    leg_sensor_node_measure(&node, 0.1, 0.0);
    ck_assert_uint_eq(bench_write(&bench, 0x6200, 0, 10, 2), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 1, 0x183, 4), 0);
    bench_nmt(&bench, 1);
    bench_forget(&bench);
    bench_run(&bench, 100);
    ck_assert_uint_ge(bench_count(&bench, 0x183), 9);
    ck_assert_uint_le(bench_count(&bench, 0x183), 11);
    ck_assert_uint_eq(bench_count(&bench, 0x283), 100);
}
END_TEST

START_TEST(a_silent_sensor_misses_samples_but_stays_alive)
{
    bench_nmt(&bench, 1);
    bench_forget(&bench);
    leg_sensor_node_silence(&node, true);
    bench_run(&bench, 300);
    ck_assert_uint_eq(bench_count(&bench, 0x283), 0);
    ck_assert_uint_eq(bench_count(&bench, 0x703), 3);
}
END_TEST

START_TEST(device_type_and_sizes_can_be_read)
{
    ck_assert_uint_eq(bench_value(&bench, 0x1000, 0) & 0xFFFF, 406);
    ck_assert_uint_eq(bench_value(&bench, 0x6001, 0), 1U << 24);
    ck_assert_uint_eq(bench_value(&bench, 0x1A01, 0), 2);
    ck_assert_uint_eq(bench_value(&bench, 0x1A01, 1), 0x20200118);
    ck_assert_uint_eq(bench_value(&bench, 0x1A01, 2), 0x20200210);
    ck_assert_uint_eq(bench_value(&bench, 0x2021, 0), 0);
}
END_TEST

START_TEST(a_foot_switch_is_told_on_change_and_from_time_to_time)
{
    const struct leg_sensor_node_config config = {
        .side = SIDE_LEFT, .node_id = 3, .has_foot_switch = true};
    bench_init(&bench, 3, poll_node, NULL, &node);
    ck_assert_int_eq(leg_sensor_node_init(&node, &config, bench.node_bus, 0), 0);
    bench.syncs = true;
    bench_nmt(&bench, 1);
    leg_sensor_node_measure_foot(&node, FOOT_DOWN);
    bench_run(&bench, 10);
    const struct can_msg *told = bench_last(&bench, 0x383);
    ck_assert_ptr_nonnull(told);
    ck_assert_uint_eq(told->length, 1);
    ck_assert_uint_eq(told->data[0], FOOT_IS_DOWN);
    bench_run(&bench, 20);
    leg_sensor_node_measure_foot(&node, FOOT_UP);
    bench_run(&bench, 2);
    ck_assert_uint_eq(bench_last(&bench, 0x383)->data[0], 0);
    leg_sensor_node_measure_foot(&node, FOOT_UNKNOWN);
    bench_run(&bench, 10);
    ck_assert_uint_eq(bench_last(&bench, 0x383)->data[0], FOOT_HAS_FAULT);
}
END_TEST

START_TEST(without_a_foot_switch_nothing_is_told)
{
    bench_nmt(&bench, 1);
    leg_sensor_node_measure_foot(&node, FOOT_DOWN);
    bench_run(&bench, 200);
    ck_assert_ptr_null(bench_last(&bench, 0x383));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("leg_sensor_node");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, a_foot_switch_is_told_on_change_and_from_time_to_time);
    tcase_add_test(tcase, without_a_foot_switch_nothing_is_told);
    tcase_add_test(tcase, sync_is_answered_with_five_bytes_when_operational);
    tcase_add_test(tcase, values_saturate_and_a_bad_one_raises_an_alarm);
    tcase_add_test(tcase, a_preset_moves_the_zero_and_the_code_sequence_turns_the_sign);
    tcase_add_test(tcase, the_cyclic_timer_drives_tpdo1);
    tcase_add_test(tcase, a_silent_sensor_misses_samples_but_stays_alive);
    tcase_add_test(tcase, device_type_and_sizes_can_be_read);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
