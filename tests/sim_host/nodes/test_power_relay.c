/* The relays between the controller's power lines and the drives, by their times; and what a drive does that loses
 * its torque. */
#include "sim_host/nodes/power_relay.h"

#include "model/tick.h"
#include "sim_host/nodes/drive_state.h"
#include "sim_host/nodes/vendor_drive.h"
#include "tests/support/assert_close.h"
#include "tests/support/fake_bus.h"

static struct power_relay relay;

static void setup(void)
{
    power_relay_init(&relay);
}

/* Ticks until the torque is gone, at most 2000. */
static int lasts(bool toggles)
{
    int ticks = 0;
    for (bool on = true; on && ticks < 2000; ticks++) {
        if (toggles) {
            drive_power_enable_toggle(&relay.lines);
        }
        on = power_relay_advance(&relay);
    }
    return ticks;
}

/* 20 ms of the pump, 400 ms of K2, 25 ms of the drive's input. */
START_TEST(without_edges_the_torque_goes_after_445_ms)
{
    ck_assert_int_eq(lasts(true), 2000);
    ck_assert_int_eq(lasts(false), TICKS_OF_MS(445));
    ck_assert(!power_relay_advance(&relay));
    ck_assert_int_eq(lasts(true), 2000); /* somebody has started it again */
}
END_TEST

/* 10 ms of K3, 25 ms of the drive's input; the pump goes on or not. */
START_TEST(the_cut_takes_the_torque_after_35_ms)
{
    ck_assert_int_eq(lasts(true), 2000);
    drive_power_enable_cut(&relay.lines, true);
    ck_assert_int_eq(lasts(_i == 0), TICKS_OF_MS(35));
    drive_power_enable_cut(&relay.lines, false);
    drive_power_enable_toggle(&relay.lines);
    ck_assert(power_relay_advance(&relay));
}
END_TEST

START_TEST(a_reset_of_the_controller_lets_the_cut_go)
{
    drive_power_enable_cut(&relay.lines, true);
    ck_assert_int_eq(lasts(false), TICKS_OF_MS(35));
    power_relay_let_go(&relay);
    drive_power_enable_toggle(&relay.lines);
    ck_assert(power_relay_advance(&relay));
}
END_TEST

/* CiA 402: 0x0008 of the statusword is a fault; 0x5440 of IEC 61800-7-201's codes: contacts. */
START_TEST(a_drive_that_loses_its_torque_is_in_fault)
{
    static const struct drive_node_config config = {.side = SIDE_LEFT,
                                                    .node_id = 1,
                                                    .counts_per_m = 1000000,
                                                    .stroke_m = 0.3,
                                                    .max_speed_m_per_s = 2.0,
                                                    .rated_force_N = 10.0,
                                                    .following_error_m = 0.02,
                                                    .unload_rate_m_per_s = 0.5};
    static struct drive_node node;
    static struct fake_bus bus;
    struct drive_axis_command command;
    fake_bus_init(&bus);
    ck_assert_int_eq(drive_node_init(&node, &config, fake_bus_interface(&bus), 0), 0);
    drive_state_lose_torque(&node); /* it had none */
    ck_assert_int_eq(node.state, DRIVE_SWITCH_ON_DISABLED);
    node.state = _i == 0 ? DRIVE_OPERATION_ENABLED : DRIVE_FAULT_REACTION;
    node.unloading = _i == 1;
    drive_state_lose_torque(&node);
    drive_state_update_statusword(&node);
    ck_assert_int_eq(node.state, DRIVE_IN_FAULT);
    ck_assert_uint_eq(node.objects.statusword & 0x4F, 0x08);
    ck_assert_uint_eq(node.objects.error_code, 0x5440);
    drive_node_command(&node, 1000000, &command);
    ck_assert(!command.powered);
}
END_TEST

START_TEST(an_axis_of_another_protocol_is_idle_with_an_error)
{
    struct vendor_drive drive = {.closed_loop = false};
    vendor_drive_lose_torque(&drive);
    ck_assert(!drive.error);
    drive.closed_loop = true;
    vendor_drive_lose_torque(&drive);
    ck_assert(drive.error && !drive.closed_loop);
    vendor_drive_lose_torque(&drive);
    ck_assert(drive.error);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("power_relay");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, without_edges_the_torque_goes_after_445_ms);
    tcase_add_loop_test(tests, the_cut_takes_the_torque_after_35_ms, 0, 2);
    tcase_add_test(tests, a_reset_of_the_controller_lets_the_cut_go);
    tcase_add_loop_test(tests, a_drive_that_loses_its_torque_is_in_fault, 0, 2);
    tcase_add_test(tests, an_axis_of_another_protocol_is_idle_with_an_error);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
