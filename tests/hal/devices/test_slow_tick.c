/* The same code built for a tick of 2 ms: what is a time takes half as many ticks. Wall time is
 * the reference: a node is given up when it was silent for 250 ms, whatever the tick. */
#undef TICK_PERIOD_US
#define TICK_PERIOD_US 2000

/* Compiled here, at this tick; the library's are for the build's. */
#include "hal/canopen/network.c"
#include "hal/devices/sea_drive_cansimple.c"

#include <check.h>

#include "controller/signals.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

/* The last tick at which a reading is still used is the last one within the time-out; one more
 * is needed to see that it is over. */
enum { TIMEOUT_TICKS = 250 / 2 };

START_TEST(a_node_is_lost_after_250_ms)
{
    struct fake_bus fake;
    struct network network;
    int ticks = 0;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    network_init(&network);
    for (int node = 1; node <= 4; node++) {
        const struct can_msg heartbeat = {.id = 0x700u + (uint32_t)node, .length = 1, .data = {5}};
        ck_assert(network_receive(&network, &heartbeat));
    }
    while (network_all_operational(&network) && ticks < 1000) {
        network_update(&network, &bus, 0xF);
        ticks++;
    }
    ck_assert_int_eq(ticks, TIMEOUT_TICKS + 1);
}
END_TEST

START_TEST(a_stopped_network_is_started_again_after_a_second)
{
    struct fake_bus fake;
    struct network network;
    fake_bus_init(&fake);
    const struct can_bus bus = fake_bus_interface(&fake);
    const struct can_msg heartbeat = {.id = 0x701, .length = 1, .data = {4}};
    network_init(&network);
    ck_assert_int_eq(network_stop_all(&network, &bus), CAN_OK);
    fake_bus_clear(&fake);
    for (int ms = 2; ms <= 998; ms += 2) {
        ck_assert(network_receive(&network, &heartbeat));
        network_update(&network, &bus, 0xF);
        ck_assert_uint_eq(fake_bus_count(&fake, 0x000), 0);
    }
    network_update(&network, &bus, 0xF);
    ck_assert_uint_eq(fake_bus_count(&fake, 0x000), 1);
}
END_TEST

START_TEST(a_cansimple_drive_is_lost_after_250_ms)
{
    const struct cansimple_axis_config config[SIDE_COUNT] = {
        {.node = 1, .turns_per_m = 200.0f, .direction = 1},
        {.node = 2, .turns_per_m = 200.0f, .direction = 1}};
    const struct can_msg heartbeat = {.id = 0x021, .length = 8, .data = {[4] = 8}};
    struct cansimple_drives axes;
    struct sea_drive_reading reading = {.state = DRIVE_ENABLED};
    int ticks = 0;
    cansimple_drives_init(&axes, config);
    const struct sea_drives drives = cansimple_drives_interface(&axes);
    ck_assert(sea_drives_receive(&drives, &heartbeat));
    while (ticks < 1000) {
        sea_drives_read(&drives, SIDE_LEFT, &reading);
        if (reading.state != DRIVE_ENABLED) {
            break;
        }
        sea_drives_age(&drives);
        ticks++;
    }
    ck_assert_int_eq(reading.state, DRIVE_UNKNOWN);
    ck_assert_int_eq(ticks, TIMEOUT_TICKS + 1);
}
END_TEST

/* What the headers compute from the tick. */
START_TEST(every_number_follows_the_tick)
{
    assert_close((double)CONTROL_PERIOD_S, 0.002, 1e-9, 0.0);
    assert_close((double)CONTROL_RATE_HZ, 500.0, 1e-9, 0.0);
    ck_assert_uint_eq(ticks_from_seconds(REAL(3.0)), 1500);
    ck_assert_int_eq(SLOW_PDO_TICKS, 50);
    ck_assert_int_eq(TICKS_OF_MS(0), 0);
    ck_assert_int_eq(TICKS_OF_MS(1), 1); /* at least so long */
    ck_assert_int_eq(TICKS_OF_MS(3), 2);
    ck_assert_int_eq(TICKS_OF_MS(1000), 500);
#define IS_SYNCHRONOUS(name, id, bytes, period_us, deadline_us, node, kind) \
    ck_assert(#kind[0] != 'S' || ((period_us) == 2000 && (deadline_us) == 2000));
    FRAME_TABLE(IS_SYNCHRONOUS)
#undef IS_SYNCHRONOUS
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("slow_tick");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, a_node_is_lost_after_250_ms);
    tcase_add_test(tests, a_stopped_network_is_started_again_after_a_second);
    tcase_add_test(tests, a_cansimple_drive_is_lost_after_250_ms);
    tcase_add_test(tests, every_number_follows_the_tick);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
