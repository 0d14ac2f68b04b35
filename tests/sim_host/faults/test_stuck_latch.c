/* One latch tells the same all the time, or does not open at all, in a simulated walk: within three of its
 * releases the controller unloads both springs and names the leg. The other leg's pushes go on meanwhile. */
#include "tests/support/injected_walk.h"

static struct loop loop;
static struct injector injector;

static struct control_task *task(void)
{
    return &loop.rig.task;
}

static void walk(bool person)
{
    injected_walk_prepare(&loop, NULL, person ? 4 : 0);
    injected_walk_begin(&injector, &loop, 14);
}

static uint32_t steps(void)
{
    return task()->controller.last_step.number;
}

/* What the drive tells from now on, whatever its latch does. */
static void tell(enum side side, bool holds)
{
    loop.nodes.drive[side].objects.latch_closed = holds ? 1 : 0;
    loop.nodes.drive[side].feedback.latch_holds = holds;
}

static const struct {
    enum side side;
    enum supervisor_fault fault;
} reports[] = {
    {SIDE_LEFT, SUPERVISOR_FAULT_LATCH_LEFT},
    {SIDE_RIGHT, SUPERVISOR_FAULT_LATCH_RIGHT},
};

/* It says closed. Three releases of one leg are six steps; two more, as the step that runs counts for
 * nothing. One that says open all the time is another fault (H33). */
START_TEST(a_report_that_never_changes_ends_the_walk)
{
    walk(true);
    const uint32_t from = steps();
    while (task()->output.fault == SUPERVISOR_FAULT_NONE && steps() < from + 20) {
        injector_tick(&injector);
        tell(reports[_i].side, true);
    }
    ck_assert_int_eq(task()->output.fault, reports[_i].fault);
    ck_assert_int_eq(task()->output.state, SUPERVISOR_UNLOADING);
    ck_assert_uint_le(steps() - from, 8);
    ck_assert_uint_ge(steps() - from, 4);
}
END_TEST

START_TEST(latches_that_work_are_no_fault)
{
    walk(_i == 1);
    const uint32_t from = steps();
    while (steps() < from + 60 && task()->output.state == SUPERVISOR_WALKING) {
        injector_tick(&injector);
        for (int side = 0; side < SIDE_COUNT; side++) {
            const struct push_watch *watch = &task()->controller.springs.watch;
            ck_assert_uint_eq(watch->leg[side].unchanged_in_row, 0);
        }
    }
    ck_assert_uint_eq(steps(), from + 60);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stuck_latch");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 120);
    tcase_add_loop_test(tests, a_report_that_never_changes_ends_the_walk, 0,
                        (int)(sizeof reports / sizeof reports[0]));
    tcase_add_loop_test(tests, latches_that_work_are_no_fault, 0, 2);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
