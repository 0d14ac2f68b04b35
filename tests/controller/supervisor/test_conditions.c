/* Each condition alone: what makes it true, from both sides of its limit, in ticks of 1 ms. The figures are those of
 * the comments of conditions.c. */
#include "controller/supervisor/conditions.h"

#include "controller/estimator/body_table.h"
#include "tests/support/assert_close.h"

enum { NOW = 100000 };

static struct control_params params;
static struct checks checks;
static struct step_monitor steps;
static struct sea_reference sea[SIDE_COUNT];
static struct controller_input input;
static struct supervisor supervisor;
static struct conditions_view view;

/* A person who walks: 600 ms a step, four of them steady. */
static void setup(void)
{
    params = (struct control_params){.body = (real)BODY_PERSON,
                                     .engage_steps = REAL(4.0),
                                     .step_timeout_s = REAL(1.5),
                                     .unload_timeout_s = REAL(0.5),
                                     .sea_tolerance_m = REAL(0.001)};
    checks = (struct checks){0};
    steps = (struct step_monitor){
        .seen = true, .known_tick = NOW, .step_ticks = {600, 600}, .steady = 4};
    sea[SIDE_LEFT] = sea[SIDE_RIGHT] = (struct sea_reference){0};
    input = (struct controller_input){.tick = NOW, .nodes_operational = true};
    supervisor = (struct supervisor){.state = SUPERVISOR_WALKING};
    view = (struct conditions_view){.params = &params,
                                    .input = &input,
                                    .checks = &checks,
                                    .step_monitor = &steps,
                                    .sea = sea,
                                    .walk_wanted = true};
}

static bool is(enum supervisor_condition condition)
{
    return (conditions_find(&supervisor, &view, SUPERVISOR_FAULT_NONE) & (unsigned)condition) != 0;
}

/* Whether it holds so many ticks after the state began. */
static bool is_after(enum supervisor_condition condition, enum supervisor_state state,
                     uint32_t ticks)
{
    supervisor.state = state;
    supervisor.since_tick = NOW - ticks;
    return is(condition);
}

/* Twice the last step, at most the time-out; no less in test mode or where none was timed yet. */
START_TEST(steps_have_stopped_when_none_came_for_two)
{
    static const struct {
        real engage_steps;
        uint32_t step_ticks, longest;
    } cases[] = {{REAL(4.0), 600, 1200}, {REAL(4.0), 749, 1498}, {REAL(4.0), 751, 1500},
                 {REAL(4.0), 0, 1500},   {REAL(0.0), 600, 1500}, {REAL(4.0), 10, 20}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setup();
        params.engage_steps = cases[i].engage_steps;
        steps.step_ticks[0] = cases[i].step_ticks;
        steps.known_tick = NOW - cases[i].longest;
        ck_assert_msg(is(SUPERVISOR_IF_STEPPING), "case %zu", i);
        ck_assert(is(SUPERVISOR_IF_STEADY));
        steps.known_tick--;
        ck_assert_msg(!is(SUPERVISOR_IF_STEPPING), "case %zu", i);
        ck_assert(!is(SUPERVISOR_IF_STEADY));
    }
    setup();
    steps.seen = false;
    ck_assert(!is(SUPERVISOR_IF_STEPPING));
    setup();
    checks.standstill_ticks = 499;
    ck_assert(is(SUPERVISOR_IF_STEPPING) && !is(SUPERVISOR_IF_STANDSTILL));
    checks.standstill_ticks = 500;
    ck_assert(!is(SUPERVISOR_IF_STEPPING) && is(SUPERVISOR_IF_STANDSTILL));
}
END_TEST

START_TEST(so_many_steady_steps_are_asked_for)
{
    steps.steady = 3;
    ck_assert(!is(SUPERVISOR_IF_STEADY));
    steps.steady = 4;
    ck_assert(is(SUPERVISOR_IF_STEADY));
    params.engage_steps = REAL(0.0); /* test mode: one step of any kind */
    steps.steady = 0;
    ck_assert(is(SUPERVISOR_IF_STEADY));
    steps.seen = false;
    ck_assert(!is(SUPERVISOR_IF_STEADY));
}
END_TEST

START_TEST(irregular_steps_or_pushes_that_fail_end_a_walk)
{
    steps.unsteady = STEP_MONITOR_IRREGULAR - 1;
    ck_assert(is(SUPERVISOR_IF_REGULAR));
    steps.unsteady = STEP_MONITOR_IRREGULAR;
    ck_assert(!is(SUPERVISOR_IF_REGULAR));
    steps.unsteady = 0;
    view.pushes_fail = true;
    ck_assert(!is(SUPERVISOR_IF_REGULAR));
    steps.unsteady = STEP_MONITOR_IRREGULAR;
    params.engage_steps = REAL(0.0);
    ck_assert(is(SUPERVISOR_IF_REGULAR));
}
END_TEST

/* Five times the unload time for the self test; 60 s to set off, 10 s in test mode; else the unload time. */
START_TEST(each_state_has_its_time)
{
    static const struct {
        enum supervisor_state state;
        real engage_steps;
        uint32_t ticks;
    } cases[] = {{SUPERVISOR_SELF_TEST, REAL(4.0), 2500},
                 {SUPERVISOR_ENGAGING, REAL(4.0), 60000},
                 {SUPERVISOR_ENGAGING, REAL(0.0), 10000},
                 {SUPERVISOR_UNLOADING, REAL(4.0), 500},
                 {SUPERVISOR_INIT, REAL(4.0), 500}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        params.engage_steps = cases[i].engage_steps;
        ck_assert(!is_after(SUPERVISOR_IF_TIMEOUT, cases[i].state, cases[i].ticks - 1));
        ck_assert(is_after(SUPERVISOR_IF_TIMEOUT, cases[i].state, cases[i].ticks));
    }
}
END_TEST

/* 200 ms at least, both references at zero within the tolerance, and both motors. */
START_TEST(springs_are_unloaded_when_references_and_motors_are_back)
{
    ck_assert(!is_after(SUPERVISOR_IF_UNLOADED, SUPERVISOR_UNLOADING, 199));
    ck_assert(is_after(SUPERVISOR_IF_UNLOADED, SUPERVISOR_UNLOADING, 200));
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            sea[side].position_m = (real)(sign * 0.00099);
            ck_assert(is(SUPERVISOR_IF_UNLOADED));
            sea[side].position_m = (real)(sign * 0.00101);
            ck_assert(!is(SUPERVISOR_IF_UNLOADED));
            sea[side].position_m = REAL(0.0);
            input.sea[side].precompression_m = (real)(sign * 0.00101);
            ck_assert(!is(SUPERVISOR_IF_UNLOADED));
            ck_assert(!is(SUPERVISOR_IF_PLAUSIBLE));
            input.sea[side].precompression_m = REAL(0.0);
        }
    }
    ck_assert(is(SUPERVISOR_IF_UNLOADED));
}
END_TEST

/* A drive rests for 50 ms in STANDBY before it is enabled again; in other states nobody waits for that. */
START_TEST(drives_rest_for_50_ms_in_standby)
{
    ck_assert(!is_after(SUPERVISOR_IF_PLAUSIBLE, SUPERVISOR_STANDBY, 49));
    ck_assert(is_after(SUPERVISOR_IF_PLAUSIBLE, SUPERVISOR_STANDBY, 50));
    ck_assert(is_after(SUPERVISOR_IF_PLAUSIBLE, SUPERVISOR_SELF_TEST, 0));
    const uint16_t bits = conditions_find(&supervisor, &view, SUPERVISOR_FAULT_DRIVE);
    ck_assert((bits & SUPERVISOR_IF_FAULT) != 0);
    ck_assert((bits & SUPERVISOR_IF_PLAUSIBLE) == 0);
    ck_assert(!is(SUPERVISOR_IF_FAULT));
}
END_TEST

START_TEST(what_is_told_is_passed_on)
{
    ck_assert(is(SUPERVISOR_IF_NODES));
    input.nodes_operational = false;
    ck_assert(!is(SUPERVISOR_IF_NODES));
    input.node_error = true; /* need not be waited for */
    ck_assert(is(SUPERVISOR_IF_NODES));
    ck_assert(is(SUPERVISOR_IF_WALK_REQUESTED));
    view.walk_wanted = false;
    ck_assert(!is(SUPERVISOR_IF_WALK_REQUESTED));
    ck_assert(!is(SUPERVISOR_IF_MOTION_REQUESTED));
    view.motion_requested = true;
    ck_assert(is(SUPERVISOR_IF_MOTION_REQUESTED));
    ck_assert(!is(SUPERVISOR_IF_RESET));
    input.reset_requested = true;
    ck_assert(is(SUPERVISOR_IF_RESET));
    ck_assert(!is(SUPERVISOR_IF_LATCHED)); /* that is the supervisor's own */
    for (int side = 0; side < SIDE_COUNT; side++) {
        input.sea[side].state = DRIVE_ENABLED;
        input.sea[1 - side].state = DRIVE_STARTING;
        ck_assert(!is(SUPERVISOR_IF_ENABLED));
    }
    input.sea[SIDE_LEFT].state = input.sea[SIDE_RIGHT].state = DRIVE_ENABLED;
    ck_assert(is(SUPERVISOR_IF_ENABLED));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("conditions");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, steps_have_stopped_when_none_came_for_two);
    tcase_add_test(tests, so_many_steady_steps_are_asked_for);
    tcase_add_test(tests, irregular_steps_or_pushes_that_fail_end_a_walk);
    tcase_add_test(tests, each_state_has_its_time);
    tcase_add_test(tests, springs_are_unloaded_when_references_and_motors_are_back);
    tcase_add_test(tests, drives_rest_for_50_ms_in_standby);
    tcase_add_test(tests, what_is_told_is_passed_on);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
