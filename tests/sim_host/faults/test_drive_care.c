/* A motor gets hot, a supply sags, a maker's drive warns, and a drive stops telling, in a simulated walk: the
 * pushes of both legs become smaller, and in the end the springs are unloaded without a fault. */
#include "controller/supervisor/derate.h"
#include "firmware/telemetry.h"
#include "tests/support/injected_walk.h"

#include <string.h>

static struct loop loop;
static struct injector injector;

static struct control_task *task(void)
{
    return &loop.rig.task;
}

static const struct derate *derate(void)
{
    return &task()->controller.derate;
}

static void limit(struct device_leg *leg)
{
    leg->temperature_warn_degC = 60.0f;
    leg->temperature_stop_degC = 80.0f;
    leg->supply_min_V = 30.0f;
    leg->supply_max_V = 60.0f;
}

/* A person with the device on, or a compass on the bench, until it has taken so many steps. */
static void walk_with(bool person, bool tells_force, unsigned steps)
{
    struct subject subject;
    subject_default(&subject);
    limit(&subject.device.description.leg[SIDE_LEFT]);
    limit(&subject.device.description.leg[SIDE_RIGHT]);
    for (int leg = 0; leg < SIDE_COUNT && !tells_force; leg++) {
        subject.device.description.leg[leg].rated_force_N = 0.0f;
    }
    injected_walk_prepare(&loop, &subject, person ? 4 : 0);
    injected_walk_begin(&injector, &loop, steps);
}

static void walk(bool person, unsigned steps)
{
    walk_with(person, true, steps);
}

static void run(double seconds)
{
    for (int tick = 0; tick < TICKS_OF_MS(1000) * seconds; tick++) {
        injector_tick(&injector);
    }
}

static void set_temperature(enum side side, double degC)
{
    loop.nodes.plant.sea[side].temperature_degC = degC;
    loop.nodes.plant.sea[side].params.thermal_rise_K = 0.0;
    loop.nodes.plant.sea[side].params.ambient_degC = degC; /* it stays there */
}

static void run_to(enum supervisor_state state, double seconds)
{
    for (int tick = 0; tick < TICKS_OF_MS(1000) * seconds && task()->output.state != state;
         tick++) {
        injector_tick(&injector);
    }
    ck_assert_int_eq(task()->output.state, state);
}

static const struct controller_objects *shown(void)
{
    task()->node.rules.show(task()->node.rules.show_context, CONTROLLER_INDEX_DRIVES);
    return &task()->node.objects;
}

/* Emergencies that the controller's node sent, newest first: 0x1003. */
static bool was_told(uint16_t code)
{
    const struct co_comm *comm = &task()->node.device.comm;
    bool told = false;
    for (int i = 0; i < comm->history_count; i++) {
        told = told || (comm->history[i] & 0xFFFFu) == code;
    }
    return told;
}

/* 66 degC lie three tenths of the way to the stop: 0.7 of the push, of both legs. */
START_TEST(a_hot_motor_makes_both_pushes_smaller)
{
    walk(true, 12);
    run(10.0);
    ck_assert(!was_told(CONTROLLER_EMCY_SPARED));
    const double before_m = (double)task()->controller.last_step.r0_m;
    const double level = (double)task()->controller.plan.assist_level;
    set_temperature(SIDE_RIGHT, 66.0);
    run(8.0);
    ck_assert_int_eq(task()->output.state, SUPERVISOR_WALKING);
    assert_close((double)derate()->share, 0.7, 1e-3, 0.0);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const uint32_t number = task()->controller.last_step.number;
        while (task()->controller.last_step.number == number) {
            injector_tick(&injector);
        }
        const double law_m = (double)task()->controller.plan.law.r0_m;
        assert_close((double)task()->controller.last_step.r0_m, 0.7 * level * law_m, 1e-5, 0.0);
        ck_assert((double)task()->controller.last_step.r0_m < 0.85 * before_m);
    }
    ck_assert_uint_eq(shown()->push_share_percent, 70);
    ck_assert_uint_eq(shown()->spared_cause[SIDE_LEFT], DERATE_NONE);
    ck_assert_uint_eq(shown()->spared_cause[SIDE_RIGHT], DERATE_TEMPERATURE);
    ck_assert_uint_eq(shown()->withdrawn, 0);
    ck_assert(was_told(CONTROLLER_EMCY_SPARED));
    ck_assert((task()->node.device.comm.error_register & 0x08) != 0); /* CiA 301: temperature */
}
END_TEST

/* Beyond the stop: no fault, no torque off with a loaded spring, and nothing begins again by itself. */
START_TEST(beyond_the_stop_it_unloads_and_waits_for_a_new_request)
{
    walk(_i == 1, 12);
    set_temperature(SIDE_LEFT, 85.0);
    run_to(SUPERVISOR_UNLOADING, 3.0);
    ck_assert_int_eq(task()->output.fault, SUPERVISOR_FAULT_NONE);
    ck_assert(task()->output.sea[SIDE_LEFT].enable && task()->output.sea[SIDE_RIGHT].enable);
    run_to(SUPERVISOR_STANDBY, 1.0);
    ck_assert_int_eq(task()->output.fault, SUPERVISOR_FAULT_NONE);
    ck_assert_uint_eq(shown()->withdrawn, 1);
    ck_assert_uint_eq(shown()->withdrew_cause, DERATE_TEMPERATURE);
    ck_assert_uint_eq(shown()->withdrew_leg, SIDE_LEFT);
    task()->node.objects.walk_requested = 0;
    run(0.1);
    task()->node.objects.walk_requested = 1; /* still hot: refused */
    run(1.0);
    ck_assert_int_eq(task()->output.state, SUPERVISOR_STANDBY);
    set_temperature(SIDE_LEFT, 25.0);
    run(30.0); /* cold again, and that request is spent */
    ck_assert_int_eq(task()->output.state, SUPERVISOR_STANDBY);
    ck_assert_uint_eq(shown()->withdrawn, 0);
    ck_assert_uint_eq(shown()->withdrew_cause, DERATE_TEMPERATURE);
    ck_assert_uint_eq(shown()->push_share_percent, 100);
    task()->node.objects.walk_requested = 0;
    run(0.1);
    task()->node.objects.walk_requested = 1;
    run_to(SUPERVISOR_ENGAGING, 1.0);
}
END_TEST

START_TEST(a_low_supply_and_one_too_high_withdraw)
{
    walk(true, 12);
    loop.nodes.plant.sea[SIDE_LEFT].params.dc_link_V = _i == 0 ? 29.0 : 61.0;
    run_to(SUPERVISOR_UNLOADING, 3.0);
    ck_assert_int_eq(task()->output.fault, SUPERVISOR_FAULT_NONE);
    ck_assert_uint_eq(shown()->withdrew_cause, _i == 0 ? DERATE_SUPPLY_LOW : DERATE_SUPPLY_HIGH);
    ck_assert(was_told(CONTROLLER_EMCY_SPARED));
}
END_TEST

/* Its slow PDO stays away, and the position comes as before. Where the force is judged that is a fault
 * already; where it is not, nothing else notices. */
START_TEST(a_drive_that_no_longer_tells_is_not_believed_to_be_cool)
{
    walk_with(true, false, 12);
    run(2.0);
    ck_assert_int_eq(task()->output.state, SUPERVISOR_WALKING);
    loop.nodes.drive[SIDE_RIGHT].pdos.tpdo[2].cob_id |= 0x80000000u;
    run_to(SUPERVISOR_UNLOADING, 4.0);
    ck_assert_int_eq(task()->output.fault, SUPERVISOR_FAULT_NONE);
    ck_assert_uint_eq(shown()->withdrew_cause, DERATE_SILENT);
    ck_assert_uint_eq(shown()->withdrew_leg, SIDE_RIGHT);
}
END_TEST

/* What stands without the link is told, whoever asks: in the description that was given at the start. */
START_TEST(springs_that_nothing_unloads_are_told)
{
    struct device_description device;
    walk(true, 12);
    ck_assert_uint_eq(shown()->loaded_without_link, 0);
    device = task()->node.objects.device;
    device.leg[SIDE_RIGHT].unload = DEVICE_UNLOAD_NONE;
    control_task_describe(task(), &device);
    ck_assert_uint_eq(shown()->loaded_without_link, 2);
    device.leg[SIDE_LEFT].unload = DEVICE_UNLOAD_NONE;
    control_task_describe(task(), &device);
    ck_assert_uint_eq(shown()->loaded_without_link, 3);
    device.leg[SIDE_RIGHT].protocol = DEVICE_NO_DRIVE_PROTOCOL; /* no spring there */
    control_task_describe(task(), &device);
    ck_assert_uint_eq(shown()->loaded_without_link, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("drive_care");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, a_hot_motor_makes_both_pushes_smaller);
    tcase_add_loop_test(tests, beyond_the_stop_it_unloads_and_waits_for_a_new_request, 0, 2);
    tcase_add_loop_test(tests, a_low_supply_and_one_too_high_withdraw, 0, 2);
    tcase_add_test(tests, a_drive_that_no_longer_tells_is_not_believed_to_be_cool);
    tcase_add_test(tests, springs_that_nothing_unloads_are_told);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
