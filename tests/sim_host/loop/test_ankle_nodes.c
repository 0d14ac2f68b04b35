/* Ankle sensors that are nodes of their own, on the in-process bus: the device walks as it does with one
 * sensor a leg, and an ankle sensor that is lost, late or otherwise than told is noticed. */
#include <stdlib.h>
#include <string.h>

#include "hal/devices/device_check.h"
#include "sim_host/loop/loop.h"
#include "tests/support/assert_close.h"

enum { STEPS = 20, ANKLE_LEFT_NODE = 7, ANKLE_RIGHT_NODE = 41 };

static struct loop loop;

static void ankle_nodes(struct device_description *device, int mask)
{
    static const int32_t node[SIDE_COUNT] = {ANKLE_LEFT_NODE, ANKLE_RIGHT_NODE};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device->leg[leg].ankle_sensor_node = (mask >> leg & 1) != 0 ? node[leg] : 0;
    }
}

static void start(int mask, bool mirrored)
{
    static struct loop_config config;
    struct subject subject;
    struct control_params params;
    struct device_refusal refusal;
    char message[LOOP_MESSAGE_MAX] = "";
    subject_default(&subject);
    ankle_nodes(&subject.device.description, mask);
    if (mirrored) {
        struct device_leg *right = &subject.device.description.leg[SIDE_RIGHT];
        right->ankle_direction = -1;
        right->ankle_zero_m = 0.02f;
        right->ankle_counts_per_m = 50000.0f;
    }
    ck_assert_int_eq(device_check(&subject.device.description, &refusal), DEVICE_OK);
    ck_assert_msg(subject_control_params(&subject, &params, message) == 0, "%s", message);
    ck_assert_msg(loop_configure(&config, &subject, &params, 0.45, SENSORS_17BIT, 1, message) == 0,
                  "%s", message);
    ck_assert_msg(loop_init(&loop, &config, NULL, message) == 0, "%s", message);
}

static void walk(uint32_t steps)
{
    while (loop.tick < 60000 && loop.rig.task.controller.last_step.number < steps &&
           loop.rig.task.output.fault == SUPERVISOR_FAULT_NONE) {
        loop_tick(&loop);
    }
}

static const struct control_task *task(void)
{
    return &loop.rig.task;
}

/* 1 left, 2 right, 3 both legs. */
START_TEST(it_walks_as_with_one_sensor_a_leg)
{
    start(0, false);
    walk(STEPS);
    const double speed = (double)task()->controller.last_step.measured_speed_rad_s;
    const double r0_m = (double)task()->controller.last_step.r0_m;
    ck_assert_uint_eq(task()->controller.last_step.number, STEPS);
    start(_i, _i == 3);
    walk(STEPS);
    ck_assert_int_eq(task()->output.fault, SUPERVISOR_FAULT_NONE);
    ck_assert_uint_eq(task()->controller.last_step.number, STEPS);
    assert_close((double)task()->controller.last_step.measured_speed_rad_s, speed, 2e-3, 0.0);
    assert_close((double)task()->controller.last_step.r0_m, r0_m, 5e-4, 0.0);
    ck_assert_uint_eq(task()->node.objects.counters.late_answers, 0);
}
END_TEST

/* Its heartbeat goes on and its values stay away: as with every sensor. */
START_TEST(an_ankle_sensor_that_falls_silent_is_a_fault)
{
    start(3, false);
    walk(6);
    ck_assert_int_eq(task()->output.state, SUPERVISOR_WALKING);
    loop.nodes.ankle[SIDE_RIGHT].pdos.tpdo[1].cob_id |= 0x80000000u;
    walk(12);
    ck_assert_int_eq(task()->output.fault, SUPERVISOR_FAULT_SENSOR_STALE);
}
END_TEST

START_TEST(an_ankle_sensor_that_is_missing_is_waited_for)
{
    start(3, false);
    loop.nodes.device.leg[SIDE_LEFT].ankle_sensor_node = 0; /* it is not on the bus */
    walk(1);
    ck_assert_int_eq(task()->output.state, SUPERVISOR_INIT);
    ck_assert_uint_eq(task()->network.node[NETWORK_ANKLE_LEFT].state, NMT_UNKNOWN);
}
END_TEST

START_TEST(an_ankle_sensor_of_another_kind_is_refused)
{
    start(3, false);
    loop.nodes.ankle[SIDE_LEFT].objects.ankle_is_lever = 1;
    walk(1);
    ck_assert_int_eq(task()->output.state, SUPERVISOR_INIT);
    ck_assert_uint_eq(task()->node.objects.refused_node, ANKLE_LEFT_NODE);
    ck_assert_uint_eq(task()->node.objects.refused_index, 0x2021);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("ankle_nodes");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, it_walks_as_with_one_sensor_a_leg, 1, 4);
    tcase_add_test(tests, an_ankle_sensor_that_falls_silent_is_a_fault);
    tcase_add_test(tests, an_ankle_sensor_that_is_missing_is_waited_for);
    tcase_add_test(tests, an_ankle_sensor_of_another_kind_is_refused);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
