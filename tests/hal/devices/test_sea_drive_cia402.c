/* The master's half of CiA 402, driven by statuswords as the standard spells them. */
#include "hal/bus/frame_table.h"
#include "hal/devices/sea_drive_cia402.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

#include <string.h>

enum { LATE_TICKS_MAX = 8 };

static const struct cia402_axis_config axes[SIDE_COUNT] = {
    {.counts_per_m = 1.0e6f, .zero_counts = 500, .direction = 1, .rated_force_N = 50.0f},
    {.counts_per_m = 1.0e6f, .zero_counts = -500, .direction = -1, .rated_force_N = 50.0f}};

struct bench {
    struct fake_bus fake;
    struct can_bus bus;
    struct cia402_drives cia402;
    struct sea_drives drives;
    struct sea_drive_command command[SIDE_COUNT];
};

static void start(struct bench *b)
{
    memset(b, 0, sizeof *b);
    fake_bus_init(&b->fake);
    b->bus = fake_bus_interface(&b->fake);
    cia402_drives_init(&b->cia402, axes);
    b->drives = cia402_drives_interface(&b->cia402);
}

static void answer(struct bench *b, uint32_t id, uint16_t statusword, int32_t position)
{
    const uint32_t p = (uint32_t)position;
    const struct can_msg frame = {.id = id,
                                  .length = 6,
                                  .data = {(uint8_t)(statusword & 255u), (uint8_t)(statusword >> 8),
                                           (uint8_t)(p & 255u), (uint8_t)((p >> 8) & 255u),
                                           (uint8_t)((p >> 16) & 255u), (uint8_t)(p >> 24)}};
    ck_assert(sea_drives_receive(&b->drives, &frame));
}

/* The controlword sent to the left drive for this statusword and the present command. */
static int controlword_for(struct bench *b, uint16_t statusword)
{
    answer(b, 0x181, statusword, 500);
    b->cia402.axis[SIDE_LEFT].sender.ticks_since_sent = SLOW_PDO_TICKS; /* due again */
    fake_bus_clear(&b->fake);
    ck_assert_int_eq(sea_drives_command(&b->drives, b->command, &b->bus), CAN_OK);
    const struct can_msg *frame = fake_bus_last(&b->fake, 0x301);
    ck_assert_ptr_nonnull(frame);
    ck_assert_int_eq(frame->length, 6);
    return frame->data[0] | frame->data[1] << 8;
}

static int32_t target_of(const struct bench *b, int leg)
{
    const struct can_msg *frame = fake_bus_last(&b->fake, 0x201);
    ck_assert_ptr_nonnull(frame);
    int32_t value;
    memcpy(&value, frame->data + 4 * leg, sizeof value);
    return value;
}

START_TEST(way_to_enabled_and_back)
{
    struct bench b;
    start(&b);
    b.command[SIDE_LEFT].enable = true;
    ck_assert_int_eq(controlword_for(&b, 0x0240), 0x06); /* switch-on disabled: shutdown */
    ck_assert_int_eq(controlword_for(&b, 0x0221), 0x07); /* ready: switch on */
    ck_assert_int_eq(controlword_for(&b, 0x0223), 0x0F); /* switched on: enable */
    ck_assert_int_eq(controlword_for(&b, 0x0227), 0x0F); /* enabled: stay */
    b.command[SIDE_LEFT].enable = false;
    ck_assert_int_eq(controlword_for(&b, 0x0227), 0x06);
    ck_assert_int_eq(controlword_for(&b, 0x0221), 0x06);
    ck_assert_int_eq(controlword_for(&b, 0x0207), 0x02); /* quick stop: let it unload */
}
END_TEST

/* The operator asks for one tick. The bit stays for fifty, so that a drive that looks at its controlword every
 * ten milliseconds sees it, and then falls, so that it can rise again (CiA 402-2: a rising edge). */
START_TEST(fault_reset_is_an_edge_and_only_on_demand)
{
    struct bench b;
    start(&b);
    b.command[SIDE_LEFT].enable = true;
    ck_assert_int_eq(controlword_for(&b, 0x0208), 0x00);
    ck_assert_int_eq(controlword_for(&b, 0x0208), 0x00);
    for (int round = 0; round < 2; round++) {
        b.command[SIDE_LEFT].clear_fault = true;
        ck_assert_int_eq(controlword_for(&b, 0x0208), 0x80);
        b.command[SIDE_LEFT].clear_fault = false;
        for (int tick = 1; tick < 50; tick++) {
            ck_assert_int_eq(controlword_for(&b, 0x0208), 0x80);
        }
        for (int tick = 0; tick < 50; tick++) {
            b.command[SIDE_LEFT].clear_fault =
                tick == 10; /* too early: the drive must see it low */
            ck_assert_int_eq(controlword_for(&b, 0x0208), 0x00);
        }
        b.command[SIDE_LEFT].clear_fault = false;
        ck_assert_int_eq(controlword_for(&b, 0x0208), 0x00);
    }
    /* It ends with the fault, and does not clear the next one. */
    b.command[SIDE_LEFT].clear_fault = true;
    ck_assert_int_eq(controlword_for(&b, 0x0208), 0x80);
    b.command[SIDE_LEFT].clear_fault = false;
    ck_assert_int_eq(controlword_for(&b, 0x0240), 0x06);
    ck_assert_int_eq(controlword_for(&b, 0x0208), 0x00);
    /* A reset that nobody needs is not kept for later. */
    b.command[SIDE_LEFT].clear_fault = true;
    ck_assert_int_eq(controlword_for(&b, 0x0240), 0x06);
    b.command[SIDE_LEFT].clear_fault = false;
    ck_assert_int_eq(controlword_for(&b, 0x0208), 0x00);
}
END_TEST

/* A drive that answers some ticks late and starts at "not ready": nothing but a command to enable
 * may make the controlword change, else each answer undoes the one before for ever. */
START_TEST(a_late_drive_that_is_not_ready_is_not_driven_in_circles)
{
    struct bench b;
    uint16_t words[LATE_TICKS_MAX + 1] = {0};
    const int late = 1 + _i;
    uint16_t status = 0x0000;
    int changes = 0, before = -1;
    start(&b);
    for (int tick = 0; tick < 400; tick++) {
        const int word = controlword_for(&b, status);
        changes += before >= 0 && word != before ? 1 : 0;
        before = word;
        memmove(words + 1, words, sizeof words - sizeof words[0]);
        words[0] = (uint16_t)word;
        const uint16_t seen = tick >= late ? words[late] : 0;
        if (status == 0x0000) {
            status = tick >= 20 ? 0x0240 : 0x0000; /* not ready for a while: then by itself */
        } else {
            status = (seen & 0x87u) == 0x06u ? 0x0221 : 0x0240; /* shutdown; disable voltage */
        }
    }
    ck_assert_int_le(changes, 1);
}
END_TEST

/* A drive without our mapping takes our frames for something else: the target frame has the identifier of the
 * first RPDO of node 1, whose default content is a controlword (CiA 402-1). */
START_TEST(a_drive_that_is_not_set_up_gets_no_command)
{
    struct bench b;
    start(&b);
    answer(&b, 0x181, 0x0240, 500);
    answer(&b, 0x182, 0x0240, 500);
    b.command[SIDE_LEFT].unconfigured = true; /* waits in pre-operational: it hears no PDO */
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x301), 0);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x302), 1);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x201), 1); /* the other one needs its target */
    b.command[SIDE_LEFT].operational = true;
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x301), 0);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x201), 1);
}
END_TEST

START_TEST(states_are_read_as_the_standard_spells_them)
{
    static const struct {
        uint16_t statusword;
        enum drive_state state;
    } cases[] = {{0x0000, DRIVE_DISABLED}, {0x0240, DRIVE_DISABLED}, {0x0260, DRIVE_DISABLED},
                 {0x0231, DRIVE_DISABLED}, {0x0233, DRIVE_STARTING}, {0x1637, DRIVE_ENABLED},
                 {0x0637, DRIVE_STOPPING}, /* enabled, but ignores its target */
                 {0x0002, DRIVE_DISABLED}, /* none of the profile's */
                 {0x0217, DRIVE_STOPPING}, {0x021F, DRIVE_STOPPING}, {0x0218, DRIVE_FAULT}};
    struct bench b;
    struct sea_drive_reading reading;
    start(&b);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_int_eq(reading.state, DRIVE_UNKNOWN);
    ck_assert_int_eq(reading.age_ticks, UINT16_MAX);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        answer(&b, 0x181, cases[i].statusword, 500);
        sea_drives_read(&b.drives, SIDE_LEFT, &reading);
        ck_assert_msg(reading.state == cases[i].state, "statusword %04x read as %d",
                      cases[i].statusword, (int)reading.state);
    }
}
END_TEST

/* Somebody else with the drive's identifier. One frame that came late is none. */
START_TEST(more_states_than_cycles_are_a_foreign_node)
{
    struct bench b;
    struct sea_drive_reading reading;
    start(&b);
    for (int cycle = 0; cycle < 100; cycle++) {
        answer(&b, 0x182, 0x0240, -500);
        answer(&b, 0x182, 0x0240, -500); /* CAN's own repetition */
        sea_drives_age(&b.drives);
        answer(&b, 0x181, 0x0240, 500 + cycle);
        answer(&b, 0x181, 0x0240, 501 + cycle); /* the one before was missed */
        sea_drives_age(&b.drives);
        sea_drives_age(&b.drives);
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        sea_drives_read(&b.drives, (enum side)leg, &reading);
        ck_assert(!reading.foreign);
    }
    for (int frame = 0; frame < 6; frame++) { /* by another statusword, by its position */
        sea_drives_read(&b.drives, SIDE_LEFT, &reading);
        ck_assert(!reading.foreign); /* as many as were missed are owed, three at most */
        answer(&b, 0x181, frame % 2 == 1 ? 0x1237 : 0x0240, frame % 4 == 2 ? 7 : 500);
    }
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert(reading.foreign);
    sea_drives_read(&b.drives, SIDE_RIGHT, &reading);
    ck_assert(!reading.foreign);
}
END_TEST

START_TEST(no_kick_target_is_the_position_until_enabled)
{
    struct bench b;
    start(&b);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.05f, .enable = true, .latch_armed = true, .clear_fault = false};
    b.command[SIDE_RIGHT] = (struct sea_drive_command){
        .precompression_m = 0.05f, .enable = true, .latch_armed = true, .clear_fault = false};
    answer(&b, 0x181, 0x0223, 1234);
    answer(&b, 0x182, 0x0227, -700);
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_int_eq(target_of(&b, 0), 1234);
    ck_assert_int_eq(target_of(&b, 1), -500 - 50000); /* reversed axis with its own zero */
    ck_assert_int_eq(fake_bus_last(&b.fake, 0x301)->data[4], 0); /* not armed before enabled */
    ck_assert_int_eq(fake_bus_last(&b.fake, 0x302)->data[4], 1);
}
END_TEST

START_TEST(no_target_before_both_positions_are_known)
{
    struct bench b;
    start(&b);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.05f, .enable = true, .latch_armed = false, .clear_fault = false};
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    answer(&b, 0x181, 0x0227, 700000);
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x201), 0);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x302), 0);
    answer(&b, 0x182, 0x0240, 5);
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x201), 1);
    ck_assert_int_eq(target_of(&b, 1), 5);
}
END_TEST

START_TEST(positions_scale_and_saturate)
{
    struct bench b;
    struct sea_drive_reading reading;
    start(&b);
    answer(&b, 0x181, 0x0227, 500 + 123456);
    answer(&b, 0x182, 0x0227, -500 - 123456);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        sea_drives_read(&b.drives, (enum side)leg, &reading);
        assert_close(reading.precompression_m, 0.123456, 1e-8, 1e-6);
    }
    answer(&b, 0x181, 0x0227, INT32_MIN);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    assert_close(reading.precompression_m, -2147.484148, 1e-3, 0.0);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 1e30f, .enable = true, .latch_armed = false, .clear_fault = false};
    b.command[SIDE_RIGHT] = (struct sea_drive_command){
        .precompression_m = -1e30f, .enable = true, .latch_armed = false, .clear_fault = false};
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_int_gt(target_of(&b, 0), 1000000000);
    ck_assert_int_gt(target_of(&b, 1), 1000000000); /* minus times minus */
}
END_TEST

START_TEST(commands_go_out_on_change_and_now_and_then)
{
    struct bench b;
    start(&b);
    for (int tick = 0; tick < 1000; tick++) {
        answer(&b, 0x181, 0x0240, 500);
        answer(&b, 0x182, 0x0240, -500);
        ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
        if (tick % 50 == 49) {
            fake_bus_clear(&b.fake);
        }
    }
    fake_bus_clear(&b.fake);
    for (int tick = 0; tick < 100; tick++) {
        ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    }
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x201), 100);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x301), 1);
    ck_assert_uint_eq(fake_bus_count(&b.fake, 0x302), 1);
}
END_TEST

START_TEST(a_refused_frame_is_sent_again)
{
    struct bench b;
    start(&b);
    answer(&b, 0x181, 0x0227, 500);
    answer(&b, 0x182, 0x0227, -500);
    b.command[SIDE_LEFT] = (struct sea_drive_command){
        .precompression_m = 0.0f, .enable = true, .latch_armed = true, .clear_fault = false};
    b.fake.verdict = CAN_FULL;
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_FULL);
    b.fake.verdict = CAN_OK;
    ck_assert_int_eq(sea_drives_command(&b.drives, b.command, &b.bus), CAN_OK);
    ck_assert_ptr_nonnull(fake_bus_last(&b.fake, 0x301));
    ck_assert_int_eq(fake_bus_last(&b.fake, 0x301)->data[4], 1);
}
END_TEST

START_TEST(malformed_frames_change_nothing_and_are_counted)
{
    struct bench b;
    start(&b);
    answer(&b, 0x181, 0x0227, 777);
    struct can_msg frame = {.id = 0x181, .length = 8};
    ck_assert(sea_drives_receive(&b.drives, &frame));
    frame.length = 5;
    ck_assert(sea_drives_receive(&b.drives, &frame));
    ck_assert_uint_eq(b.cia402.rx_malformed, 2);
    ck_assert_int_eq(b.cia402.axis[SIDE_LEFT].position_counts, 777);
    frame.id = 0x183;
    ck_assert(!sea_drives_receive(&b.drives, &frame));
}
END_TEST

/* Torque in per mille of the rated force (50 N here), signed by the axis' direction. */
START_TEST(force_and_latch)
{
    struct bench b;
    struct sea_drive_reading reading;
    start(&b);
    struct can_msg slow = {.id = 0x381, .length = 8, .data = {0xC8, 0x00}}; /* 200 per mille */
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_uint_eq(reading.force_age_ticks, UINT16_MAX - 1); /* missing, not without any */
    ck_assert_int_eq(reading.latch, LATCH_UNKNOWN);
    ck_assert(sea_drives_receive(&b.drives, &slow));
    slow.id = 0x382;
    ck_assert(sea_drives_receive(&b.drives, &slow));
    answer(&b, 0x181, 0x5237, 500);
    answer(&b, 0x182, 0x1237, -500);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    assert_close((double)reading.force_N, 10.0, 1e-5, 0.0);
    ck_assert_uint_eq(reading.force_age_ticks, 0);
    ck_assert_int_eq(reading.latch, LATCH_CLOSED);
    sea_drives_read(&b.drives, SIDE_RIGHT, &reading);
    assert_close((double)reading.force_N, -10.0, 1e-5, 0.0);
    ck_assert_int_eq(reading.latch, LATCH_OPEN);
    for (int i = 0; i < 70000; i++) {
        sea_drives_age(&b.drives);
    }
    sea_drives_read(&b.drives, SIDE_RIGHT, &reading);
    ck_assert_uint_eq(reading.force_age_ticks, UINT16_MAX - 1); /* old, but once received */
    slow.length = 6;
    ck_assert(sea_drives_receive(&b.drives, &slow));
    ck_assert_uint_eq(b.cia402.rx_malformed, 1);
    slow.length = 8;
    slow.flags = CAN_FRAME_REMOTE; /* a question has no torque in it */
    ck_assert(sea_drives_receive(&b.drives, &slow));
    ck_assert_uint_eq(b.cia402.rx_malformed, 2);
    b.cia402.axis[SIDE_LEFT].config.rated_force_N = 0.0f;
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert_uint_eq(reading.force_age_ticks, UINT16_MAX);
}
END_TEST

/* 45.6 degC, 23.95 V; bit 7 of the statusword is the profile's warning. */
START_TEST(temperature_supply_and_warning_are_read)
{
    const struct can_msg slow = {
        .id = 0x382, .length = 8, .data = {0, 0, 0xC8, 0x01, 0x8E, 0x5D, 0, 0}};
    struct bench b;
    struct sea_drive_reading reading;
    start(&b);
    sea_drives_read(&b.drives, SIDE_RIGHT, &reading);
    ck_assert(!reading.has_supply && !reading.has_temperature && !reading.warning);
    ck_assert(sea_drives_receive(&b.drives, &slow));
    answer(&b, 0x182, 0x16B7, 0);
    sea_drives_read(&b.drives, SIDE_RIGHT, &reading);
    ck_assert(reading.has_supply && reading.has_temperature && reading.warning);
    assert_close(reading.temperature_degC, 45.6, 1e-4, 0.0);
    assert_close(reading.supply_V, 23.95, 1e-4, 0.0);
    sea_drives_read(&b.drives, SIDE_LEFT, &reading);
    ck_assert(!reading.has_supply && !reading.has_temperature && !reading.warning);
    for (int i = 0; i < SEA_DRIVE_SLOW_TICKS; i++) { /* told lately enough */
        sea_drives_age(&b.drives);
    }
    sea_drives_read(&b.drives, SIDE_RIGHT, &reading);
    ck_assert(reading.has_supply && reading.has_temperature);
    sea_drives_age(&b.drives);
    sea_drives_read(&b.drives, SIDE_RIGHT, &reading);
    ck_assert(!reading.has_supply && !reading.has_temperature);
}
END_TEST

/* Two states in one cycle come from two nodes, whichever way they differ. */
START_TEST(a_second_state_in_a_cycle_is_counted)
{
    struct bench b;
    start(&b);
    const int8_t *count = &b.cia402.axis[SIDE_LEFT].duplicate_id_count;
    answer(&b, 0x181, 0x0027, 500);
    ck_assert_int_eq(*count, 0);
    answer(&b, 0x181, 0x0027, 500); /* the same once more is a frame that was sent twice */
    ck_assert_int_eq(*count, 0);
    answer(&b, 0x181, 0x0027, 400);
    ck_assert_int_eq(*count, 1);
    answer(&b, 0x181, 0x0027, 600);
    ck_assert_int_eq(*count, 2);
    answer(&b, 0x181, 0x0023, 600);
    ck_assert_int_eq(*count, 3);
    sea_drives_age(&b.drives);
    answer(&b, 0x181, 0x0027, 700);
    ck_assert_int_eq(*count, 3);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sea_drive_cia402");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, way_to_enabled_and_back);
    tcase_add_test(tests, fault_reset_is_an_edge_and_only_on_demand);
    tcase_add_test(tests, states_are_read_as_the_standard_spells_them);
    tcase_add_test(tests, no_kick_target_is_the_position_until_enabled);
    tcase_add_test(tests, no_target_before_both_positions_are_known);
    tcase_add_test(tests, positions_scale_and_saturate);
    tcase_add_test(tests, commands_go_out_on_change_and_now_and_then);
    tcase_add_test(tests, a_refused_frame_is_sent_again);
    tcase_add_test(tests, malformed_frames_change_nothing_and_are_counted);
    tcase_add_test(tests, force_and_latch);
    tcase_add_test(tests, more_states_than_cycles_are_a_foreign_node);
    tcase_add_loop_test(tests, a_late_drive_that_is_not_ready_is_not_driven_in_circles, 0,
                        LATE_TICKS_MAX);
    tcase_add_test(tests, a_drive_that_is_not_set_up_gets_no_command);
    tcase_add_test(tests, temperature_supply_and_warning_are_read);
    tcase_add_test(tests, a_second_state_in_a_cycle_is_counted);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
