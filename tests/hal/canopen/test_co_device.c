/* The device core on a bus: PDO mapping by SDO, transmission types, heartbeat
 * consumer, emergencies, bus-off (CiA 301 clauses 7.2.2, 7.2.7, 7.2.8, 7.5.2). The leg
 * sensor node and the drive node stand for "a device". */
#include <check.h>

#include "hal/bus/bytes.h"
#include "sim_host/nodes/drive_node.h"
#include "tests/support/assert_close.h"
#include "tests/support/node_bench.h"

static struct bench bench;
static struct drive_node node;

static void poll_node(void *context, uint64_t now_ns)
{
    (void)drive_node_poll(context, now_ns);
}

static void setup(void)
{
    const struct drive_node_config config = {.side = SIDE_RIGHT,
                                             .node_id = 2,
                                             .counts_per_m = 1000000,
                                             .stroke_m = 0.3,
                                             .rated_force_N = 10.0,
                                             .following_error_m = 0.05,
                                             .unload_rate_m_per_s = 0.5};
    bench_init(&bench, 2, poll_node, NULL, &node);
    ck_assert_int_eq(drive_node_init(&node, &config, bench.node_bus, 0), 0);
    bench.syncs = true;
}

static uint32_t map_tpdo4(const uint32_t *map, unsigned count)
{
    uint32_t code = bench_write(&bench, 0x1803, 1, 0x80000482, 4);
    code = code != 0 ? code : bench_write(&bench, 0x1A03, 0, 0, 1);
    for (unsigned i = 0; code == 0 && i < count; i++) {
        code = bench_write(&bench, 0x1A03, (uint8_t)(i + 1), map[i], 4);
    }
    return code != 0 ? code : bench_write(&bench, 0x1A03, 0, count, 1);
}

START_TEST(a_pdo_is_mapped_by_sdo_and_sent_by_its_transmission_type)
{
    const uint32_t map[] = {0x60640020, 0x60410010, 0x21010008};
    ck_assert_uint_eq(map_tpdo4(map, 3), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 2, 3, 1), 0); /* every third SYNC */
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 1, 0x482, 4), 0);
    bench_nmt(&bench, 1);
    bench_forget(&bench);
    bench_run(&bench, 30);
    ck_assert_uint_eq(bench_count(&bench, 0x482), 10);
    ck_assert_uint_eq(bench_last(&bench, 0x482)->length, 7);
}
END_TEST

START_TEST(event_pdos_obey_event_timer_and_inhibit_time)
{
    const uint32_t map[] = {0x60410010};
    ck_assert_uint_eq(map_tpdo4(map, 1), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 2, 254, 1), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 3, 200, 2), 0); /* 20 ms */
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 5, 50, 2), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 1, 0x482, 4), 0);
    bench_nmt(&bench, 1);
    bench_run(&bench, 2);
    ck_assert_uint_eq(bench_count(&bench, 0x482), 1); /* tells itself at the start */
    bench_run(&bench, 500);
    ck_assert_uint_ge(bench_count(&bench, 0x482), 10);
    ck_assert_uint_le(bench_count(&bench, 0x482), 12);
    bench_forget(&bench);
    for (int i = 0; i < 100; i++) {
        co_device_trigger_tpdo(&node.device, 3);
        bench_run(&bench, 1);
    }
    ck_assert_uint_ge(bench_count(&bench, 0x482), 4);
    ck_assert_uint_le(bench_count(&bench, 0x482), 6);
}
END_TEST

START_TEST(acyclic_synchronous_pdos_wait_for_sync_and_a_change)
{
    const uint32_t map[] = {0x60410010};
    ck_assert_uint_eq(map_tpdo4(map, 1), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 2, 0, 1), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1803, 1, 0x482, 4), 0);
    bench_nmt(&bench, 1);
    bench_run(&bench, 20);
    ck_assert_uint_eq(bench_count(&bench, 0x482), 0);
    bench.syncs = false;
    co_device_trigger_tpdo(&node.device, 3);
    bench_run(&bench, 5);
    ck_assert_uint_eq(bench_count(&bench, 0x482), 0);
    bench.syncs = true;
    bench_run(&bench, 5);
    ck_assert_uint_eq(bench_count(&bench, 0x482), 1);
}
END_TEST

START_TEST(bad_mappings_are_refused_with_their_code)
{
    const uint32_t absent[] = {0x61230010};
    const uint32_t no_sub[] = {0x607D0520};
    const uint32_t not_mappable[] = {0x10080008};
    const uint32_t wrong_size[] = {0x60410020};
    const uint32_t receive_only[] = {0x00070020};
    const uint32_t too_long[] = {0x60640020, 0x60620020, 0x60410010};
    ck_assert_uint_eq(map_tpdo4(absent, 1), 0x06020000);
    ck_assert_uint_eq(map_tpdo4(no_sub, 1), 0x06090011);
    ck_assert_uint_eq(map_tpdo4(not_mappable, 1), 0x06040041);
    ck_assert_uint_eq(map_tpdo4(wrong_size, 1), 0x06040041);
    ck_assert_uint_eq(map_tpdo4(receive_only, 1), 0x06040041);
    ck_assert_uint_eq(map_tpdo4(too_long, 3), 0x06040042);
    ck_assert_uint_eq(bench_write(&bench, 0x1A03, 0, 9, 1), 0x06090031);
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 2, 245, 1), 0x06090030);
}
END_TEST

START_TEST(a_living_pdo_cannot_be_changed)
{
    ck_assert_uint_eq(bench_write(&bench, 0x1A00, 0, 0, 1), 0x06010000);
    ck_assert_uint_eq(bench_write(&bench, 0x1A00, 1, 0x60640020, 4), 0x06010000);
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 1, 0x190, 4), 0x06090030);
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 3, 10, 2), 0x06010000);
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 1, 0x80000182, 4), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1A00, 1, 0x60640020, 4), 0x06010000); /* count not 0 */
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 1, 0x582, 4), 0x06090030);      /* restricted */
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 1, 0x20000182, 4), 0x06090030); /* 29 bits */
    ck_assert_uint_eq(bench_write(&bench, 0x1800, 1, 0x1A2, 4), 0);
    bench_nmt(&bench, 1);
    bench_forget(&bench);
    bench_run(&bench, 5);
    ck_assert_uint_eq(bench_count(&bench, 0x182), 0);
    ck_assert_uint_eq(bench_count(&bench, 0x1A2), 5);
    bench_nmt(&bench, 130); /* reset communication: the default is back */
    ck_assert_uint_eq(bench_value(&bench, 0x1800, 1), 0x40000182); /* no remote requests */
}
END_TEST

START_TEST(the_shared_rpdo_uses_dummies_for_the_other_half)
{
    ck_assert_uint_eq(bench_value(&bench, 0x1400, 1), 0x201);
    ck_assert_uint_eq(bench_value(&bench, 0x1600, 1), 0x00040020);
    ck_assert_uint_eq(bench_value(&bench, 0x1600, 2), 0x607A0020);
    bench_nmt(&bench, 1);
    const uint8_t targets[8] = {0x11, 0x11, 0x11, 0x11, 0x39, 0x30, 0, 0};
    bench_send(&bench, 0x201, 8, targets);
    bench_run(&bench, 2);
    ck_assert_uint_eq(bench_value(&bench, 0x607A, 0), 12345);
}
END_TEST

START_TEST(pdos_live_in_operational_only)
{
    const uint8_t word[6] = {0x06, 0};
    bench_send(&bench, 0x302, 6, word);
    bench_run(&bench, 2);
    ck_assert_uint_eq(bench_value(&bench, 0x6040, 0), 0);
    bench_nmt(&bench, 1);
    bench_send(&bench, 0x302, 6, word);
    bench_run(&bench, 2);
    ck_assert_uint_eq(bench_value(&bench, 0x6040, 0), 6);
    bench_nmt(&bench, 2);
    bench_forget(&bench);
    uint8_t bytes[CO_VALUE_MAX];
    unsigned length;
    ck_assert_uint_eq(bench_read(&bench, 0x6040, 0, bytes, &length), 0x05040000); /* stopped */
    ck_assert_uint_eq(bench_count(&bench, 0x182), 0);
}
END_TEST

START_TEST(heartbeat_consumer_and_producer_by_object)
{
    ck_assert_uint_eq(bench_write(&bench, 0x1017, 0, 20, 2), 0);
    ck_assert_uint_eq(bench_write(&bench, 0x1016, 2, 0x00110032, 4), 0); /* node 17, 50 ms */
    ck_assert_uint_eq(bench_write(&bench, 0x1016, 3, 0x00110064, 4), 0x06040043); /* twice */
    ck_assert_uint_eq(bench_write(&bench, 0x1016, 3, 0x01110064, 4), 0x06090030);
    bench_forget(&bench);
    bench_run(&bench, 200);
    ck_assert_uint_ge(bench_count(&bench, 0x702), 9);
    ck_assert_ptr_null(bench_last(&bench, 0x082)); /* monitored from its first heartbeat on */
    const uint8_t alive[1] = {5};
    bench_send(&bench, 0x711, 1, alive);
    bench_run(&bench, 45);
    ck_assert_ptr_null(bench_last(&bench, 0x082));
    bench_run(&bench, 10);
    const struct can_msg *emcy = bench_last(&bench, 0x082);
    ck_assert_ptr_nonnull(emcy);
    ck_assert_uint_eq(bytes_get_u16(emcy->data), 0x8130);
    ck_assert_uint_eq(emcy->data[2], 0x11);
    ck_assert_uint_eq(emcy->data[3], 17);
    bench_send(&bench, 0x711, 1, alive);
    bench_run(&bench, 12);
    ck_assert_uint_eq(bytes_get_u16(bench_last(&bench, 0x082)->data), 0);
    ck_assert_uint_eq(bench_value(&bench, 0x1001, 0), 0);
}
END_TEST

START_TEST(the_history_keeps_the_newest_first)
{
    for (uint16_t i = 0; i < 10; i++) {
        co_device_raise(&node.device, (uint16_t)(0x6100 + i), 0x80, NULL);
        bench_run(&bench, 11);
        ck_assert_uint_eq(bytes_get_u16(bench_last(&bench, 0x082)->data), 0x6100U + i);
        co_device_clear(&node.device, (uint16_t)(0x6100 + i));
        bench_run(&bench, 11);
    }
    ck_assert_uint_eq(bench_value(&bench, 0x1003, 0), 8);
    ck_assert_uint_eq(bench_value(&bench, 0x1003, 1), 0x6109);
    ck_assert_uint_eq(bench_value(&bench, 0x1003, 8), 0x6102);
}
END_TEST

static struct sim_bus_fault destroy_node_frames(void *context, const struct can_msg *message,
                                                unsigned sender, uint64_t time_ns)
{
    const struct sim_bus_fault none = {.kind = SIM_BUS_FAULT_NONE};
    const struct sim_bus_fault destroy = {.kind = SIM_BUS_FAULT_DESTROY, .bit = 40};
    const uint64_t *until_ns = context;
    (void)message;
    return sender == 1 && time_ns < *until_ns ? destroy : none;
}

START_TEST(bus_off_is_survived_and_told)
{
    bench_nmt(&bench, 1);
    uint64_t until_ns = sim_bus_now_ns(&bench.bus) + 5000000;
    sim_bus_set_fault_hook(&bench.bus, destroy_node_frames, &until_ns);
    bench_run(&bench, 40);
    const struct can_msg *emcy = NULL;
    for (unsigned i = 0; i < bench.seen_count; i++) {
        if (bench.seen[i].id == 0x082 && bytes_get_u16(bench.seen[i].data) == 0x8140) {
            emcy = &bench.seen[i];
        }
    }
    ck_assert_ptr_nonnull(emcy);
    bench_forget(&bench);
    bench_run(&bench, 5);
    ck_assert_uint_eq(bench_count(&bench, 0x182), 5);
}
END_TEST

START_TEST(malformed_frames_are_counted_and_change_nothing)
{
    const uint8_t bytes[8] = {1, 2};
    bench_send(&bench, 0x000, 1, bytes);
    bench_send(&bench, 0x000, 8, bytes);
    bench_send(&bench, 0x602, 7, bytes);
    bench_run(&bench, 2);
    ck_assert_uint_eq(node.device.counters.malformed, 3);
    ck_assert_int_eq(node.device.state, 127);
    const uint8_t unknown[2] = {77, 2};
    bench_send(&bench, 0x000, 2, unknown);
    bench_run(&bench, 1);
    ck_assert_int_eq(node.device.state, 127);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("co_device");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, a_pdo_is_mapped_by_sdo_and_sent_by_its_transmission_type);
    tcase_add_test(tcase, event_pdos_obey_event_timer_and_inhibit_time);
    tcase_add_test(tcase, acyclic_synchronous_pdos_wait_for_sync_and_a_change);
    tcase_add_test(tcase, bad_mappings_are_refused_with_their_code);
    tcase_add_test(tcase, a_living_pdo_cannot_be_changed);
    tcase_add_test(tcase, the_shared_rpdo_uses_dummies_for_the_other_half);
    tcase_add_test(tcase, pdos_live_in_operational_only);
    tcase_add_test(tcase, heartbeat_consumer_and_producer_by_object);
    tcase_add_test(tcase, the_history_keeps_the_newest_first);
    tcase_add_test(tcase, bus_off_is_survived_and_told);
    tcase_add_test(tcase, malformed_frames_are_counted_and_change_nothing);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
