/* A drive hangs under torque with a loaded spring behind a closed latch, or the controller goes: in a simulated walk
 * the hardware takes the torque, and the spring runs slack by itself. */
#include "tests/support/injected_walk.h"

static struct loop loop;
static struct injector injector;

static struct sea_output spring(enum side side)
{
    struct sea_output output;
    plant_sea_output(&loop.nodes.plant, side, &output);
    return output;
}

/* Walks until the left spring is loaded behind its latch, then lets the fault of the left drive's place come. */
static void walk_and_break(bool person, enum fault_kind kind)
{
    /* Of a drive that is slow: its share of its speed. It answers, and holds its motor. */
    const struct fault_shot shot = {
        .kind = kind, .duration_ticks = TICKS_OF_MS(3000), .magnitude = 1e-6};
    injected_walk_prepare(&loop, NULL, person ? 4 : 0);
    injected_walk_begin(&injector, &loop, 14);
    const double loaded_m = 0.8 * (double)loop.rig.task.controller.last_step.r0_m;
    for (int i = 0; i < 4000 && (spring(SIDE_LEFT).position_m < loaded_m ||
                                 spring(SIDE_LEFT).latch != SEA_LATCH_CLOSED);
         i++) {
        injector_tick(&injector);
    }
    ck_assert(spring(SIDE_LEFT).position_m >= loaded_m);
    injector_begin(&injector, &loop, &shot, 1);
}

/* Milliseconds from now until it holds, at most 2500. */
static double until(bool (*holds)(void))
{
    int ticks = 0;
    while (!holds() && ticks < TICKS_OF_MS(2500)) {
        injector_tick(&injector);
        ticks++;
    }
    return ticks * TICK_PERIOD_US / 1000.0;
}

static bool is_noticed(void)
{
    return loop.rig.task.output.fault != SUPERVISOR_FAULT_NONE;
}

static bool is_without_torque(void)
{
    return loop.nodes.plant.sea[SIDE_LEFT].command.mode == SEA_TORQUE_OFF &&
           loop.nodes.plant.sea[SIDE_RIGHT].command.mode == SEA_TORQUE_OFF;
}

static bool is_slack(void)
{
    return spring(SIDE_LEFT).unloaded && spring(SIDE_RIGHT).unloaded;
}

/* Half a second for the drive to unload by itself, and 35 ms of K3 and the drive's input. */
START_TEST(a_drive_that_hangs_loses_its_torque_at_once_and_its_spring_within_a_second)
{
    walk_and_break(_i == 1, FAULT_DRIVE_HANGS);
    ck_assert_double_le(until(is_noticed), 60);
    const double loaded_N = spring(SIDE_LEFT).spring_force_N;
    const double torque_ms = until(is_without_torque);
    ck_assert_double_le(torque_ms, 540);
    ck_assert_double_ge(torque_ms, 500);
    ck_assert_double_gt(spring(SIDE_LEFT).spring_force_N, 0.9 * loaded_N); /* nothing else helps */
    ck_assert_int_eq(spring(SIDE_LEFT).latch, SEA_LATCH_CLOSED);
    ck_assert_double_le(torque_ms + until(is_slack), 1000);
    ck_assert_int_eq(spring(SIDE_LEFT).latch, SEA_LATCH_CLOSED);
}
END_TEST

/* Its control loop hangs, its telegrams come: neither the unload's time nor its answers keep it its torque. */
START_TEST(a_drive_that_answers_and_holds_its_motor_is_slack_within_a_second)
{
    walk_and_break(_i == 1, FAULT_DRIVE_SLOW);
    loop.rig.task.node.objects.params.unload_timeout_s = 2.0f;
    loop.rig.task.node.objects.params_crc = params_guard_crc(&loop.rig.task.node.objects.params);
    (void)until(is_noticed);
    ck_assert(is_noticed());
    const double torque_ms = until(is_without_torque);
    const double slack_ms = torque_ms + until(is_slack);
    ck_assert_double_ge(torque_ms, 500);
    ck_assert_double_le(slack_ms, 1000);
    ck_assert_int_eq(spring(SIDE_LEFT).latch, SEA_LATCH_CLOSED);
}
END_TEST

static bool is_cut(void)
{
    return loop.relay.is_cut;
}

/* Another controller speaks: all nodes are stopped by NMT. They unload, but none can tell so any more. */
START_TEST(after_a_stop_by_nmt_the_power_goes)
{
    walk_and_break(false, FAULT_FOREIGN_TARGETS);
    ck_assert_double_le(until(is_noticed), 60);
    const double slack_ms = until(is_slack);
    ck_assert_double_le(slack_ms, 300);
    ck_assert(!is_cut());
    const double cut_ms = slack_ms + until(is_cut);
    ck_assert_double_ge(cut_ms, 500);
    ck_assert_double_le(cut_ms, 520);
}
END_TEST

static void cut_nothing(void *context, bool on)
{
    (void)context;
    (void)on;
}

/* A pin that does not cut, a broken wire: the pump's channel alone, 445 ms in place of 35. */
START_TEST(without_the_cutting_line_the_pump_takes_it_later)
{
    walk_and_break(false, FAULT_DRIVE_HANGS);
    const struct drive_power_enable_ops broken = {loop.relay.lines.ops->toggle, cut_nothing};
    loop.relay.lines.ops = &broken;
    (void)until(is_noticed);
    for (int ticks = 0; ticks < TICKS_OF_MS(900); ticks++) {
        injector_tick(&injector);
    }
    ck_assert(!is_without_torque());
    for (int ticks = 0; ticks < TICKS_OF_MS(60); ticks++) {
        injector_tick(&injector);
    }
    ck_assert(is_without_torque());
}
END_TEST

/* The controller is gone: its drives have unloaded by themselves long before the relay falls. */
START_TEST(a_controller_that_is_gone_leaves_the_drives_their_time_to_unload)
{
    walk_and_break(false, FAULT_CONTROLLER_UNPLUGGED);
    const double slack_ms = until(is_slack);
    ck_assert_double_lt(slack_ms, 400);
    ck_assert(!loop.nodes.torque_is_off);
    for (int ticks = 0; ticks < TICKS_OF_MS(450) && !loop.nodes.torque_is_off; ticks++) {
        injector_tick(&injector);
    }
    ck_assert(loop.nodes.torque_is_off);
}
END_TEST

/* A board is away for so long: the watchdog's 120 ms, then the starter's test of RAM and program (firmware/README.md). */
static const int downtimes_ms[] = {120, 200, 300, 400};

/* The board comes back with the latched fault. The line that cuts is low meanwhile, and the pump stands still for less
 * than K2 waits: the drives keep their torque until they have unloaded, and behind it. */
START_TEST(a_controller_that_restarts_cuts_nothing)
{
    const struct fault_shot away = {.kind = FAULT_TICKS_MISSED,
                                    .duration_ticks =
                                        (uint32_t)TICKS_OF_MS((unsigned)downtimes_ms[_i])};
    const struct fault_shot reset = {.kind = FAULT_CONTROLLER_RESET, .duration_ticks = 1};
    walk_and_break(false, FAULT_TICKS_MISSED);
    injector_begin(&injector, &loop, &away, 1);
    for (uint32_t ticks = 0; ticks < away.duration_ticks; ticks++) {
        injector_tick(&injector);
        ck_assert(!loop.nodes.torque_is_off);
    }
    injector_begin(&injector, &loop, &reset, 1);
    injector_tick(&injector);
    supervisor_force_fault(&loop.rig.task.controller.supervisor, SUPERVISOR_FAULT_RESTARTED);
    for (int ticks = 0; ticks < TICKS_OF_MS(2000); ticks++) {
        injector_tick(&injector);
        ck_assert(!loop.nodes.torque_is_off);
        ck_assert(!loop.relay.is_cut);
    }
    ck_assert(is_slack());
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_FAULT);
}
END_TEST

/* Longer away than K2 waits: with its drives unloaded, and K2 has to be started. */
START_TEST(a_controller_that_is_away_for_longer_has_lost_the_relay)
{
    walk_and_break(false, FAULT_TICKS_MISSED);
    int ticks = 0;
    while (!loop.nodes.torque_is_off && ticks < TICKS_OF_MS(1000)) {
        injector_tick(&injector);
        ticks++;
    }
    ck_assert_int_ge(ticks, TICKS_OF_MS(POWER_RELAY_PUMP_MS + POWER_RELAY_K2_MS));
    ck_assert_int_le(ticks, TICKS_OF_MS(450));
    ck_assert(is_slack());
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("drive_power");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(
        tests, a_drive_that_hangs_loses_its_torque_at_once_and_its_spring_within_a_second, 0, 2);
    tcase_add_loop_test(tests, a_drive_that_answers_and_holds_its_motor_is_slack_within_a_second, 0,
                        2);
    tcase_add_test(tests, after_a_stop_by_nmt_the_power_goes);
    tcase_add_test(tests, without_the_cutting_line_the_pump_takes_it_later);
    tcase_add_test(tests, a_controller_that_is_gone_leaves_the_drives_their_time_to_unload);
    tcase_add_loop_test(tests, a_controller_that_restarts_cuts_nothing, 0,
                        (int)(sizeof downtimes_ms / sizeof downtimes_ms[0]));
    tcase_add_test(tests, a_controller_that_is_away_for_longer_has_lost_the_relay);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
