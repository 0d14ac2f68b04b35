/* What a frame at the end of its field, and a counter at the end of its own, come to: closed
 * forms of the scalings in frame_table.h and the headers. */
#include <math.h>
#include <string.h>

#include "hal/canopen/network.h"
#include "hal/devices/leg_sensors.h"
#include "hal/devices/sea_drive_cia402.h"
#include "hal/watchdog.h"
#include "tests/support/assert_close.h"

static void put_u32(uint8_t *bytes, uint32_t value, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        bytes[i] = (uint8_t)(value >> (8 * i) & 0xFFu);
    }
}

/* A turn is 2^24 counts, and the angle lies within half a turn of zero whatever the mounting. */
START_TEST(an_angle_is_within_half_a_turn)
{
    for (int direction = -1; direction <= 1; direction += 2) {
        for (int zero = -6; zero <= 6; zero++) {
            const struct leg_sensor_config one = {.angle_zero_rad = 0.5f * (float)zero,
                                                  .angle_direction = (int8_t)direction};
            const struct leg_sensor_config config[SIDE_COUNT] = {one, one};
            struct leg_sensors sensors;
            leg_sensors_init(&sensors, config);
            for (int32_t counts = -8388608; counts < 8388608; counts += 1048576 + 777) {
                struct can_msg frame = {.id = 0x283, .length = 5};
                put_u32(frame.data, (uint32_t)counts, 3);
                ck_assert(leg_sensors_receive(&sensors, &frame));
                const double turn = counts / 16777216.0 * 2.0 * M_PI - 0.5 * zero;
                const double want = direction * turn;
                const float got = sensors.reading[SIDE_LEFT].leg_angle_rad;
                ck_assert(got >= -3.1416f && got <= 3.1416f);
                assert_close(cos((double)got), cos(want), 2e-6, 0);
                assert_close(sin((double)got), sin(want), 2e-6, 0);
            }
        }
    }
}
END_TEST

/* The way from the zero may take 33 bits; it ends at 32, with its sign, and is never a small one. */
START_TEST(a_position_far_away_is_far_away)
{
    static const struct {
        int32_t zero, counts;
        int8_t direction;
        double travel;
    } cases[] = {{-2000000000, 2000000000, 1, 2147483647.0},
                 {-2000000000, 2000000000, -1, -2147483648.0},
                 {2000000000, -2000000000, 1, -2147483648.0},
                 {2000000000, -2000000000, -1, 2147483647.0},
                 {-1000, 1000, 1, 2000.0},
                 {0, INT32_MIN, -1, 2147483647.0}};
    struct cia402_axis_config config[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        config[leg] = (struct cia402_axis_config){.counts_per_m = 1.0e6f,
                                                  .zero_counts = cases[_i].zero,
                                                  .direction = cases[_i].direction,
                                                  .rated_force_N = 0.0f};
    }
    struct cia402_drives cia402;
    cia402_drives_init(&cia402, config);
    const struct sea_drives drives = cia402_drives_interface(&cia402);
    struct can_msg frame = {.id = 0x181, .length = 6, .data = {0x40, 0x02}};
    put_u32(frame.data + 2, (uint32_t)cases[_i].counts, 4);
    ck_assert(sea_drives_receive(&drives, &frame));
    struct sea_drive_reading reading;
    sea_drives_read(&drives, SIDE_LEFT, &reading);
    assert_close(reading.precompression_m, cases[_i].travel / 1.0e6, 0.0, 1e-6);
}
END_TEST

START_TEST(counters_stay_at_their_ends)
{
    static const struct leg_sensor_config straight[SIDE_COUNT] = {{.angle_direction = 1},
                                                                  {.angle_direction = 1}};
    static const struct cia402_axis_config axes[SIDE_COUNT] = {
        {.counts_per_m = 1.0e6f, .zero_counts = 0, .direction = 1, .rated_force_N = 0.0f},
        {.counts_per_m = 1.0e6f, .zero_counts = 0, .direction = 1, .rated_force_N = 0.0f}};
    struct leg_sensors sensors;
    leg_sensors_init(&sensors, straight);
    sensors.rx_malformed = UINT32_MAX;
    const struct can_msg cut = {.id = 0x283, .length = 4};
    ck_assert(leg_sensors_receive(&sensors, &cut));
    ck_assert_uint_eq(sensors.rx_malformed, UINT32_MAX);

    struct cia402_drives cia402;
    cia402_drives_init(&cia402, axes);
    cia402.rx_malformed = UINT32_MAX;
    const struct sea_drives drives = cia402_drives_interface(&cia402);
    const struct can_msg short_state = {.id = 0x182, .length = 5};
    struct can_msg remote = {.id = 0x182, .length = 6, .flags = CAN_FRAME_REMOTE};
    ck_assert(sea_drives_receive(&drives, &short_state));
    ck_assert(sea_drives_receive(&drives, &remote));
    remote.id = 0x381;
    ck_assert(sea_drives_receive(&drives, &remote));
    ck_assert_uint_eq(cia402.rx_malformed, UINT32_MAX);
    ck_assert_uint_eq(cia402.axis[SIDE_RIGHT].age_ticks, UINT16_MAX); /* nothing was taken */

    struct network network;
    network_init(&network);
    network.node[0].boot_count = UINT8_MAX;
    const struct can_msg boot = {.id = 0x701, .length = 1, .data = {0}};
    ck_assert(network_receive(&network, &boot));
    ck_assert_uint_eq(network.node[0].boot_count, UINT8_MAX);
    ck_assert(network.node[0].booted);
}
END_TEST

static void feed(void *context)
{
    (*(unsigned *)context)++;
}

START_TEST(a_full_count_of_feeds_still_feeds)
{
    static const struct watchdog_ops ops = {feed};
    unsigned fed = 0;
    const struct watchdog watchdog = {&ops, &fed};
    struct watchdog_gate gate;
    watchdog_gate_init(&gate, &watchdog);
    gate.feeds = UINT32_MAX;
    ck_assert(watchdog_gate_report(&gate, WATCHDOG_ALL));
    ck_assert_uint_eq(gate.feeds, UINT32_MAX);
    ck_assert_uint_eq(fed, 1);
}
END_TEST

/* A heartbeat of another length or with flags is none; nor is an emergency. */
START_TEST(no_heartbeat_is_no_sign_of_life)
{
    struct network network;
    network_init(&network);
    struct can_msg message = {.id = 0x703, .length = 2, .data = {5}};
    ck_assert(network_receive(&network, &message));
    message.length = 1;
    message.flags = CAN_FRAME_REMOTE;
    ck_assert(network_receive(&network, &message));
    for (int i = 0; i < NETWORK_NODES; i++) {
        ck_assert_int_eq(network.node[i].state, NMT_UNKNOWN);
    }
    message.flags = 0;
    ck_assert(network_receive(&network, &message));
    ck_assert_int_eq(network.node[2].state, NMT_OPERATIONAL);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("reading edges");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, an_angle_is_within_half_a_turn);
    tcase_add_loop_test(tests, a_position_far_away_is_far_away, 0, 6);
    tcase_add_test(tests, counters_stay_at_their_ends);
    tcase_add_test(tests, a_full_count_of_feeds_still_feeds);
    tcase_add_test(tests, no_heartbeat_is_no_sign_of_life);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
