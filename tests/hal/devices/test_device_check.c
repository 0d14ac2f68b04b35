/* Every refusal of a device's description, from one that fits, and what each key says of a leg. */
#include <check.h>
#include <math.h>

#include "hal/bus/frame_table.h"
#include "hal/devices/device_check.h"
#include "hal/devices/device_config.h"
#include "hal/devices/device_nodes.h"
#include "tests/support/assert_close.h"

static struct device_description device;
static struct device_refusal refusal;

static void setup(void)
{
    device_description_default(&device);
}

static struct device_leg *left(void)
{
    return &device.leg[SIDE_LEFT];
}

static struct device_leg *right(void)
{
    return &device.leg[SIDE_RIGHT];
}

static void make_mit(struct device_leg *leg, int32_t motor, int32_t answer)
{
    leg->protocol = DEVICE_MIT;
    leg->drive_node = motor;
    leg->answer_id = answer;
    leg->rad_per_m = 50.0f;
    leg->zero_rad = -12.0f;
    leg->position_range_rad = 12.5f;
    leg->velocity_range_rad_s = 50.0f;
    leg->torque_range_Nm = 18.0f;
    leg->latch = DEVICE_LATCH_BOARD;
    leg->latch_node = 20 + motor;
    leg->unload = DEVICE_UNLOAD_NONE;
}

static void make_cansimple(struct device_leg *leg, int32_t axis)
{
    leg->protocol = DEVICE_CANSIMPLE;
    leg->drive_node = axis;
    leg->turns_per_m = 200.0f;
    leg->latch = DEVICE_LATCH_BOARD;
    leg->latch_node = 20 + axis;
    leg->unload = DEVICE_UNLOAD_NONE;
}

#define REFUSED(expected, side, field)                                 \
    do {                                                               \
        ck_assert_int_eq(device_check(&device, &refusal), (expected)); \
        ck_assert_int_eq(refusal.verdict, (expected));                 \
        ck_assert_int_eq(refusal.leg, (side));                         \
        ck_assert_uint_eq(refusal.key, (unsigned)DEVICE_LEG_##field);  \
    } while (0)
#define FITS() ck_assert_int_eq(device_check(&device, &refusal), DEVICE_OK)

START_TEST(the_default_fits_and_so_do_legs_that_share_nothing)
{
    FITS();
    make_mit(left(), 9, 17);
    make_cansimple(right(), 63);
    right()->direction = -1;
    right()->ankle = DEVICE_ANKLE_LEVER;
    right()->ankle_lever_m = 0.1f;
    right()->ankle_sensor_node = 77;
    FITS();
    left()->protocol = DEVICE_NO_DRIVE_PROTOCOL;
    FITS();
}
END_TEST

/* The nodes are set up where every drive that is there speaks CiA 402. */
START_TEST(a_leg_without_a_drive_leaves_the_other_canopen)
{
    static const struct {
        int32_t left, right;
        bool is;
    } rows[] = {{DEVICE_CIA402, DEVICE_CIA402, true},
                {DEVICE_NO_DRIVE_PROTOCOL, DEVICE_CIA402, true},
                {DEVICE_CIA402, DEVICE_NO_DRIVE_PROTOCOL, true},
                {DEVICE_CIA402, DEVICE_MIT, false},
                {DEVICE_CANSIMPLE, DEVICE_CIA402, false},
                {DEVICE_NO_DRIVE_PROTOCOL, DEVICE_MIT, false}};
    for (unsigned i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        left()->protocol = rows[i].left;
        right()->protocol = rows[i].right;
        ck_assert_int_eq(device_is_canopen(&device), rows[i].is);
    }
}
END_TEST

/* Both ends of every range, and one step beyond each; what says nothing is not looked at. */
START_TEST(every_key_has_a_range_that_holds)
{
    for (unsigned key = 0; key < DEVICE_LEG_COUNT; key++) {
        const struct device_key *row = device_key_row(SIDE_LEFT, key);
        ck_assert(row->minimum <= row->maximum);
        ck_assert_int_eq(device_key_check(row, row->maximum), DEVICE_OK);
        ck_assert_int_eq(device_key_check(row, nextafterf(row->maximum, INFINITY)),
                         DEVICE_BAD_RANGE);
        ck_assert_int_eq(device_key_check(row, nextafterf(row->minimum, -INFINITY)),
                         DEVICE_BAD_RANGE);
        ck_assert_int_eq(device_key_check(row, NAN), DEVICE_BAD_NOT_FINITE);
        ck_assert_int_eq(device_key_check(row, INFINITY), DEVICE_BAD_NOT_FINITE);
        ck_assert(row->fallback == DEVICE_ASKED ||
                  device_key_check(row, row->fallback) == DEVICE_OK);
    }
    left()->stroke_max_m = NAN;
    REFUSED(DEVICE_BAD_NOT_FINITE, SIDE_LEFT, stroke_max_m);
    left()->protocol = DEVICE_NO_DRIVE_PROTOCOL; /* then its stroke is nothing */
    FITS();
}
END_TEST

START_TEST(directions_are_one_way_or_the_other)
{
    left()->direction = 0;
    REFUSED(DEVICE_BAD_DIRECTION, SIDE_LEFT, direction);
    setup();
    right()->leg_direction = 0;
    REFUSED(DEVICE_BAD_DIRECTION, SIDE_RIGHT, leg_direction);
    setup();
    right()->ankle_direction = 0;
    REFUSED(DEVICE_BAD_DIRECTION, SIDE_RIGHT, ankle_direction);
}
END_TEST

START_TEST(no_two_units_share_a_number)
{
    static const int32_t taken[] = {1, 3, 4, NODE_CONTROLLER};
    for (unsigned i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        setup();
        right()->drive_node = taken[i];
        const enum device_verdict verdict = device_check(&device, &refusal);
        ck_assert_int_eq(verdict, DEVICE_BAD_NODE_TAKEN);
        ck_assert(refusal.found == (float)taken[i]);
    }
    setup();
    right()->leg_sensor_node = right()->ankle_sensor_node = 5; /* one sensor for both */
    FITS();
    right()->ankle_sensor_node = 3;
    REFUSED(DEVICE_BAD_NODE_TAKEN, SIDE_RIGHT, ankle_sensor_node);
}
END_TEST

/* CANSimple axis n has identifiers 32 n to 32 n + 31: axis 4 is SYNC, 12 the drives' TPDO1, 20 a sensor's
 * TPDO2, 44 and 48 the SDOs, 56 the heartbeats; 5 is free. Motors in MIT mode take identifiers one by one. */
START_TEST(no_two_units_share_an_identifier)
{
    static const int32_t clash[] = {4, 12, 16, 20, 24, 28, 44, 48, 56},
                         free_axis[] = {1, 5, 11, 63};
    make_mit(left(), 9, 17);
    for (unsigned i = 0; i < sizeof clash / sizeof clash[0]; i++) {
        make_cansimple(right(), clash[i]);
        right()->latch_node = 30;
        REFUSED(DEVICE_BAD_ID_TAKEN, SIDE_RIGHT, drive_node);
        ck_assert_uint_eq((unsigned)refusal.allowed / 32,
                          (unsigned)clash[i]); /* the identifier, one of its own */
    }
    for (unsigned i = 0; i < sizeof free_axis / sizeof free_axis[0]; i++) {
        make_cansimple(right(), free_axis[i]);
        right()->latch_node = 30;
        FITS();
    }
    make_cansimple(right(), 4);
    right()->latch_node = 30;
    REFUSED(DEVICE_BAD_ID_TAKEN, SIDE_RIGHT, drive_node);
    ck_assert_uint_eq((unsigned)refusal.allowed, 0x080); /* SYNC, the first of them */
    make_mit(right(), 10, 9); /* answers with the other motor's identifier */
    REFUSED(DEVICE_BAD_ID_TAKEN, SIDE_RIGHT, drive_node);
    ck_assert_uint_eq((unsigned)refusal.allowed, 9);
    make_mit(right(), 10, 17);
    REFUSED(DEVICE_BAD_ID_TAKEN, SIDE_RIGHT, drive_node);
}
END_TEST

/* Left leg first: its drive, its board, its sensors. Only a motor in MIT mode has an identifier for its answers. */
START_TEST(each_unit_has_its_own_numbers)
{
    struct device_unit units[DEVICE_UNITS_MAX];
    make_mit(left(), 9, 17);
    make_cansimple(right(), 5);
    right()->answer_id = 18; /* means nothing there */
    left()->leg_sensor_node = 3;
    right()->leg_sensor_node = 4;
    const struct device_unit expected[] = {
        {SIDE_LEFT, DEVICE_LEG_drive_node, DEVICE_MIT, 9, 17},
        {SIDE_LEFT, DEVICE_LEG_latch_node, DEVICE_CIA402, 29, 0},
        {SIDE_LEFT, DEVICE_LEG_leg_sensor_node, DEVICE_CIA402, 3, 0},
        {SIDE_RIGHT, DEVICE_LEG_drive_node, DEVICE_CANSIMPLE, 5, 0},
        {SIDE_RIGHT, DEVICE_LEG_latch_node, DEVICE_CIA402, 25, 0},
        {SIDE_RIGHT, DEVICE_LEG_leg_sensor_node, DEVICE_CIA402, 4, 0},
    };
    const unsigned count = device_units(&device, units);
    ck_assert_uint_eq(count, sizeof expected / sizeof expected[0]);
    for (unsigned i = 0; i < count; i++) {
        ck_assert_int_eq(units[i].leg, expected[i].leg);
        ck_assert_uint_eq(units[i].key, expected[i].key);
        ck_assert_uint_eq(units[i].protocol, expected[i].protocol);
        ck_assert_uint_eq(units[i].number, expected[i].number);
        ck_assert_uint_eq(units[i].answer_id, expected[i].answer_id);
    }
}
END_TEST

/* device_keys.h: bits in the drive's words are for a latch at the drive, a board has a node. */
START_TEST(a_latch_has_the_keys_of_its_place)
{
    static const struct {
        enum device_latch latch;
        bool at_drive, on_board;
    } places[] = {{DEVICE_LATCH_NONE, false, false},
                  {DEVICE_LATCH_DRIVE, true, false},
                  {DEVICE_LATCH_BOARD, false, true}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        left()->latch = (int32_t)places[i].latch;
        ck_assert_int_eq(device_key_applies(left(), DEVICE_LEG_latch_bit), places[i].at_drive);
        ck_assert_int_eq(device_key_applies(left(), DEVICE_LEG_latch_node), places[i].on_board);
    }
    left()->protocol = DEVICE_NO_DRIVE_PROTOCOL;
    ck_assert(!device_key_applies(left(), DEVICE_LEG_latch_node));
}
END_TEST

START_TEST(a_drive_has_the_keys_of_its_protocol)
{
    for (int32_t protocol = DEVICE_NO_DRIVE_PROTOCOL; protocol <= DEVICE_MIT; protocol++) {
        left()->protocol = protocol;
        ck_assert_int_eq(device_key_applies(left(), DEVICE_LEG_direction),
                         protocol != DEVICE_NO_DRIVE_PROTOCOL);
        ck_assert_int_eq(device_key_applies(left(), DEVICE_LEG_turns_per_m),
                         protocol == DEVICE_CANSIMPLE);
    }
}
END_TEST

START_TEST(a_number_has_as_many_bits_as_its_protocol)
{
    make_cansimple(left(), 64);
    REFUSED(DEVICE_BAD_NUMBER, SIDE_LEFT, drive_node);
    make_mit(left(), 32, 17);
    REFUSED(DEVICE_BAD_NUMBER, SIDE_LEFT, drive_node);
}
END_TEST

START_TEST(the_stroke_stays_where_positions_can_be_said)
{
    left()->zero_counts =
        -1073741824; /* the range leaves the longest stroke at the finest scale room */
    REFUSED(DEVICE_BAD_RANGE, SIDE_LEFT, zero_counts);
    const float furthest = device_key_row(SIDE_LEFT, DEVICE_LEG_zero_counts)->maximum +
                           device_key_row(SIDE_LEFT, DEVICE_LEG_stroke_max_m)->maximum *
                               device_key_row(SIDE_LEFT, DEVICE_LEG_counts_per_m)->maximum;
    ck_assert(furthest < 1073741824.0f); /* half of 32 bits */
    setup();
    make_mit(left(), 9, 17);
    left()->direction = -1; /* from -12 rad further down */
    REFUSED(DEVICE_BAD_STROKE_FIELD, SIDE_LEFT, zero_rad);
    left()->zero_rad = 12.0f;
    FITS();
}
END_TEST

/* counts per metre = counts per turn * gear / travel per turn; force = torque * 2 pi * gear / travel. */
START_TEST(what_is_told_twice_is_told_alike)
{
    left()->counts_per_turn = 4096.0f;
    left()->gear = 8.0f;
    left()->travel_per_turn_m = 0.005f;
    REFUSED(DEVICE_BAD_SCALE, SIDE_LEFT, counts_per_m);
    ck_assert(fabsf(refusal.allowed - 6553600.0f) <= 10.0f);
    left()->gear = 16.0f;
    FITS();
    left()->rated_torque_Nm = 0.0017407f; /* 35 N * 0.005 m / (2 pi * 16) */
    FITS();
    left()->rated_torque_Nm = 0.0034f; /* twice: the torque constant of another winding */
    REFUSED(DEVICE_BAD_TORQUE, SIDE_LEFT, rated_force_N);
    setup();
    make_cansimple(right(), 5);
    right()->travel_per_turn_m = 0.004f;
    REFUSED(DEVICE_BAD_SCALE, SIDE_RIGHT, turns_per_m);
    right()->travel_per_turn_m = 0.005f;
    right()->counts_per_turn = 65536.0f;
    FITS();
    make_mit(right(), 9, 17);
    right()->travel_per_turn_m = 0.0f;
    FITS();
    right()->counts_per_turn = 0.0f;
    right()->travel_per_turn_m = 0.1256637f; /* 2 pi * 20 mm */
    FITS();
    right()->travel_per_turn_m = 0.11f;
    REFUSED(DEVICE_BAD_SCALE, SIDE_RIGHT, rad_per_m);
}
END_TEST

START_TEST(what_the_controller_has_one_number_for_is_alike)
{
    right()->spring_N_per_m = 103.0f;
    REFUSED(DEVICE_BAD_SPRINGS, SIDE_RIGHT, spring_N_per_m);
    left()->protocol = DEVICE_NO_DRIVE_PROTOCOL; /* one spring only */
    FITS();
    setup();
    right()->spring_N_per_m = 101.5f;
    right()->ankle_latency_s = 0.002f;
    REFUSED(DEVICE_BAD_LATENCIES, SIDE_RIGHT, ankle_latency_s);
    right()->ankle_latency_s = 0.0001f;
    right()->leg_latency_s = 0.001f;
    REFUSED(DEVICE_BAD_LATENCIES, SIDE_RIGHT, leg_latency_s);
}
END_TEST

START_TEST(a_latch_tells_where_it_can)
{
    make_cansimple(left(), 5);
    left()->latch = DEVICE_LATCH_DRIVE;
    REFUSED(DEVICE_BAD_LATCH_BIT, SIDE_LEFT, latch);
    left()->latch = DEVICE_LATCH_BOARD;
    left()->unload = DEVICE_UNLOAD_LATCH;
    REFUSED(DEVICE_BAD_UNLOAD_LATCH, SIDE_LEFT, unload);
    left()->latch_object = 0x210100;
    FITS();
    left()->latch_object = 0x0FFF00;
    REFUSED(DEVICE_BAD_OBJECT, SIDE_LEFT, latch_object);
}
END_TEST

START_TEST(without_a_latch_that_reports_a_person_is_refused)
{
    ck_assert_int_eq(device_check_person(&device, &refusal), DEVICE_OK);
    right()->latch = DEVICE_LATCH_NONE;
    ck_assert_int_eq(device_check(&device, &refusal), DEVICE_OK);
    ck_assert_int_eq(device_check_person(&device, &refusal), DEVICE_BAD_BENCH_ONLY);
    ck_assert(refusal.allowed == 0.0f); /* not one number */
    ck_assert_int_eq(refusal.leg, SIDE_RIGHT);
    right()->latch = DEVICE_LATCH_BOARD;
    right()->latch_node = 9;
    ck_assert_int_eq(device_check_person(&device, &refusal), DEVICE_BAD_BENCH_ONLY);
    right()->latch_object = 0x210100;
    ck_assert_int_eq(device_check_person(&device, &refusal), DEVICE_OK);
    right()->latch = DEVICE_LATCH_NONE;
    right()->protocol = DEVICE_NO_DRIVE_PROTOCOL; /* no spring there */
    ck_assert_int_eq(device_check_person(&device, &refusal), DEVICE_OK);
}
END_TEST

START_TEST(without_a_spring_that_is_safe_on_link_loss_a_person_is_refused)
{
    for (int unload = DEVICE_UNLOAD_NONE; unload <= DEVICE_UNLOAD_HARDWARE; unload++) {
        right()->unload = unload;
        ck_assert_int_eq(device_check(&device, &refusal), DEVICE_OK);
        ck_assert_int_eq(device_check_person(&device, &refusal),
                         unload == DEVICE_UNLOAD_NONE ? DEVICE_BAD_UNLOAD_PERSON : DEVICE_OK);
    }
    right()->unload = DEVICE_UNLOAD_NONE;
    (void)device_check_person(&device, &refusal);
    ck_assert_int_eq(refusal.leg, SIDE_RIGHT);
    ck_assert_uint_eq(refusal.key, DEVICE_LEG_unload);
    right()->protocol = DEVICE_NO_DRIVE_PROTOCOL;
    ck_assert_int_eq(device_check_person(&device, &refusal), DEVICE_OK);
}
END_TEST

START_TEST(a_lever_s_table_is_whole)
{
    left()->ankle_table_rad = 0.1f;
    FITS(); /* a linear ankle has none */
    left()->ankle = DEVICE_ANKLE_LEVER;
    REFUSED(DEVICE_BAD_LEVER_TABLE, SIDE_LEFT, ankle_table_1_m);
    left()->ankle_table_1_m = left()->ankle_table_2_m = left()->ankle_table_3_m = 0.1f;
    left()->ankle_table_4_m = 0.009f;
    REFUSED(DEVICE_BAD_LEVER_TABLE, SIDE_LEFT, ankle_table_4_m);
    left()->ankle_table_4_m = 0.01f;
    FITS();
}
END_TEST

/* A limit has a counterpart, and room between them; the margins are those that device_keys.h names. */
START_TEST(limits_leave_room_between_them)
{
    left()->temperature_stop_degC = 0.5f;
    REFUSED(DEVICE_BAD_LIMIT_ORDER, SIDE_LEFT, temperature_stop_degC);
    left()->temperature_stop_degC = 100.0f;
    REFUSED(DEVICE_BAD_LIMIT_ORDER, SIDE_LEFT, temperature_stop_degC);
    left()->temperature_warn_degC = 100.0f;
    REFUSED(DEVICE_BAD_LIMIT_ORDER, SIDE_LEFT, temperature_stop_degC);
    left()->temperature_warn_degC = 99.0f;
    FITS();
    left()->temperature_stop_degC = 0.0f;
    REFUSED(DEVICE_BAD_LIMIT_ORDER, SIDE_LEFT, temperature_stop_degC);
    setup();
    right()->supply_min_V = 20.0f;
    FITS();
    right()->supply_max_V = 22.0f; /* 20 * 1.05 = 21, 22 * 0.95 = 20.9 */
    REFUSED(DEVICE_BAD_LIMIT_ORDER, SIDE_RIGHT, supply_max_V);
    right()->supply_max_V = 22.2f;
    FITS();
    right()->supply_min_V = 0.0f;
    FITS();
}
END_TEST

/* What a drive does not tell has no limit: nobody would watch it. */
START_TEST(only_what_is_told_has_limits)
{
    right()->temperature_warn_degC = 80.0f;
    right()->temperature_stop_degC = 100.0f;
    right()->lacks = 1 << DEVICE_LACKS_TEMPERATURE;
    REFUSED(DEVICE_BAD_NOT_TOLD, SIDE_RIGHT, temperature_stop_degC);
    right()->lacks = 0;
    right()->supply_max_V = 48.0f;
    FITS();
    right()->lacks = 1 << DEVICE_LACKS_BUS_VOLTAGE;
    REFUSED(DEVICE_BAD_NOT_TOLD, SIDE_RIGHT, supply_max_V);
    right()->supply_min_V = 20.0f;
    REFUSED(DEVICE_BAD_NOT_TOLD, SIDE_RIGHT, supply_min_V);
    setup();
    make_mit(left(), 9, 17);
    left()->temperature_warn_degC = 60.0f;
    left()->temperature_stop_degC = 75.0f;
    FITS();
    left()->supply_min_V = 20.0f;
    REFUSED(DEVICE_BAD_NOT_TOLD, SIDE_LEFT, supply_min_V);
    setup();
    make_cansimple(left(), 5);
    left()->temperature_warn_degC = 60.0f;
    left()->temperature_stop_degC = 75.0f;
    REFUSED(DEVICE_BAD_NOT_TOLD, SIDE_LEFT, temperature_stop_degC);
}
END_TEST

START_TEST(other_whole_reasons)
{
    left()->ankle_side = DEVICE_AT_MOTOR;
    REFUSED(DEVICE_BAD_MOTOR_SIDE, SIDE_LEFT, ankle_side);
    setup();
    left()->protocol = right()->protocol = DEVICE_NO_DRIVE_PROTOCOL;
    REFUSED(DEVICE_BAD_NO_DRIVE, SIDE_LEFT, protocol);
    setup();
    device.common.tick_us = TICK_PERIOD_US + 1000;
    ck_assert_int_eq(device_check(&device, &refusal), DEVICE_BAD_TICK);
    ck_assert_int_eq(refusal.leg, -1);
    setup();
    device.common.bitrate_bit_s = BUS_BITRATE / 2;
    ck_assert_int_eq(device_check(&device, &refusal), DEVICE_BAD_BITRATE);
    device.common.bitrate_bit_s = 1;
    ck_assert_int_eq(device_check(&device, &refusal), DEVICE_BAD_RANGE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("device_check");
    TCase *tcase = tcase_create("device_check");
    tcase_add_checked_fixture(tcase, setup, NULL);
    tcase_add_test(tcase, the_default_fits_and_so_do_legs_that_share_nothing);
    tcase_add_test(tcase, a_leg_without_a_drive_leaves_the_other_canopen);
    tcase_add_test(tcase, every_key_has_a_range_that_holds);
    tcase_add_test(tcase, directions_are_one_way_or_the_other);
    tcase_add_test(tcase, no_two_units_share_a_number);
    tcase_add_test(tcase, no_two_units_share_an_identifier);
    tcase_add_test(tcase, each_unit_has_its_own_numbers);
    tcase_add_test(tcase, a_latch_has_the_keys_of_its_place);
    tcase_add_test(tcase, a_drive_has_the_keys_of_its_protocol);
    tcase_add_test(tcase, a_number_has_as_many_bits_as_its_protocol);
    tcase_add_test(tcase, the_stroke_stays_where_positions_can_be_said);
    tcase_add_test(tcase, what_is_told_twice_is_told_alike);
    tcase_add_test(tcase, what_the_controller_has_one_number_for_is_alike);
    tcase_add_test(tcase, a_latch_tells_where_it_can);
    tcase_add_test(tcase, without_a_latch_that_reports_a_person_is_refused);
    tcase_add_test(tcase, without_a_spring_that_is_safe_on_link_loss_a_person_is_refused);
    tcase_add_test(tcase, a_lever_s_table_is_whole);
    tcase_add_test(tcase, limits_leave_room_between_them);
    tcase_add_test(tcase, only_what_is_told_has_limits);
    tcase_add_test(tcase, other_whole_reasons);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
