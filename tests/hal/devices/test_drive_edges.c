/* The foreign drives where the world does not keep to the way: frames that are cut or no answers,
 * motors that refuse, a bus that is full, counters and ages at their ends. Bytes by hand from the
 * makers' descriptions, as in test_sea_drive_foreign.c. */
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/devices/sea_drive_cansimple.h"
#include "hal/devices/sea_drive_mit.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

static struct fake_bus fake;
static struct can_bus bus;
static struct cansimple_drives odrive;
static struct mit_drives motors;
static struct sea_drives drives;
static struct sea_drive_command command[SIDE_COUNT];

static void setup(void)
{
    fake_bus_init(&fake);
    bus = fake_bus_interface(&fake);
    memset(command, 0, sizeof command);
}

static bool give(uint32_t id, const uint8_t *data, uint8_t length, uint8_t flags)
{
    struct can_msg frame = {.id = id, .length = length, .flags = flags};
    memcpy(frame.data, data, length);
    return sea_drives_receive(&drives, &frame);
}

static struct sea_drive_reading read_leg(enum side leg)
{
    struct sea_drive_reading reading;
    sea_drives_read(&drives, leg, &reading);
    return reading;
}

static void send_commands(void)
{
    fake_bus_clear(&fake);
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_OK);
}

/* ---- CANSimple ---------------------------------------------------------------------------- */

static const uint8_t at_1_turn[8] = {0x00, 0x00, 0x80, 0x3F};
static const uint8_t idle[8] = {0, 0, 0, 0, 1};
static const uint8_t calibrating[8] = {0, 0, 0, 0, 3};
static const uint8_t closed_loop[8] = {0, 0, 0, 0, 8};
static const uint8_t in_error[8] = {0x00, 0x02, 0, 0, 1};

static void setup_odrive(void)
{
    static const struct cansimple_axis_config config[SIDE_COUNT] = {{1, 200.0f, 0.0f, 1},
                                                                    {2, 200.0f, 0.0f, -1}};
    setup();
    cansimple_drives_init(&odrive, config);
    drives = cansimple_drives_interface(&odrive);
}

START_TEST(cansimple_takes_no_frame_that_is_none)
{
    ck_assert(give(0x021, idle, 4, 0)); /* cut short: counted, not used */
    ck_assert_uint_eq(odrive.rx_malformed, 1);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    ck_assert(!give(0x021, idle, 8, CAN_FRAME_EXTENDED));
    ck_assert(give(0x021, idle, 8, CAN_FRAME_REMOTE)); /* its identifier, but a question */
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    ck_assert(give(0x03C, idle, 8, 0)); /* another of its messages: nothing to know from it */
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    odrive.rx_malformed = UINT32_MAX;
    ck_assert(give(0x041, idle, 1, 0));
    ck_assert_uint_eq(odrive.rx_malformed, UINT32_MAX);
}
END_TEST

START_TEST(cansimple_on_its_way_is_starting)
{
    ck_assert(give(0x021, calibrating, 8, 0));
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_STARTING);
    send_commands(); /* not asked for: back to idle */
    ck_assert_uint_eq(fake_bus_last(&fake, 0x027)->data[0], 1);
    ck_assert(give(0x041, calibrating, 8, 0));
    command[SIDE_RIGHT].enable = true;
    send_commands(); /* asked for: let it come */
    ck_assert_ptr_null(fake_bus_last(&fake, 0x047));
}
END_TEST

/* An error is cleared when that is asked for, and only then. */
START_TEST(cansimple_errors_are_cleared_when_asked)
{
    ck_assert(give(0x021, in_error, 8, 0));
    command[SIDE_LEFT].enable = true;
    send_commands();
    ck_assert_ptr_null(fake_bus_last(&fake, 0x038));
    command[SIDE_LEFT].clear_fault = true;
    send_commands();
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 0x038)); /* Clear_Errors = 0x18 of node 1 */
    ck_assert_uint_eq(fake_bus_last(&fake, 0x038)->length, 0);
    send_commands();
    ck_assert_ptr_null(fake_bus_last(&fake, 0x038)); /* not again at once */
}
END_TEST

/* Closed loop only at a position that is fresh; no position frame before any was heard. */
START_TEST(cansimple_enters_at_a_fresh_position)
{
    ck_assert(give(0x021, idle, 8, 0));
    command[SIDE_LEFT].enable = true;
    send_commands();
    ck_assert_ptr_null(fake_bus_last(&fake, 0x02C));
    ck_assert_ptr_null(fake_bus_last(&fake, 0x027));
    ck_assert(give(0x029, at_1_turn, 8, 0));
    sea_drives_age(&drives);
    send_commands();
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 0x02C));
    ck_assert_ptr_null(fake_bus_last(&fake, 0x027)); /* a cycle old */
    ck_assert(give(0x029, at_1_turn, 8, 0));
    send_commands(); /* the mode, then the state */
    ck_assert_ptr_nonnull(fake_bus_last(&fake, 0x02B));
    ck_assert_ptr_null(fake_bus_last(&fake, 0x027));
    send_commands();
    ck_assert_uint_eq(fake_bus_last(&fake, 0x027)->data[0], 8);
}
END_TEST

/* Somebody may have set another mode meanwhile: each start begins with it. */
START_TEST(cansimple_a_start_that_was_broken_off_begins_anew)
{
    ck_assert(give(0x021, idle, 8, 0));
    ck_assert(give(0x029, at_1_turn, 8, 0));
    for (int start = 0; start < 2; start++) {
        command[SIDE_LEFT].enable = true;
        fake_bus_clear(&fake);
        send_commands();
        ck_assert_uint_eq(fake_bus_count(&fake, 0x02B), 1);
        ck_assert_uint_eq(fake_bus_count(&fake, 0x027), 0);
        command[SIDE_LEFT].enable = false;
        send_commands();
    }
}
END_TEST

/* A drive in fault has left closed loop by itself. */
START_TEST(cansimple_a_fault_is_not_asked_to_leave)
{
    static const uint8_t watchdog[8] = {0x00, 0x08, 0, 0, 1};
    ck_assert(give(0x029, at_1_turn, 8, 0));
    ck_assert(give(0x021, watchdog, 8, 0));
    send_commands();
    ck_assert_ptr_null(fake_bus_last(&fake, 0x027));
    ck_assert(give(0x021, closed_loop, 8, 0));
    send_commands();
}
END_TEST

START_TEST(cansimple_says_what_the_bus_refused)
{
    ck_assert(give(0x021, idle, 8, 0));
    ck_assert(give(0x029, at_1_turn, 8, 0));
    command[SIDE_LEFT].enable = true;
    fake.verdict = CAN_FULL;
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_FULL);
    setup_odrive(); /* nothing heard: nothing is sent */
    fake.verdict = CAN_DOWN;
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_OK);
    setup_odrive(); /* idle, never a position: the requests alone */
    ck_assert(give(0x021, closed_loop, 8, 0));
    fake.verdict = CAN_FULL;
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_FULL);
}
END_TEST

/* What the bus did not take goes out in the next tick: above all the request to leave closed loop. */
START_TEST(cansimple_what_was_refused_is_sent_in_the_next_tick)
{
    ck_assert(give(0x021, idle, 8, 0));
    ck_assert(give(0x029, at_1_turn, 8, 0));
    command[SIDE_LEFT].enable = true;
    for (int k = 0; k < 2; k++) { /* the mode, then the state */
        const uint32_t id = k == 0 ? 0x02B : 0x027;
        fake.verdict = CAN_FULL;
        ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_FULL);
        ck_assert_uint_eq(fake_bus_count(&fake, id), 0);
        fake.verdict = CAN_OK;
        send_commands();
        ck_assert_uint_eq(fake_bus_count(&fake, id), 1);
    }
    setup_odrive();
    ck_assert(give(0x021, closed_loop, 8, 0));
    ck_assert(give(0x029, at_1_turn, 8, 0));
    fake.verdict = CAN_FULL;
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_FULL);
    fake.verdict = CAN_OK;
    send_commands();
    ck_assert_uint_eq(fake_bus_count(&fake, 0x027), 1);
    ck_assert_uint_eq(fake_bus_last(&fake, 0x027)->data[0], CANSIMPLE_STATE_IDLE);
}
END_TEST

START_TEST(cansimple_ages_stay_at_never)
{
    for (int i = 0; i < 70000; i++) {
        sea_drives_age(&drives);
    }
    ck_assert_uint_eq(read_leg(SIDE_LEFT).age_ticks, UINT16_MAX);
    ck_assert(give(0x029, at_1_turn, 8, 0));
    sea_drives_age(&drives);
    ck_assert_uint_eq(read_leg(SIDE_LEFT).age_ticks, 1);
}
END_TEST

/* ---- MIT mode ----------------------------------------------------------------------------- */

/* -12 rad of +-12.5: the unloaded spring. */
static const uint8_t answer[8] = {1, 0x05, 0x1F, 0x7F, 0xF7, 0xFF, 30, 0};
static const uint8_t answer_with_error[8] = {1, 0x05, 0x1F, 0x7F, 0xF7, 0xFF, 30, 3};

static void setup_mit(void)
{
    struct mit_axis_config config[SIDE_COUNT];
    setup();
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        config[leg] = (struct mit_axis_config){.motor_id = (uint8_t)(1 + leg),
                                               .answer_id = (uint16_t)(0x11 + leg),
                                               .rad_per_m = 50.0f,
                                               .zero_rad = -12.0f,
                                               .direction = 1,
                                               .kp_Nm_rad = 500.0f,
                                               .kd_Nms_rad = 5.0f,
                                               .spring_N_per_m = 100.0f,
                                               .stroke_max_m = 0.35f,
                                               .ranges = {12.5f, 50.0f, 18.0f, 500.0f, 5.0f}};
    }
    mit_drives_init(&motors, config);
    drives = mit_drives_interface(&motors);
}

START_TEST(mit_takes_no_frame_that_is_none)
{
    static const uint8_t of_another[8] = {2, 0x05, 0x1F, 0x7F, 0xF7, 0xFF, 30, 0};
    ck_assert(give(0x11, answer, 5, 0));
    ck_assert(give(0x11, of_another, 8, 0));
    ck_assert_uint_eq(motors.rx_malformed, 2);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    ck_assert(!give(0x11, answer, 8, CAN_FRAME_EXTENDED));
    ck_assert(!give(0x13, answer, 8, 0));
    motors.rx_malformed = UINT32_MAX;
    ck_assert(give(0x11, answer, 1, 0));
    ck_assert_uint_eq(motors.rx_malformed, UINT32_MAX);
    ck_assert(give(0x11, answer, 6, 0)); /* without temperature and error: older firmware */
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
    ck_assert(!read_leg(SIDE_LEFT).has_temperature);
}
END_TEST

/* Byte 6 of its answer, in degrees; an answer too long ago tells nothing any more. */
START_TEST(mit_tells_its_temperature)
{
    static const uint8_t warm[8] = {1, 0x05, 0x1F, 0x7F, 0xF7, 0xFF, 73, 0};
    ck_assert(!read_leg(SIDE_LEFT).has_temperature);
    ck_assert(give(0x11, warm, 8, 0));
    ck_assert(read_leg(SIDE_LEFT).has_temperature && !read_leg(SIDE_LEFT).has_supply);
    assert_close(read_leg(SIDE_LEFT).temperature_degC, 73.0, 0.0, 0.0);
    for (int i = 0; i < SEA_DRIVE_SLOW_TICKS + 1; i++) {
        sea_drives_age(&drives);
    }
    ck_assert(!read_leg(SIDE_LEFT).has_temperature);
}
END_TEST

/* 0.1 of the stroke beyond either end is still taken for the zero's tolerance, more is not. */
START_TEST(mit_refuses_positions_beyond_the_stroke)
{
    static const struct {
        float metres;
        enum drive_state state;
    } cases[] = {{-0.034f, DRIVE_DISABLED}, {0.384f, DRIVE_DISABLED}, {0.386f, DRIVE_FAULT}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setup_mit();
        motors.axis[SIDE_LEFT].config.zero_rad = -9.0f; /* so that both ends can be sent */
        const double turn = (-9.0 + 50.0 * (double)cases[i].metres + 12.5) / 25.0 * 65535.0;
        const uint32_t field = (uint32_t)(turn + 0.5);
        const uint8_t bytes[8] = {1, (uint8_t)(field >> 8), (uint8_t)(field & 0xFF)};
        ck_assert(give(0x11, bytes, 8, 0));
        assert_close(read_leg(SIDE_LEFT).precompression_m, cases[i].metres, 1e-5, 0);
        ck_assert_int_eq(read_leg(SIDE_LEFT).state, cases[i].state);
    }
}
END_TEST

START_TEST(mit_below_the_stroke_is_refused)
{
    motors.axis[SIDE_LEFT].config.zero_rad = -9.0f;
    const uint32_t field = (uint32_t)((-9.0 - 50.0 * 0.036 + 12.5) / 25.0 * 65535.0);
    const uint8_t bytes[8] = {1, (uint8_t)(field >> 8), (uint8_t)(field & 0xFF)};
    ck_assert(give(0x11, bytes, 8, 0));
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_FAULT);
}
END_TEST

static uint8_t special(void)
{
    const struct can_msg *frame = fake_bus_last(&fake, 1);
    ck_assert_ptr_nonnull(frame);
    return frame->data[0] == 0xFF && frame->data[1] == 0xFF ? frame->data[7] : 0;
}

/* Entered once, then driven; left when no longer commanded; entered anew after a while. */
START_TEST(mit_enters_and_leaves)
{
    command[SIDE_LEFT].enable = true;
    ck_assert(give(0x11, answer, 8, 0));
    send_commands();
    ck_assert_uint_eq(special(), MIT_ENTER);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_ENABLED);
    command[SIDE_LEFT].enable = false;
    send_commands();
    ck_assert_uint_eq(special(), MIT_EXIT);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED);
    command[SIDE_LEFT].enable = true;
    int waited = 0;
    for (send_commands(); special() != MIT_ENTER; send_commands()) {
        ck_assert_int_lt(++waited, 101);
    }
    ck_assert_int_ge(waited, 90);
}
END_TEST

START_TEST(mit_says_what_the_bus_refused)
{
    command[SIDE_LEFT].enable = true;
    ck_assert(give(0x11, answer, 8, 0));
    fake.verdict = CAN_FULL;
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_FULL);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_DISABLED); /* it never heard of it */
    fake.verdict = CAN_OK;
    send_commands();
    ck_assert_uint_eq(special(), MIT_ENTER); /* in the next tick, not after a wait for an answer */
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_ENABLED);
    command[SIDE_LEFT].enable = false;
    fake.verdict = CAN_FULL;
    ck_assert_int_eq(sea_drives_command(&drives, command, &bus), CAN_FULL);
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_ENABLED); /* nor that it is to leave */
    fake.verdict = CAN_OK;
    send_commands();
    ck_assert_uint_eq(special(), MIT_EXIT);
}
END_TEST

/* With an error or without an answer no torque: all gains zero. */
START_TEST(mit_gives_no_torque_that_nobody_watches)
{
    command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.1f, .enable = true, .latch_armed = true, .clear_fault = false};
    ck_assert(give(0x11, answer_with_error, 8, 0));
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_FAULT);
    send_commands();
    ck_assert_uint_eq(special(), 0);
    ck_assert_uint_eq(fake_bus_last(&fake, 1)->data[3] & 0x0F, 0);
    ck_assert_uint_eq(fake_bus_last(&fake, 1)->data[4], 0);
    for (int i = 0; i < 70000; i++) {
        sea_drives_age(&drives);
    }
    ck_assert_int_eq(read_leg(SIDE_LEFT).state, DRIVE_UNKNOWN);
    ck_assert_uint_eq(read_leg(SIDE_LEFT).age_ticks, UINT16_MAX);
}
END_TEST

/* It has followed its targets and is then not heard for more than a minute: it is asked where it is,
 * with a frame that moves nothing (kp, kd and torque zero), until it answers. */
START_TEST(mit_that_fell_silent_is_asked_without_torque)
{
    command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.1f, .enable = true, .latch_armed = false, .clear_fault = false};
    ck_assert(give(0x11, answer, 8, 0));
    send_commands();
    ck_assert_uint_eq(special(), MIT_ENTER);
    ck_assert(give(0x11, answer, 8, 0));
    send_commands();
    ck_assert_uint_ne(fake_bus_last(&fake, 1)->data[4], 0); /* driven: kp */
    for (int i = 0; i < 70000; i++) {
        sea_drives_age(&drives);
    }
    send_commands();
    const uint8_t *frame = fake_bus_last(&fake, 1)->data;
    ck_assert_uint_eq(special(), 0);
    ck_assert_uint_eq(frame[3] & 0x0Fu, 0);
    ck_assert_uint_eq(frame[4], 0);
    ck_assert_uint_eq(frame[5], 0);
    ck_assert_uint_eq((frame[6] & 0xF0u) >> 4, 0);
    assert_close((frame[6] & 0x0Fu) << 8 | frame[7], 2047.5, 0.6, 0.0); /* no torque: the middle */
    ck_assert(give(0x11, answer, 8, 0));
    send_commands();
    ck_assert_uint_ne(fake_bus_last(&fake, 1)->data[4], 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("drive edges");
    TCase *one = tcase_create("CANSimple"), *other = tcase_create("MIT mode");
    tcase_add_checked_fixture(one, setup_odrive, NULL);
    tcase_add_test(one, cansimple_takes_no_frame_that_is_none);
    tcase_add_test(one, cansimple_on_its_way_is_starting);
    tcase_add_test(one, cansimple_errors_are_cleared_when_asked);
    tcase_add_test(one, cansimple_enters_at_a_fresh_position);
    tcase_add_test(one, cansimple_says_what_the_bus_refused);
    tcase_add_test(one, cansimple_what_was_refused_is_sent_in_the_next_tick);
    tcase_add_test(one, cansimple_ages_stay_at_never);
    tcase_add_checked_fixture(other, setup_mit, NULL);
    tcase_add_test(other, mit_takes_no_frame_that_is_none);
    tcase_add_test(other, mit_tells_its_temperature);
    tcase_add_test(other, mit_refuses_positions_beyond_the_stroke);
    tcase_add_test(other, mit_below_the_stroke_is_refused);
    tcase_add_test(other, mit_enters_and_leaves);
    tcase_add_test(other, mit_says_what_the_bus_refused);
    tcase_add_test(other, mit_gives_no_torque_that_nobody_watches);
    tcase_add_test(other, mit_that_fell_silent_is_asked_without_torque);
    tcase_add_test(one, cansimple_a_start_that_was_broken_off_begins_anew);
    tcase_add_test(one, cansimple_a_fault_is_not_asked_to_leave);
    suite_add_tcase(suite, one);
    suite_add_tcase(suite, other);
    return run_suite(suite);
}
