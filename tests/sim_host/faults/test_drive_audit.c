/* A drive's setting changes by itself while it walks (no frame tells of it): the controller reads it back,
 * unloads, and names the object. */
#include "hal/canopen/co_od.h"
#include "tests/support/injected_walk.h"

#include <string.h>

static struct loop saved, loop;
static struct injector injector;

static void walk_a_while(void)
{
    injected_walk_prepare(&loop, NULL, 0);
    injected_walk_begin(&injector, &loop, 5);
    memcpy(&saved, &loop, sizeof loop);
}

static void change(enum side side, uint16_t index, uint8_t sub)
{
    void *base;
    uint32_t refused;
    uint8_t bytes[CO_VALUE_MAX];
    const struct co_device *device = &loop.nodes.drive[side].device;
    const struct co_entry *entry =
        co_od_find(device->dictionaries, CO_DICTIONARIES, index, sub, &base, &refused);
    ck_assert_ptr_nonnull(entry);
    ck_assert_uint_gt(co_od_load(entry, base, bytes), 0);
    ((uint8_t *)base)[entry->offset] ^= 1;
}

static bool is_fault(void)
{
    return loop.rig.task.output.fault != SUPERVISOR_FAULT_NONE;
}

static const struct {
    uint16_t index;
    uint8_t sub;
    bool felt; /* the walk itself is changed by it: another check may come first */
} settings[] = {
    {0x1016, 1, false}, {0x1400, 5, false}, {0x6007, 0, false}, {0x605A, 0, false},
    {0x605B, 0, false}, {0x605C, 0, false}, {0x605E, 0, false}, {0x6065, 0, false},
    {0x6066, 0, false}, {0x607D, 1, false}, {0x607D, 2, false}, {0x6080, 0, false},
    {0x60C2, 1, false}, {0x60C2, 2, false}, {0x60FE, 2, false}, {0x1400, 1, true},
    {0x1401, 1, true},  {0x1400, 2, true},  {0x1601, 1, false}, {0x1600, 1, false},
    {0x1600, 0, true},
};

START_TEST(a_setting_that_changes_by_itself_is_found_within_a_round)
{
    walk_a_while();
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        const enum side side = i % 2 == 0 ? SIDE_LEFT : SIDE_RIGHT;
        memcpy(&loop, &saved, sizeof loop);
        change(side, settings[i].index, settings[i].sub);
        for (int tick = 0; tick < TICKS_OF_MS(1000 * DRIVE_AUDIT_ROUND_S + 100) && !is_fault();
             tick++) {
            injector_tick(&injector);
        }
        const struct control_task *task = &loop.rig.task;
        ck_assert_msg(is_fault(), "%#x:%u: not found", settings[i].index, settings[i].sub);
        if (settings[i].felt && task->output.fault != SUPERVISOR_FAULT_NODE_CHANGED) {
            continue;
        }
        ck_assert_msg(task->output.fault == SUPERVISOR_FAULT_NODE_CHANGED, "%#x:%u: fault %d",
                      settings[i].index, settings[i].sub, (int)task->output.fault);
        ck_assert_int_eq(task->output.state, SUPERVISOR_UNLOADING);
        ck_assert_uint_eq(task->node.objects.refused_node, 1u + (unsigned)side);
        ck_assert_uint_eq(task->node.objects.refused_index, settings[i].index);
        ck_assert_uint_eq(task->node.objects.refused_sub, settings[i].sub);
        ck_assert_uint_eq(task->node.objects.refused_expected ^ task->node.objects.refused_found,
                          1);
    }
}
END_TEST

/* Unloaded and off the drive is told everything anew, and a reset leads back to a walk's beginning. */
START_TEST(the_drive_is_set_up_anew_afterwards)
{
    walk_a_while();
    change(SIDE_LEFT, 0x6007, 0);
    for (int tick = 0; tick < TICKS_OF_MS(8000); tick++) {
        injector_tick(&injector);
    }
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_FAULT);
    ck_assert_int_eq(loop.rig.task.audit.memory.deviates, 0);
    ck_assert_uint_eq(loop.rig.task.node.objects.refused_node, 0);
    ck_assert_int_eq(loop.nodes.drive[SIDE_LEFT].objects.abort_connection_option, 1);
    ck_assert(network_all_operational(&loop.rig.task.network));
}
END_TEST

START_TEST(a_round_takes_its_time_and_disturbs_nobody)
{
    walk_a_while();
    const uint32_t from = loop.nodes.drive[SIDE_LEFT].device.counters.sdo_requests;
    for (int tick = 0; tick < TICKS_OF_MS(1000 * DRIVE_AUDIT_ROUND_S); tick++) {
        injector_tick(&injector);
    }
    const uint32_t asked = loop.nodes.drive[SIDE_LEFT].device.counters.sdo_requests - from;
    ck_assert_uint_ge(asked, DRIVE_AUDIT_OBJECTS);
    ck_assert_uint_le(asked, DRIVE_AUDIT_OBJECTS + 4);
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_WALKING);
    ck_assert_uint_eq(loop.rig.task.node.objects.counters.audits_unanswered, 0);
}
END_TEST

/* Its answers have an identifier that nobody hears: that is counted, up to the counter's end, and no fault. */
START_TEST(a_drive_that_answers_no_request_is_counted)
{
    walk_a_while();
    uint32_t *unanswered = &loop.rig.task.node.objects.counters.audits_unanswered;
    loop.nodes.drive[SIDE_LEFT].device.comm.sdo_answer_id = 0x7E0;
    for (int tick = 0; tick < TICKS_OF_MS(4000); tick++) {
        injector_tick(&injector);
    }
    ck_assert_uint_ge(*unanswered, 2);
    ck_assert_uint_le(*unanswered, TICKS_OF_MS(4000) / DRIVE_AUDIT_TICKS + 1);
    *unanswered = UINT32_MAX;
    for (int tick = 0; tick < TICKS_OF_MS(4000); tick++) {
        injector_tick(&injector);
    }
    ck_assert_uint_eq(*unanswered, UINT32_MAX);
    ck_assert_int_eq(loop.rig.task.output.state, SUPERVISOR_WALKING);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("drive_audit");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, a_setting_that_changes_by_itself_is_found_within_a_round);
    tcase_add_test(tests, the_drive_is_set_up_anew_afterwards);
    tcase_add_test(tests, a_round_takes_its_time_and_disturbs_nobody);
    tcase_add_test(tests, a_drive_that_answers_no_request_is_counted);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
