/* What a device's description says to the set-up of its nodes, number by number. */
#include "hal/devices/device_config.h"

#include "hal/canopen/network.h"
#include "tests/support/assert_close.h"

static struct device_description device;
static struct node_setup_config config;

/* A spring of 0.1 m at 200,000 counts a metre: 20,000 counts of travel. */
static void setup(void)
{
    device_description_default(&device);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device.leg[leg].counts_per_m = 200000.0f;
        device.leg[leg].stroke_max_m = 0.1f;
        device.leg[leg].zero_counts = 7000;
    }
    device.leg[SIDE_LEFT].direction = 1;
    device.leg[SIDE_RIGHT].direction = -1;
}

static void make(void)
{
    device_node_setup(&device, 0.9f, 0.5f, &config);
}

START_TEST(the_limits_lie_on_the_side_that_compresses)
{
    make();
    ck_assert_int_eq(config.limit_min_counts[SIDE_LEFT], 7000);
    ck_assert_int_eq(config.limit_max_counts[SIDE_LEFT], 27000);
    ck_assert_int_eq(config.limit_min_counts[SIDE_RIGHT], -13000);
    ck_assert_int_eq(config.limit_max_counts[SIDE_RIGHT], 7000);
}
END_TEST

START_TEST(lengths_speeds_and_torques_are_told_in_the_drives_units)
{
    device.leg[SIDE_LEFT].rated_force_N = 800.0f;
    device.leg[SIDE_LEFT].rated_torque_Nm = 1.5f;
    device.leg[SIDE_LEFT].following_error_m = 0.02f;
    device.leg[SIDE_LEFT].lacks = 5;
    make();
    ck_assert_uint_eq(config.counts_per_m[SIDE_LEFT], 200000);
    ck_assert_uint_eq(config.rated_torque_mNm[SIDE_LEFT], 1500);
    ck_assert_uint_eq(config.following_error_counts[SIDE_LEFT], 4000);
    ck_assert_uint_eq(config.speed_needed_counts_s[SIDE_LEFT], 100000);
    ck_assert_uint_eq(config.lacks[SIDE_LEFT], 5);
    assert_close((double)config.rated_force_N[SIDE_LEFT], 800.0, 0.0, 0.0);
}
END_TEST

START_TEST(each_node_has_its_number_and_its_objects)
{
    struct device_leg *left = &device.leg[SIDE_LEFT], *right = &device.leg[SIDE_RIGHT];
    left->drive_node = 21;
    right->drive_node = 22;
    left->leg_sensor_node = 23;
    right->leg_sensor_node = 24;
    right->latch = DEVICE_LATCH_BOARD;
    right->latch_node = 25;
    right->latch_object = 0x60000108;
    left->leg_sensor_object = 0x600400;
    left->leg_sensor_bits = 32;
    right->ankle_sensor_object = 0x600500;
    right->ankle_sensor_bits = 16;
    left->leg_counts_per_turn = 4096.0f;
    make();
    ck_assert_uint_eq(config.node[NETWORK_DRIVE_LEFT], 21);
    ck_assert_uint_eq(config.node[NETWORK_DRIVE_RIGHT], 22);
    ck_assert_uint_eq(config.node[NETWORK_SENSOR_LEFT], 23);
    ck_assert_uint_eq(config.node[NETWORK_SENSOR_RIGHT], 24);
    ck_assert_uint_eq(config.node[NETWORK_LATCH_LEFT], 0);
    ck_assert_uint_eq(config.node[NETWORK_LATCH_RIGHT], 25);
    ck_assert_uint_eq(config.node[NETWORK_ANKLE_LEFT], 0);
    ck_assert_uint_eq(config.latch_object[SIDE_RIGHT], 0x60000108);
    ck_assert_uint_eq(config.leg_object[SIDE_LEFT], 0x600400);
    ck_assert_uint_eq(config.leg_bits[SIDE_LEFT], 32);
    ck_assert_uint_eq(config.ankle_object[SIDE_RIGHT], 0x600500);
    ck_assert_uint_eq(config.ankle_bits[SIDE_RIGHT], 16);
    ck_assert_uint_eq(config.leg_counts_per_turn[SIDE_LEFT], 4096);
    /* Other numbers than the node's own: it may have PDOs where its maker put them. */
    ck_assert(config.sensor_has_others_pdos[SIDE_LEFT] && config.has_others_pdos[SIDE_LEFT]);
}
END_TEST

START_TEST(a_motor_of_a_makers_protocol_is_no_canopen_node)
{
    device.leg[SIDE_RIGHT].protocol = DEVICE_MIT;
    device.leg[SIDE_RIGHT].drive_node = 9;
    make();
    ck_assert_uint_eq(config.node[NETWORK_DRIVE_RIGHT], 0);
    ck_assert_uint_eq(config.counts_per_m[SIDE_RIGHT], 0);
    ck_assert(config.own_target[SIDE_LEFT]); /* nobody shares its frame */
    ck_assert(!device_is_canopen(&device));
    setup();
    make();
    ck_assert(!config.own_target[SIDE_LEFT]);
    ck_assert(device_is_canopen(&device));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("device_config");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, the_limits_lie_on_the_side_that_compresses);
    tcase_add_test(tests, lengths_speeds_and_torques_are_told_in_the_drives_units);
    tcase_add_test(tests, each_node_has_its_number_and_its_objects);
    tcase_add_test(tests, a_motor_of_a_makers_protocol_is_no_canopen_node);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
