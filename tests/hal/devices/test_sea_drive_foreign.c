/* CANSimple and MIT mode frames against bytes worked out by hand from the makers'
 * descriptions, and the way to enabled and back. */
#include "hal/bus/frame_table.h"
#include "hal/devices/sea_drive_cansimple.h"
#include "hal/devices/sea_drive_mit.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

#include <string.h>

/* ---- CANSimple: node 1 = 0x020.., node 2 = 0x040.. ------------------------- */

struct odrive_bench {
    struct fake_bus fake;
    struct can_bus bus;
    struct cansimple_drives axes;
    struct sea_drives drives;
    struct sea_drive_command command[SIDE_COUNT];
};

static void start_odrive(struct odrive_bench *b)
{
    static const struct cansimple_axis_config config[SIDE_COUNT] = {{1, 200.0f, 0.5f, 1},
                                                                    {2, 200.0f, 0.0f, -1}};
    memset(b, 0, sizeof *b);
    fake_bus_init(&b->fake);
    b->bus = fake_bus_interface(&b->fake);
    cansimple_drives_init(&b->axes, config);
    b->drives = cansimple_drives_interface(&b->axes);
}

static bool give(const struct sea_drives *drives, uint32_t id, const uint8_t *data, uint8_t length)
{
    struct can_msg frame = {.id = id, .length = length};
    memcpy(frame.data, data, length);
    return sea_drives_receive(drives, &frame);
}

/* 10.5 turns = 0x41280000; 0 turns/s. */
static const uint8_t at_10_5_turns[8] = {0x00, 0x00, 0x28, 0x41};
static const uint8_t heartbeat_idle[8] = {0, 0, 0, 0, 1};
static const uint8_t heartbeat_closed_loop[8] = {0, 0, 0, 0, 8};
static const uint8_t heartbeat_watchdog[8] = {0x00, 0x08, 0, 0, 1};

START_TEST(cansimple_reads_estimates_and_heartbeats)
{
    struct odrive_bench b;
    struct sea_drive_reading reading;
    start_odrive(&b);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_UNKNOWN);
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    assert_close(reading.precompression_m, 0.05, 1e-7, 0.0); /* (10.5 - 0.5) / 200 */
    ck_assert_int_eq(reading.state, DRIVE_ENABLED);
    ck_assert(give(&b.drives, 0x021, heartbeat_watchdog, 8));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_FAULT);
    for (int i = 0; i < HEARTBEAT_TIMEOUT_TICKS + 1; i++) {
        sea_drives_age(&b.drives);
    }
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_UNKNOWN);
    ck_assert(!give(&b.drives, 0x080, at_10_5_turns, 0)); /* SYNC is not node 4's */
}
END_TEST

START_TEST(cansimple_refuses_what_is_no_number)
{
    static const uint8_t nan_turns[8] = {0x00, 0x00, 0xC0, 0x7F};
    struct odrive_bench b;
    struct sea_drive_reading reading;
    start_odrive(&b);
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x029, nan_turns, 8));
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 4));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    assert_close(reading.precompression_m, 0.05, 1e-7, 0.0);
    ck_assert_uint_eq(b.axes.rx_malformed, 2);
}
END_TEST

START_TEST(cansimple_way_to_closed_loop_without_a_kick)
{
    struct odrive_bench b;
    start_odrive(&b);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.1f, .enable = true, .latch_armed = true, .clear_fault = false};
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_idle, 8));
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    const struct can_msg *position = fake_bus_last(&b.fake, 0x02C);
    ck_assert_ptr_nonnull(position);
    ck_assert_mem_eq(position->data, at_10_5_turns, 4); /* where it is, not where it shall go */
    const struct can_msg *mode = fake_bus_last(&b.fake, 0x02B);
    ck_assert_ptr_nonnull(mode);
    ck_assert_ptr_null(fake_bus_last(&b.fake, 0x027)); /* the state: a tick later */
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    const struct can_msg *state = fake_bus_last(&b.fake, 0x027);
    ck_assert_ptr_nonnull(state);
    ck_assert_int_eq(mode->data[0], 3);
    ck_assert_int_eq(mode->data[4], 1);
    ck_assert_int_eq(state->data[0], 8);
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8));
    fake_bus_clear(&b.fake);
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    /* 0.5 + 0.1 * 200 = 20.5 turns = 0x41A40000 */
    static const uint8_t at_20_5_turns[4] = {0x00, 0x00, 0xA4, 0x41};
    ck_assert_mem_eq(fake_bus_last(&b.fake, 0x02C)->data, at_20_5_turns, 4);
    b.command[SIDE_LEFT].enable = false;
    for (int i = 0; i < 110; i++) {
        ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
        if (i == 50) {
            fake_bus_clear(&b.fake);
        }
    }
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x027));
    ck_assert_int_eq(fake_bus_last(&b.fake, 0x027)->data[0], 1); /* idle */
}
END_TEST

/* Firmware 0.5.4 on: byte 5 motor, byte 6 encoder, byte 7 controller error in bit 0, trajectory done in bit 7. */
START_TEST(cansimple_errors_beside_the_axis_error_are_faults)
{
    static const uint8_t heartbeats[4][8] = {{0, 0, 0, 0, 8, 1},
                                             {0, 0, 0, 0, 8, 0, 1},
                                             {0, 0, 0, 0, 8, 0, 0, 0x81},
                                             {0, 0, 0, 0, 8, 0, 0, 0x80}}; /* the last: all well */
    struct odrive_bench b;
    struct sea_drive_reading reading;
    start_odrive(&b);
    ck_assert(give(&b.drives, 0x021, heartbeats[_i], 8));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, _i == 3 ? DRIVE_ENABLED : DRIVE_FAULT);
}
END_TEST

/* A heartbeat of five bytes (before 0.5.4) has no such flags. */
START_TEST(cansimple_short_heartbeats_have_no_flags)
{
    static const uint8_t heartbeat[8] = {0, 0, 0, 0, 8, 1, 1, 1};
    struct odrive_bench b;
    struct sea_drive_reading reading;
    start_odrive(&b);
    ck_assert(give(&b.drives, 0x021, heartbeat, 5));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_ENABLED);
}
END_TEST

static void command_ticks(struct odrive_bench *b, int ticks)
{
    for (int i = 0; i < ticks; i++) {
        ck_assert_int_eq(sea_drives_command(&b->drives, b->command, &b->bus), CAN_OK);
    }
}

/* It was in closed loop and is not any more, without an error: it disarmed itself. It is not
 * enabled again behind the controller's back; withdrawing the command ends it. */
START_TEST(cansimple_a_drive_that_disarmed_itself_is_a_fault)
{
    struct odrive_bench b;
    struct sea_drive_reading reading;
    start_odrive(&b);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.1f, .enable = true, .latch_armed = true, .clear_fault = false};
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8));
    command_ticks(&b, 1);
    ck_assert(give(&b.drives, 0x021, heartbeat_idle, 8));
    fake_bus_clear(&b.fake);
    command_ticks(&b, 250);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_FAULT);
    ck_assert_ptr_null(fake_bus_last(&b.fake, 0x027)); /* no request for closed loop */
    b.command[SIDE_LEFT].enable = false;
    command_ticks(&b, 1);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_DISABLED);
}
END_TEST

/* A heartbeat comes ten times a second: what the last one said is of before the command to leave. */
START_TEST(cansimple_off_and_on_again_between_two_heartbeats_is_no_fault)
{
    struct odrive_bench b;
    struct sea_drive_reading reading;
    start_odrive(&b);
    b.command[SIDE_LEFT].enable = true;
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8));
    command_ticks(&b, 1);
    b.command[SIDE_LEFT].enable = false;
    command_ticks(&b, 1);
    const struct can_msg *request = fake_bus_last(&b.fake, 0x027);
    ck_assert_ptr_nonnull(request);
    ck_assert_uint_eq(request->data[0], CANSIMPLE_STATE_IDLE);
    b.command[SIDE_LEFT].enable = true;
    command_ticks(&b, 1);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_STARTING);
    fake_bus_clear(&b.fake);
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8)); /* the request was lost */
    command_ticks(&b, 250);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x027)); /* so it is made again */
    ck_assert_uint_eq(fake_bus_last(&b.fake, 0x027)->data[0], CANSIMPLE_STATE_IDLE);
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_idle, 8));
    command_ticks(&b, 1);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_DISABLED); /* and no fault: it was told to */
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8));
    command_ticks(&b, 1);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_ENABLED);
}
END_TEST

/* Every other state than closed loop (8) is none, also those behind it in the maker's list: 9 to 11 are
 * lock-in spin, the encoder's search and homing. */
START_TEST(cansimple_a_drive_that_went_to_another_state_is_a_fault)
{
    static const uint8_t others[] = {1, 3, 7, 9, 10, 11};
    const uint8_t heartbeat[8] = {0, 0, 0, 0, others[_i]};
    struct odrive_bench b;
    struct sea_drive_reading reading;
    start_odrive(&b);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.1f, .enable = true, .latch_armed = true, .clear_fault = false};
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8));
    command_ticks(&b, 1);
    ck_assert(give(&b.drives, 0x021, heartbeat, 8));
    command_ticks(&b, 1);
    ck_assert(give(&b.drives, 0x021, heartbeat_closed_loop, 8)); /* and back by itself */
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_FAULT);
}
END_TEST

/* Requests begin in the tick that asks for it, however long nothing was asked for. */
START_TEST(cansimple_a_request_is_not_late)
{
    struct odrive_bench b;
    start_odrive(&b);
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_idle, 8));
    command_ticks(&b, _i);
    ck_assert_ptr_null(fake_bus_last(&b.fake, 0x027));
    b.command[SIDE_LEFT].enable = true;
    command_ticks(&b, 2);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x027));
    ck_assert_uint_eq(fake_bus_last(&b.fake, 0x027)->length, 4);
    ck_assert_uint_eq(fake_bus_last(&b.fake, 0x02B)->length, 8);
    ck_assert_uint_eq(fake_bus_last(&b.fake, 0x02C)->length, 8);
}
END_TEST

/* Position of both and one request more is what the bus has room for in a tick. */
START_TEST(cansimple_two_drives_start_one_request_a_tick)
{
    static const uint32_t order[] = {0x02B, 0x027, 0x04B, 0x047};
    struct odrive_bench b;
    start_odrive(&b);
    for (uint32_t id = 0x020; id <= 0x040; id += 0x020) {
        ck_assert(give(&b.drives, id + 9, at_10_5_turns, 8));
        ck_assert(give(&b.drives, id + 1, heartbeat_idle, 8));
    }
    b.command[SIDE_LEFT].enable = b.command[SIDE_RIGHT].enable = true;
    for (int i = 0; i < 4; i++) {
        fake_bus_clear(&b.fake);
        command_ticks(&b, 1);
        for (int k = 0; k < 4; k++) {
            ck_assert_uint_eq(fake_bus_count(&b.fake, order[k]), k == i);
        }
    }
    fake_bus_clear(&b.fake);
    command_ticks(&b, 90); /* time to follow, before anything is said again */
    for (int k = 0; k < 4; k++) {
        ck_assert_uint_eq(fake_bus_count(&b.fake, order[k]), 0);
    }
}
END_TEST

/* The operator's reset lasts one tick, and may come while another request is waited for. */
START_TEST(cansimple_a_reset_of_one_tick_clears_the_errors)
{
    struct odrive_bench b;
    start_odrive(&b);
    ck_assert(give(&b.drives, 0x029, at_10_5_turns, 8));
    ck_assert(give(&b.drives, 0x021, heartbeat_idle, 8));
    b.command[SIDE_LEFT].enable = true;
    command_ticks(&b, 5); /* asked for closed loop: the next request waits */
    ck_assert(give(&b.drives, 0x021, heartbeat_watchdog, 8));
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.0f, .enable = false, .latch_armed = false, .clear_fault = true};
    command_ticks(&b, 1);
    b.command[SIDE_LEFT].clear_fault = false;
    command_ticks(&b, 120);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x038), 1); /* Clear Errors, once */
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x058), 0); /* the right one has no fault */
}
END_TEST

/* ---- MIT mode -------------------------------------------------------------- */

struct ak_bench {
    struct fake_bus fake;
    struct can_bus bus;
    struct mit_drives axes;
    struct sea_drives drives;
    struct sea_drive_command command[SIDE_COUNT];
};

static void start_ak(struct ak_bench *b)
{
    struct mit_axis_config config[SIDE_COUNT];
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
    memset(b, 0, sizeof *b);
    fake_bus_init(&b->fake);
    b->bus = fake_bus_interface(&b->fake);
    mit_drives_init(&b->axes, config);
    b->drives = mit_drives_interface(&b->axes);
}

START_TEST(mit_fields_at_their_ends_and_in_the_middle)
{
    ck_assert_uint_eq(mit_encode(-12.5f, 12.5f, false, 16), 0);
    ck_assert_uint_eq(mit_encode(12.5f, 12.5f, false, 16), 65535);
    ck_assert_uint_eq(mit_encode(0.0f, 12.5f, false, 16), 32768);
    ck_assert_uint_eq(mit_encode(99.0f, 18.0f, false, 12), 4095);
    ck_assert_uint_eq(mit_encode(-99.0f, 18.0f, false, 12), 0);
    ck_assert_uint_eq(mit_encode(250.0f, 500.0f, true, 12), 2048);
    ck_assert_uint_eq(mit_encode(0.0f, 5.0f, true, 12), 0);
    assert_close(mit_decode(65535, 12.5f, false, 16), 12.5, 1e-6, 0.0);
    assert_close(mit_decode(0, 12.5f, false, 16), -12.5, 1e-6, 0.0);
    assert_close(mit_decode(0, 500.0f, true, 12), 0.0, 0.0, 0.0);
    assert_close(mit_decode(4095, 500.0f, true, 12), 500.0, 0.0, 1e-6);
    for (uint32_t field = 0; field < 65536; field += 7) {
        ck_assert_uint_eq(mit_encode(mit_decode(field, 12.5f, false, 16), 12.5f, false, 16), field);
    }
}
END_TEST

/* -12 rad of +-12.5 rad: 0.5 / 25 * 65535 = 1310.7 -> 1311 = 0x051F. */
static const uint8_t answer_at_zero[8] = {1, 0x05, 0x1F, 0x7F, 0xF7, 0xFF, 30, 0};

START_TEST(mit_enters_after_an_answer_and_commands_bytes_in_order)
{
    static const uint8_t enter[8] = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC};
    struct ak_bench b;
    struct sea_drive_reading reading;
    start_ak(&b);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.25f, .enable = true, .latch_armed = true, .clear_fault = false};
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_int_eq(fake_bus_last(&b.fake, 1)->data[3] & 0x0F, 0); /* kp 0 until entered */
    ck_assert_int_eq(fake_bus_last(&b.fake, 1)->data[4], 0);
    ck_assert(give(&b.drives, 0x11, answer_at_zero, 8));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    assert_close(reading.precompression_m, 0.0, 5e-6, 0.0);
    ck_assert_int_eq(reading.state, DRIVE_DISABLED);
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_mem_eq(fake_bus_last(&b.fake, 1)->data, enter, 8);
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    /* position -12 + 12.5 = 0.5 rad -> 34078 = 0x851E; velocity 0 -> 0x800 (rounded
     * half up); kp 500 -> 0xFFF; kd 5 -> 0xFFF; torque 100 * 0.25 / 50 = 0.5 Nm -> 2104 = 0x838 */
    static const uint8_t expected[8] = {0x85, 0x1E, 0x80, 0x0F, 0xFF, 0xFF, 0xF8, 0x38};
    ck_assert_mem_eq(fake_bus_last(&b.fake, 1)->data, expected, 8);
    ck_assert_uint_eq(fake_bus_last(&b.fake, 1)->length, 8);
}
END_TEST

START_TEST(mit_never_spells_a_special_frame_by_accident)
{
    struct ak_bench b;
    start_ak(&b);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.0f, .enable = true, .latch_armed = false, .clear_fault = false};
    ck_assert(give(&b.drives, 0x11, answer_at_zero, 8));
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    b.command[SIDE_LEFT].precompression_m = 1e9f; /* all fields at their upper ends */
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert(fake_bus_last(&b.fake, 1)->data[1] != 0xFF);
}
END_TEST

START_TEST(mit_refuses_a_motor_with_other_ranges)
{
    static const uint8_t far_away[8] = {1, 0xF0, 0x00, 0x7F, 0xF7, 0xFF, 30, 0};
    struct ak_bench b;
    struct sea_drive_reading reading;
    start_ak(&b);
    b.command[SIDE_LEFT].enable = true;
    ck_assert(give(&b.drives, 0x11, far_away, 8));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_FAULT);
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert(fake_bus_last(&b.fake, 1)->data[7] != MIT_ENTER);
}
END_TEST

START_TEST(mit_error_and_withdrawal_leave_motor_mode)
{
    static const uint8_t answer_with_error[8] = {1, 0x05, 0x1F, 0x7F, 0xF7, 0xFF, 90, 3};
    struct ak_bench b;
    start_ak(&b);
    b.command[SIDE_LEFT].enable = true;
    ck_assert(give(&b.drives, 0x11, answer_at_zero, 8));
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert(give(&b.drives, 0x11, answer_with_error, 8));
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_int_eq(fake_bus_last(&b.fake, 1)->data[7], MIT_EXIT);
    ck_assert_int_eq(fake_bus_last(&b.fake, 1)->data[0], 0xFF);
}
END_TEST

/* A reset leaves motor mode and looks at the motor anew: at its error, and whether it is ours. */
START_TEST(mit_a_reset_leaves_motor_mode_and_judges_anew)
{
    static const uint8_t answer_with_error[8] = {1, 0x05, 0x1F, 0x7F, 0xF7, 0xFF, 90, 3};
    static const uint8_t far_away[8] = {1, 0xF0, 0x00, 0x7F, 0xF7, 0xFF, 30, 0};
    struct ak_bench b;
    struct sea_drive_reading reading;
    start_ak(&b);
    ck_assert(give(&b.drives, 0x11, _i == 0 ? answer_with_error : far_away, 8));
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_FAULT);
    b.command[SIDE_LEFT].clear_fault = true;
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_int_eq(fake_bus_last(&b.fake, 1)->data[0], 0xFF);
    ck_assert_int_eq(fake_bus_last(&b.fake, 1)->data[7], MIT_EXIT);
    ck_assert_int_eq(fake_bus_last(&b.fake, 2)->data[0] == 0xFF,
                     0); /* the right one has no fault */
    b.command[SIDE_LEFT].clear_fault = false;
    ck_assert(give(&b.drives, 0x11, _i == 0 ? answer_with_error : far_away, 8));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_FAULT); /* it says so still */
    b.command[SIDE_LEFT].clear_fault = true;
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert(give(&b.drives, 0x11, answer_at_zero, 8));
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_DISABLED);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sea_drive_foreign");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, cansimple_reads_estimates_and_heartbeats);
    tcase_add_test(tests, cansimple_refuses_what_is_no_number);
    tcase_add_test(tests, cansimple_way_to_closed_loop_without_a_kick);
    tcase_add_loop_test(tests, cansimple_errors_beside_the_axis_error_are_faults, 0, 4);
    tcase_add_test(tests, cansimple_short_heartbeats_have_no_flags);
    tcase_add_test(tests, cansimple_a_drive_that_disarmed_itself_is_a_fault);
    tcase_add_test(tests, cansimple_off_and_on_again_between_two_heartbeats_is_no_fault);
    tcase_add_loop_test(tests, cansimple_a_drive_that_went_to_another_state_is_a_fault, 0, 6);
    tcase_add_loop_test(tests, cansimple_a_request_is_not_late, 1, 4);
    tcase_add_test(tests, cansimple_two_drives_start_one_request_a_tick);
    tcase_add_test(tests, cansimple_a_reset_of_one_tick_clears_the_errors);
    tcase_add_test(tests, mit_fields_at_their_ends_and_in_the_middle);
    tcase_add_test(tests, mit_enters_after_an_answer_and_commands_bytes_in_order);
    tcase_add_test(tests, mit_never_spells_a_special_frame_by_accident);
    tcase_add_test(tests, mit_refuses_a_motor_with_other_ranges);
    tcase_add_test(tests, mit_error_and_withdrawal_leave_motor_mode);
    tcase_add_loop_test(tests, mit_a_reset_leaves_motor_mode_and_judges_anew, 0, 2);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
