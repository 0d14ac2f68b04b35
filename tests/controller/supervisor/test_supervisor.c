/* One test per edge of the supervisor's table, and what no combination may do. */
#include "controller/supervisor/supervisor.h"
#include "tests/support/assert_close.h"

static enum supervisor_state after(enum supervisor_state from, unsigned conditions,
                                   enum supervisor_fault latched)
{
    struct supervisor supervisor = {from, latched, 0, 0};
    (void)supervisor_update(&supervisor, 1, (uint16_t)conditions, SUPERVISOR_FAULT_DRIVE);
    return supervisor.state;
}

/* Written from the prose of supervisor.h, not from the table. */
static const struct {
    enum supervisor_state from;
    unsigned conditions;
    bool latched;
    enum supervisor_state to;
} edges[] = {
    {SUPERVISOR_INIT, 0, false, SUPERVISOR_INIT},
    {SUPERVISOR_INIT, SUPERVISOR_IF_NODES, false, SUPERVISOR_SELF_TEST},
    {SUPERVISOR_INIT, SUPERVISOR_IF_NODES | SUPERVISOR_IF_FAULT, false, SUPERVISOR_INIT},
    {SUPERVISOR_INIT, SUPERVISOR_IF_NODES | SUPERVISOR_IF_FAULT | SUPERVISOR_IF_TIMEOUT, false,
     SUPERVISOR_FAULT},
    {SUPERVISOR_INIT, SUPERVISOR_IF_FAULT | SUPERVISOR_IF_TIMEOUT, false, SUPERVISOR_INIT},
    {SUPERVISOR_SELF_TEST, 0, false, SUPERVISOR_SELF_TEST},
    {SUPERVISOR_SELF_TEST, SUPERVISOR_IF_PLAUSIBLE, false, SUPERVISOR_STANDBY},
    {SUPERVISOR_SELF_TEST, SUPERVISOR_IF_FAULT, false, SUPERVISOR_FAULT},
    {SUPERVISOR_STANDBY, SUPERVISOR_IF_WALK_REQUESTED, false, SUPERVISOR_STANDBY},
    {SUPERVISOR_STANDBY, SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_PLAUSIBLE, false,
     SUPERVISOR_ENGAGING},
    {SUPERVISOR_STANDBY, SUPERVISOR_IF_FAULT, false, SUPERVISOR_FAULT},
    {SUPERVISOR_ENGAGING, SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_STEPPING, false,
     SUPERVISOR_ENGAGING},
    {SUPERVISOR_ENGAGING,
     SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_STEADY | SUPERVISOR_IF_ENABLED, false,
     SUPERVISOR_WALKING},
    {SUPERVISOR_SELF_TEST, SUPERVISOR_IF_TIMEOUT, false, SUPERVISOR_FAULT},
    {SUPERVISOR_WALKING,
     SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_STEPPING | SUPERVISOR_IF_REGULAR, false,
     SUPERVISOR_WALKING},
    {SUPERVISOR_ENGAGING, 0, false, SUPERVISOR_UNLOADING},
    {SUPERVISOR_ENGAGING, SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_TIMEOUT, false,
     SUPERVISOR_UNLOADING},
    {SUPERVISOR_ENGAGING,
     SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_STEADY | SUPERVISOR_IF_ENABLED |
         SUPERVISOR_IF_TIMEOUT,
     false, SUPERVISOR_WALKING},
    {SUPERVISOR_ENGAGING, SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_FAULT, false,
     SUPERVISOR_UNLOADING},
    {SUPERVISOR_WALKING, SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_STEPPING, false,
     SUPERVISOR_UNLOADING},
    {SUPERVISOR_WALKING, SUPERVISOR_IF_STEPPING, false, SUPERVISOR_UNLOADING},
    {SUPERVISOR_WALKING, SUPERVISOR_IF_WALK_REQUESTED, false, SUPERVISOR_UNLOADING},
    {SUPERVISOR_WALKING,
     SUPERVISOR_IF_WALK_REQUESTED | SUPERVISOR_IF_STEPPING | SUPERVISOR_IF_FAULT, false,
     SUPERVISOR_UNLOADING},
    {SUPERVISOR_STANDBY, SUPERVISOR_IF_MOTION_REQUESTED, false, SUPERVISOR_STANDBY},
    {SUPERVISOR_STANDBY, SUPERVISOR_IF_MOTION_REQUESTED | SUPERVISOR_IF_PLAUSIBLE, false,
     SUPERVISOR_COMMISSIONING},
    {SUPERVISOR_STANDBY,
     SUPERVISOR_IF_MOTION_REQUESTED | SUPERVISOR_IF_PLAUSIBLE | SUPERVISOR_IF_WALK_REQUESTED, false,
     SUPERVISOR_ENGAGING},
    {SUPERVISOR_COMMISSIONING, SUPERVISOR_IF_MOTION_REQUESTED, false, SUPERVISOR_COMMISSIONING},
    {SUPERVISOR_COMMISSIONING, 0, false, SUPERVISOR_UNLOADING},
    {SUPERVISOR_COMMISSIONING, SUPERVISOR_IF_MOTION_REQUESTED | SUPERVISOR_IF_FAULT, false,
     SUPERVISOR_UNLOADING},
    {SUPERVISOR_COMMISSIONING, SUPERVISOR_IF_MOTION_REQUESTED | SUPERVISOR_IF_WALK_REQUESTED, false,
     SUPERVISOR_UNLOADING},
    {SUPERVISOR_UNLOADING, 0, false, SUPERVISOR_UNLOADING},
    {SUPERVISOR_UNLOADING, SUPERVISOR_IF_UNLOADED, false, SUPERVISOR_STANDBY},
    {SUPERVISOR_UNLOADING, SUPERVISOR_IF_UNLOADED, true, SUPERVISOR_FAULT},
    {SUPERVISOR_UNLOADING, SUPERVISOR_IF_TIMEOUT, false, SUPERVISOR_FAULT},
    {SUPERVISOR_UNLOADING, 0, true, SUPERVISOR_UNLOADING},
    {SUPERVISOR_FAULT, SUPERVISOR_IF_RESET, true, SUPERVISOR_FAULT},
    {SUPERVISOR_FAULT, SUPERVISOR_IF_STANDSTILL, true, SUPERVISOR_FAULT},
    {SUPERVISOR_FAULT, SUPERVISOR_IF_RESET | SUPERVISOR_IF_STANDSTILL, true, SUPERVISOR_INIT},
    {SUPERVISOR_FAULT, SUPERVISOR_IF_RESET | SUPERVISOR_IF_STANDSTILL | SUPERVISOR_IF_FAULT, true,
     SUPERVISOR_FAULT},
};

START_TEST(every_edge)
{
    const enum supervisor_fault latched =
        edges[_i].latched ? SUPERVISOR_FAULT_DRIVE : SUPERVISOR_FAULT_NONE;
    ck_assert_int_eq(after(edges[_i].from, edges[_i].conditions, latched), edges[_i].to);
}
END_TEST

START_TEST(first_fault_is_latched_until_reset)
{
    struct supervisor supervisor;
    supervisor_init(&supervisor);
    (void)supervisor_update(&supervisor, 1, SUPERVISOR_IF_FAULT, SUPERVISOR_FAULT_NODE_LOST);
    ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_NONE); /* nodes still booting */
    (void)supervisor_update(&supervisor, 2, SUPERVISOR_IF_NODES, SUPERVISOR_FAULT_NONE);
    (void)supervisor_update(&supervisor, 3, SUPERVISOR_IF_FAULT, SUPERVISOR_FAULT_SENSOR_STALE);
    (void)supervisor_update(&supervisor, 4, SUPERVISOR_IF_FAULT, SUPERVISOR_FAULT_DRIVE);
    ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_SENSOR_STALE);
    ck_assert_int_eq(supervisor.state, SUPERVISOR_FAULT);
    (void)supervisor_update(&supervisor, 5, SUPERVISOR_IF_RESET | SUPERVISOR_IF_STANDSTILL,
                            SUPERVISOR_FAULT_NONE);
    ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_NONE);
    ck_assert_int_eq(supervisor.state, SUPERVISOR_INIT);
}
END_TEST

/* FAULT is never entered without a reason to show. */
START_TEST(what_took_too_long_is_a_fault)
{
    struct supervisor supervisor = {SUPERVISOR_UNLOADING, SUPERVISOR_FAULT_NONE, 0, 0};
    ck_assert(supervisor_update(&supervisor, 9, SUPERVISOR_IF_TIMEOUT, SUPERVISOR_FAULT_NONE));
    ck_assert_int_eq(supervisor.state, SUPERVISOR_FAULT);
    ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_UNLOAD);
    ck_assert_uint_eq(supervisor.since_tick, 9);
    supervisor = (struct supervisor){SUPERVISOR_SELF_TEST, SUPERVISOR_FAULT_NONE, 0, 0};
    ck_assert(supervisor_update(&supervisor, 9, SUPERVISOR_IF_TIMEOUT, SUPERVISOR_FAULT_NONE));
    ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_SELF_TEST);
    supervisor_init(&supervisor);
    ck_assert(supervisor_update(&supervisor, 9,
                                SUPERVISOR_IF_NODES | SUPERVISOR_IF_FAULT | SUPERVISOR_IF_TIMEOUT,
                                SUPERVISOR_FAULT_DRIVE));
    ck_assert_int_eq(supervisor.state, SUPERVISOR_FAULT);
    ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_DRIVE); /* what lasted, not that it did */
}
END_TEST

START_TEST(under_every_combination)
{
    for (int state = 0; state < SUPERVISOR_STATES; state++) {
        for (unsigned bits = 0; bits < 1u << SUPERVISOR_CONDITION_BITS; bits++) {
            for (int latched = 0; latched < 2; latched++) {
                const enum supervisor_state to =
                    after((enum supervisor_state)state, bits,
                          latched ? SUPERVISOR_FAULT_DRIVE : SUPERVISOR_FAULT_NONE);
                if (bits & SUPERVISOR_IF_FAULT) {
                    ck_assert_msg(!supervisor_may_assist(to), "assists with a fault, from %d",
                                  state);
                }
                if (state == SUPERVISOR_FAULT && to != SUPERVISOR_FAULT) {
                    ck_assert_int_eq(to, SUPERVISOR_INIT);
                }
                if (to == SUPERVISOR_WALKING && state != SUPERVISOR_WALKING) {
                    ck_assert_int_eq(state, SUPERVISOR_ENGAGING);
                }
                if (to == SUPERVISOR_ENGAGING && state != SUPERVISOR_ENGAGING) {
                    ck_assert_int_eq(state, SUPERVISOR_STANDBY);
                }
            }
        }
    }
    ck_assert(!supervisor_may_enable(SUPERVISOR_FAULT));
    ck_assert(!supervisor_may_assist(SUPERVISOR_UNLOADING));
}
END_TEST

START_TEST(every_fault_has_a_name)
{
    for (int fault = 0; fault < SUPERVISOR_FAULTS; fault++) {
        const char *name = supervisor_fault_name((enum supervisor_fault)fault);
        ck_assert_str_ne(name, "unknown");
        ck_assert_str_ne(name, "");
        for (int other = 0; other < fault; other++) {
            ck_assert_str_ne(name, supervisor_fault_name((enum supervisor_fault)other));
        }
    }
    ck_assert_str_eq(supervisor_fault_name((enum supervisor_fault)99), "unknown");
    ck_assert_str_eq(supervisor_fault_name(SUPERVISOR_FAULT_EMERGENCY_STOP), "emergency stop");
}
END_TEST

START_TEST(a_forced_fault_needs_no_rule)
{
    for (int from = 0; from < SUPERVISOR_STATES; from++) {
        struct supervisor supervisor = {(enum supervisor_state)from, SUPERVISOR_FAULT_NONE, 5, 7};
        supervisor_force_fault(&supervisor, SUPERVISOR_FAULT_RESTARTED);
        ck_assert_int_eq(supervisor.state, SUPERVISOR_FAULT);
        ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_RESTARTED);
        (void)supervisor_update(&supervisor, 9, SUPERVISOR_IF_FAULT, SUPERVISOR_FAULT_DRIVE);
        ck_assert_int_eq(supervisor.latched, SUPERVISOR_FAULT_RESTARTED); /* it came first */
        (void)supervisor_update(&supervisor, 10, SUPERVISOR_IF_RESET | SUPERVISOR_IF_STANDSTILL,
                                SUPERVISOR_FAULT_NONE);
        ck_assert_int_eq(supervisor.state, SUPERVISOR_INIT);
    }
}
END_TEST

/* Nodes may be missing for as long as they like: the time in INIT counts from the last tick
 * without them. */
START_TEST(the_time_in_init_begins_with_the_nodes)
{
    struct supervisor supervisor;
    supervisor_init(&supervisor);
    ck_assert_uint_eq(supervisor.since_tick, 0);
    for (uint32_t tick = 1; tick <= 100; tick++) {
        (void)supervisor_update(&supervisor, tick, SUPERVISOR_IF_FAULT, SUPERVISOR_FAULT_NODE_LOST);
    }
    ck_assert_uint_eq(supervisor.since_tick, 100);
    (void)supervisor_update(&supervisor, 101, SUPERVISOR_IF_NODES | SUPERVISOR_IF_FAULT,
                            SUPERVISOR_FAULT_DRIVE);
    ck_assert_int_eq(supervisor.state, SUPERVISOR_INIT);
    ck_assert_uint_eq(supervisor.since_tick, 100);
    ck_assert_uint_eq(supervisor.updated_tick, 101);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("supervisor");
    TCase *tests = tcase_create("all");
    tcase_add_loop_test(tests, every_edge, 0, (int)(sizeof edges / sizeof edges[0]));
    tcase_add_test(tests, first_fault_is_latched_until_reset);
    tcase_add_test(tests, what_took_too_long_is_a_fault);
    tcase_add_test(tests, under_every_combination);
    tcase_add_test(tests, every_fault_has_a_name);
    tcase_add_test(tests, a_forced_fault_needs_no_rule);
    tcase_add_test(tests, the_time_in_init_begins_with_the_nodes);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
