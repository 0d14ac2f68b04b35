/* Who answers a SYNC, by what CiA 301 lets a node do in each NMT state. */
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/devices/sea_drive_cia402.h"
#include "sim_host/loop/lock_step.h"
#include "tests/support/assert_close.h"

enum { ALL = 0xF, DRIVE_LEFT = 1, DRIVE_RIGHT = 2, SENSOR_LEFT = 4 };

struct bench {
    struct cia402_drives drives;
    struct control_task task;
};

static struct network_node *node(struct bench *bench, unsigned number)
{
    return &bench->task.network.node[number - 1];
}

/* All four operational, and their last answers a cycle old. */
static void setup(struct bench *bench)
{
    static const struct cia402_axis_config axes[SIDE_COUNT] = {
        {.counts_per_m = 1.0e6f, .zero_counts = 0, .direction = 1, .rated_force_N = 0.0f},
        {.counts_per_m = 1.0e6f, .zero_counts = 0, .direction = 1, .rated_force_N = 0.0f}};
    memset(bench, 0, sizeof *bench);
    cia402_drives_init(&bench->drives, axes);
    bench->task.config.drives = cia402_drives_interface(&bench->drives);
    network_init(&bench->task.network);
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        bench->task.network.node[i].state = NMT_OPERATIONAL;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        bench->task.sensors.reading[leg].leg_age_ticks = 1;
        bench->drives.axis[leg].age_ticks = 1;
    }
}

static void all_answer(struct bench *bench)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        bench->task.sensors.reading[leg].leg_age_ticks = 0;
        bench->drives.axis[leg].age_ticks = 0;
    }
}

START_TEST(operational_nodes_answer)
{
    struct bench bench;
    setup(&bench);
    ck_assert_uint_eq(lock_step_expected(&bench.task), ALL);
    ck_assert(!lock_step_answered(&bench.task, ALL));
    all_answer(&bench);
    ck_assert(lock_step_answered(&bench.task, ALL));
    bench.drives.axis[SIDE_RIGHT].age_ticks = 1;
    ck_assert(!lock_step_answered(&bench.task, ALL));
    ck_assert(lock_step_answered(&bench.task, ALL & ~DRIVE_RIGHT));
    /* None that was not heard of for a while answered by being unheard. */
    node(&bench, 2)->state = NMT_UNKNOWN;
    bench.drives.axis[SIDE_RIGHT].age_ticks = UINT16_MAX;
    ck_assert_uint_eq(lock_step_expected(&bench.task), ALL & ~DRIVE_RIGHT);
    /* But it is there if it answers before its first heartbeat. */
    bench.drives.axis[SIDE_RIGHT].age_ticks = 2;
    ck_assert_uint_eq(lock_step_expected(&bench.task), ALL);
}
END_TEST

START_TEST(a_node_that_was_told_to_start_answers_one_that_was_stopped_does_not)
{
    struct bench bench;
    setup(&bench);
    node(&bench, 1)->state = NMT_PRE_OPERATIONAL;
    node(&bench, 3)->state = NMT_STOPPED;
    all_answer(&bench); /* the last SYNC, before they changed their state */
    ck_assert_uint_eq(lock_step_expected(&bench.task), ALL & ~DRIVE_LEFT & ~SENSOR_LEFT);
    node(&bench, 1)->start_wait = 50;
    ck_assert_uint_eq(lock_step_expected(&bench.task), ALL & ~SENSOR_LEFT);
    /* All stopped: until their next heartbeat they say that they are operational. */
    for (unsigned number = 1; number <= NETWORK_NODES; number++) {
        node(&bench, number)->stop_pending = true;
        node(&bench, number)->start_wait = NETWORK_STOP_TICKS;
    }
    ck_assert_uint_eq(lock_step_expected(&bench.task), 0);
}
END_TEST

START_TEST(a_node_that_is_being_set_up_answers_requests_only)
{
    struct bench bench;
    setup(&bench);
    bench.task.bring_up.setup.node = NODE_DRIVE_LEFT;
    ck_assert_uint_eq(lock_step_expected(&bench.task), ALL & ~DRIVE_LEFT);
    all_answer(&bench);
    ck_assert(lock_step_answered(&bench.task, ALL & ~DRIVE_LEFT));
    /* While a request is open its answer is waited for. */
    bench.task.bring_up.setup.under_way = true;
    co_sdo_client_init(&bench.task.bring_up.setup.client, NODE_DRIVE_LEFT, 1000);
    co_sdo_client_read(&bench.task.bring_up.setup.client, 0x1000, 0, 0);
    ck_assert(!lock_step_answered(&bench.task, ALL & ~DRIVE_LEFT));
}
END_TEST

START_TEST(a_node_that_boots_meanwhile_is_waited_for_no_longer)
{
    struct bench bench;
    const struct can_msg boot = {.id = FRAME_HEARTBEAT_SENSOR_LEFT, .length = 1};
    setup(&bench);
    all_answer(&bench);
    bench.task.sensors.reading[SIDE_LEFT].leg_age_ticks = 1;
    ck_assert(!lock_step_answered(&bench.task, ALL));
    ck_assert(network_receive(&bench.task.network, &boot));
    ck_assert(lock_step_answered(&bench.task, ALL));
}
END_TEST

START_TEST(all_are_known_when_each_has_told_its_state)
{
    struct bench bench;
    setup(&bench);
    ck_assert(lock_step_knows_all(&bench.task));
    node(&bench, 4)->state = NMT_UNKNOWN;
    ck_assert(!lock_step_knows_all(&bench.task));
    node(&bench, 4)->state = NMT_STOPPED;
    ck_assert(lock_step_knows_all(&bench.task));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("lock_step");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, operational_nodes_answer);
    tcase_add_test(tests, a_node_that_was_told_to_start_answers_one_that_was_stopped_does_not);
    tcase_add_test(tests, a_node_that_is_being_set_up_answers_requests_only);
    tcase_add_test(tests, a_node_that_boots_meanwhile_is_waited_for_no_longer);
    tcase_add_test(tests, all_are_known_when_each_has_told_its_state);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
