/* Two legs that share nothing: protocols, latches on boards, one drive alone, and drives that lack what
 * the virtual one has. */
#include <check.h>

#include "hal/bus/bytes.h"
#include "hal/devices/device_config.h"
#include "hal/devices/device_drives.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

static struct device_description device;
static struct device_drives all;
static struct sea_drives drives;
static struct sea_drive_command command[SIDE_COUNT];
static struct fake_bus fake;
static struct can_bus bus;

static void setup(void)
{
    device_description_default(&device);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device.leg[leg].counts_per_m = 1.0e6f;
        command[leg] = (struct sea_drive_command){.operational = true};
    }
    fake = (struct fake_bus){.verdict = CAN_OK};
    bus = fake_bus_interface(&fake);
}

static void start(void)
{
    device_drives_init(&all, &device);
    drives = device_drives_interface(&all);
}

static void make_odrive(struct device_leg *leg)
{
    leg->protocol = DEVICE_CANSIMPLE;
    leg->drive_node = 5;
    leg->turns_per_m = 200.0f;
    leg->direction = -1;
    leg->latch = DEVICE_LATCH_BOARD;
    leg->latch_node = 9;
    leg->latch_object = 0x210100;
}

static bool give(uint32_t id, const uint8_t *data, uint8_t length)
{
    struct can_msg message = {.id = id, .length = length};
    for (uint8_t i = 0; i < length; i++) {
        message.data[i] = data[i];
    }
    return sea_drives_receive(&drives, &message);
}

static struct sea_drive_reading read_leg(enum side leg)
{
    struct sea_drive_reading reading;
    sea_drives_read(&drives, leg, &reading);
    return reading;
}

static void send(void)
{
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_OK);
}

/* Operation enabled, follows, and 100000 counts. */
static const uint8_t enabled_at_100_mm[6] = {0x27, 0x10, 0xA0, 0x86, 0x01, 0x00};
/* -10 turns as a float, and no speed. */
static const uint8_t at_minus_10_turns[8] = {0x00, 0x00, 0x20, 0xC1};
static const uint8_t closed_loop[8] = {0, 0, 0, 0, 8};

START_TEST(a_cia402_drive_and_an_odrive_on_one_bus)
{
    make_odrive(&device.leg[SIDE_RIGHT]);
    start();
    ck_assert(give(0x181, enabled_at_100_mm, 6));
    ck_assert(!give(0x182, enabled_at_100_mm, 6)); /* the right leg has no such drive */
    ck_assert(give(0x0A9, at_minus_10_turns, 8));
    ck_assert(give(0x0A1, closed_loop, 8));
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_ENABLED);
    ck_assert_int_eq(read_leg(SIDE_RIGHT).state, DRIVE_ENABLED);
    assert_close(read_leg(SIDE_LEFT).precompression_m, 0.1, 1e-7, 0.0);
    assert_close(read_leg(SIDE_RIGHT).precompression_m, 0.05, 1e-7, 0.0);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        command[leg].enable = command[leg].latch_armed = true;
        command[leg].precompression_m = 0.02f;
    }
    send();
    ck_assert_uint_eq(fake_bus_last(&fake, 0x201)->length, 4); /* a target of its own */
    ck_assert_int_eq(bytes_get_i32(fake_bus_last(&fake, 0x201)->data), 20000);
    ck_assert_ptr_null(fake_bus_last(&fake, 0x202));
    ck_assert_uint_eq(fake_bus_last(&fake, 0x301)->data[4], 1); /* the left latch at the drive */
    ck_assert_ptr_null(fake_bus_last(&fake, 0x302));
    ck_assert_ptr_null(fake_bus_last(&fake, 0x303));
    ck_assert_uint_eq(fake_bus_last(&fake, 0x304)->length, 4);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x304)->data[2], 1); /* the right one on its board */
    assert_close(bytes_get_f32(fake_bus_last(&fake, 0x0AC)->data), -4.0, 1e-6, 0.0);
}
END_TEST

START_TEST(a_board_tells_whether_its_latch_holds)
{
    const uint8_t holds = 1, open = 0;
    make_odrive(&device.leg[SIDE_RIGHT]);
    start();
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_UNKNOWN);
    ck_assert(give(0x386, &holds, 1));
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_CLOSED);
    ck_assert(give(0x386, &open, 1));
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_OPEN);
    ck_assert(!give(0x385, &holds, 1)); /* there is no board at the left leg */
    ck_assert(give(0x386, at_minus_10_turns, 2));
    sea_drives_age(&drives);
    ck_assert_uint_eq(*drives.rx_malformed, 1);
    for (int i = 0; i <= HEARTBEAT_TIMEOUT_TICKS; i++) {
        sea_drives_age(&drives);
    }
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_UNKNOWN);
}
END_TEST

/* A board beside a drive that does not follow its target is not armed. */
START_TEST(no_board_is_armed_beside_an_idle_drive)
{
    make_odrive(&device.leg[SIDE_RIGHT]);
    start();
    command[SIDE_RIGHT].enable = command[SIDE_RIGHT].latch_armed = true;
    send();
    ck_assert_uint_eq(fake_bus_last(&fake, 0x304)->data[2], 0);
    ck_assert(give(0x0A1, closed_loop, 8));
    send();
    ck_assert_uint_eq(fake_bus_last(&fake, 0x304)->data[2], 1);
}
END_TEST

START_TEST(one_drive_alone)
{
    device.leg[SIDE_LEFT].protocol = DEVICE_NO_DRIVE_PROTOCOL;
    start();
    ck_assert(read_leg(SIDE_LEFT).absent && !read_leg(SIDE_RIGHT).absent);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
    ck_assert_uint_eq(read_leg(SIDE_LEFT).age_ticks, 0);
    ck_assert(!give(0x181, enabled_at_100_mm, 6));
    ck_assert(give(0x182, enabled_at_100_mm, 6));
    command[SIDE_LEFT].enable = command[SIDE_RIGHT].enable = true;
    command[SIDE_LEFT].latch_armed = true;
    send();
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_ENABLED);
    assert_close(read_leg(SIDE_LEFT).precompression_m, 0.0, 0.0, 0.0);
    ck_assert_ptr_null(fake_bus_last(&fake, 0x201));
    ck_assert_ptr_null(fake_bus_last(&fake, 0x301));
    ck_assert_uint_eq(fake_bus_last(&fake, 0x202)->length, 4);
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 0x302));
}
END_TEST

/* Both targets lie in one frame, 0x201, of which each drive takes its half; one that cannot pass over the other's
 * half gets a frame of its own, and so does the other then: 0x201 and 0x202. */
START_TEST(a_drive_without_dummy_entries_parts_the_targets)
{
    static const int32_t lacks[][SIDE_COUNT] = {
        {0, 0}, {1 << DEVICE_LACKS_DUMMY, 0}, {0, 1 << DEVICE_LACKS_DUMMY}};
    for (size_t i = 0; i < sizeof lacks / sizeof lacks[0]; i++) {
        device.leg[SIDE_LEFT].lacks = lacks[i][SIDE_LEFT];
        device.leg[SIDE_RIGHT].lacks = lacks[i][SIDE_RIGHT];
        start();
        for (int leg = 0; leg < SIDE_COUNT; leg++) {
            ck_assert_int_eq(all.state.cia402.axis[leg].config.own_target, i > 0);
        }
    }
}
END_TEST

/* EPOS4: no dummy entries, so both targets go apart; no voltage and no temperature of ours. */
START_TEST(a_drive_that_lacks_much)
{
    const uint8_t torque[2] = {0xF4, 0x01}; /* 500 per mille */
    device.leg[SIDE_LEFT].lacks = 1 << DEVICE_LACKS_DUMMY | 1 << DEVICE_LACKS_BUS_VOLTAGE |
                                  1 << DEVICE_LACKS_TEMPERATURE | 1 << DEVICE_LACKS_OUTPUTS |
                                  1 << DEVICE_LACKS_FOLLOWS_BIT;
    device.leg[SIDE_LEFT].latch = DEVICE_LATCH_BOARD;
    device.leg[SIDE_LEFT].latch_node = 20;
    device.leg[SIDE_RIGHT].latch_bit = 15;
    device.leg[SIDE_RIGHT].contact_bit = 13;
    start();
    uint8_t state[6] = {0x27, 0x00, 0xA0, 0x86, 0x01, 0x00}; /* bit 12 is 0 */
    ck_assert(give(0x181, state, 6));
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_ENABLED);
    state[1] = 0x90; /* right: follows, and bit 15 */
    ck_assert(give(0x182, state, 6));
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_CLOSED);
    ck_assert_int_eq(read_leg(SIDE_RIGHT).contact, FOOT_UP);
    ck_assert_int_eq(read_leg(SIDE_LEFT).contact, FOOT_UNKNOWN); /* it does not tell */
    state[1] = 0xB0;                                             /* and bit 13 */
    ck_assert(give(0x182, state, 6));
    ck_assert_int_eq(read_leg(SIDE_RIGHT).contact, FOOT_DOWN);
    ck_assert_int_eq(read_leg(SIDE_RIGHT).latch, LATCH_CLOSED);
    ck_assert(give(0x381, torque, 2));
    ck_assert(give(0x381, enabled_at_100_mm, 6)); /* taken, and counted as malformed */
    sea_drives_age(&drives);
    ck_assert_uint_eq(*drives.rx_malformed, 1);
    assert_close(read_leg(SIDE_LEFT).force_N, 17.5, 1e-6, 0.0);
    ck_assert(!read_leg(SIDE_LEFT).has_supply);
    command[SIDE_LEFT].enable = command[SIDE_RIGHT].enable = true;
    command[SIDE_LEFT].latch_armed = true;
    send();
    ck_assert_uint_eq(fake_bus_last(&fake, 0x201)->length, 4);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x202)->length, 4);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x301)->length, 2); /* the controlword alone */
    ck_assert_uint_eq(fake_bus_last(&fake, 0x303)->data[2], 1);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x302)->length, 6);
}
END_TEST

/* Interpolated position is run by bit 4 of the controlword, once the drive is enabled. */
START_TEST(interpolated_position_is_run_by_a_bit)
{
    const uint8_t switched_on[6] = {0x23};
    device.leg[SIDE_LEFT].mode = DEVICE_MODE_INTERPOLATED;
    start();
    command[SIDE_LEFT].enable = true;
    ck_assert(give(0x181, switched_on, 6));
    send();
    ck_assert_uint_eq(bytes_get_u16(fake_bus_last(&fake, 0x301)->data), 0x000F);
    ck_assert(give(0x181, enabled_at_100_mm, 6));
    send();
    ck_assert_uint_eq(bytes_get_u16(fake_bus_last(&fake, 0x301)->data), 0x001F);
}
END_TEST

/* 2^20 counts a turn in 32 bits, mirrored, with another zero; the ankle in 24 bits. */
START_TEST(sensors_of_other_scale_and_mounting)
{
    struct leg_sensor_config config[SIDE_COUNT];
    struct leg_sensors sensors;
    struct device_leg *right = &device.leg[SIDE_RIGHT];
    right->leg_sensor_bits = 32;
    right->leg_counts_per_turn = 1048576.0f;
    right->leg_direction = -1;
    right->leg_zero_rad = 1.0f;
    right->ankle_sensor_bits = 24;
    right->ankle_counts_per_m = 1.0e6f;
    right->ankle_direction = -1;
    right->ankle_zero_m = 0.05f;
    device_leg_sensors(&device, config);
    leg_sensors_init(&sensors, config);
    struct can_msg message = {.id = 0x284, .length = 7};
    bytes_put_u32(message.data, 133509);    /* 0.8 rad */
    bytes_put_u16(message.data + 4, 30000); /* 0.03 m */
    ck_assert(leg_sensors_receive(&sensors, &message));
    assert_close(sensors.reading[SIDE_RIGHT].leg_angle_rad, 0.2, 1e-5, 0.0);
    assert_close(sensors.reading[SIDE_RIGHT].ankle_extension_m, 0.02, 1e-7, 0.0);
    message.length = 5;
    ck_assert(leg_sensors_receive(&sensors, &message));
    ck_assert_uint_eq(sensors.rx_malformed, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("device_drives");
    TCase *tcase = tcase_create("all");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, a_cia402_drive_and_an_odrive_on_one_bus);
    tcase_add_test(tcase, a_board_tells_whether_its_latch_holds);
    tcase_add_test(tcase, no_board_is_armed_beside_an_idle_drive);
    tcase_add_test(tcase, one_drive_alone);
    tcase_add_test(tcase, a_drive_without_dummy_entries_parts_the_targets);
    tcase_add_test(tcase, a_drive_that_lacks_much);
    tcase_add_test(tcase, interpolated_position_is_run_by_a_bit);
    tcase_add_test(tcase, sensors_of_other_scale_and_mounting);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
