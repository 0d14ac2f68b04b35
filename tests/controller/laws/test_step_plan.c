/* The plan of a step: how much of the law's answer is given, and by how much that may change from step to step. */
#include "controller/laws/step_plan.h"

#include <string.h>

#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

static struct control_params params;
static struct step_plan plan;
static struct gait_state gait;
static struct step_record step;

static void setup(void)
{
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    params.law = (real)LAW_PROPORTIONAL;
    params.r0_change_max_m = (real)0.002;
    memset(&plan, 0, sizeof plan);
    memset(&gait, 0, sizeof gait);
    memset(&step, 0, sizeof step);
    step_plan_bear(&plan, (real)1.0);
    step_plan_begin(&plan, &params);
}

/* An apex at this speed; eq. (16) answers at once. */
static struct step_decision apex(double speed_rad_s)
{
    gait.event[GAIT_APEX] = (struct gait_event){.happened = true, .speed_rad_s = (real)speed_rad_s};
    gait.apex = (struct apex_estimate){.stance_rate_rad_s = (real)-speed_rad_s};
    return step_plan_update(&plan, &params, &gait, (real)speed_rad_s, &step);
}

static double start_speed(void)
{
    return (double)speed_table_speed(&params.table, params.start_r0_m);
}

START_TEST(a_walk_begins_with_the_law_from_its_start)
{
    (void)apex(start_speed());
    (void)apex(start_speed());
    ck_assert_uint_eq(plan.law.steps, 2);
    plan.law.r0_m = (real)0.07;
    step_plan_begin(&plan, &params);
    ck_assert_uint_eq(plan.law.steps, 0);
    assert_close((double)plan.law.r0_m, (double)params.start_r0_m, 0.0, 0.0);
}
END_TEST

/* The drives bear a fifth at once: the push falls by no more than the law may change it, step after step. */
START_TEST(what_is_given_changes_no_faster_than_the_law_may)
{
    ck_assert(apex(start_speed()).new_step);
    const double first_m = (double)step.r0_m;
    assert_close(first_m, (double)params.start_r0_m, 1e-4, 0.0);
    step_plan_bear(&plan, (real)0.2);
    for (int k = 1; k <= 3; k++) {
        ck_assert(apex(start_speed()).new_step);
        assert_close((double)step.r0_m, first_m - 0.002 * k, 1e-6, 0.0);
    }
    step_plan_bear(&plan, (real)1.0);
    ck_assert(apex(start_speed()).new_step);
    assert_close((double)step.r0_m, first_m - 0.004, 1e-6, 0.0);
}
END_TEST

/* The first step of a walk has none before it. */
START_TEST(a_walk_s_first_step_is_given_whole)
{
    (void)apex(start_speed());
    (void)apex(start_speed());
    step.r0_m = (real)0.0;
    step_plan_begin(&plan, &params);
    ck_assert(apex(start_speed()).new_step);
    ck_assert_uint_eq(step.number, 1);
    assert_close((double)step.r0_m, (double)params.start_r0_m, 1e-4, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("step_plan");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, a_walk_begins_with_the_law_from_its_start);
    tcase_add_test(tests, what_is_given_changes_no_faster_than_the_law_may);
    tcase_add_test(tests, a_walk_s_first_step_is_given_whole);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
