/* Every limit of the parameters, from both sides: of each field by the table of ranges, of the
 * fields against each other and of the tables by what their headers say. */
#include "controller/control_params.h"

#include <math.h>
#include <string.h>

#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

static struct control_params params; /* good ones, with a branch, before every test */
static struct gait_branch branch;    /* a copy that a test may spoil */

static void setup(void)
{
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_msg(subject_control_params(&subject, &params, message) == 0, "%s", message);
    ck_assert_ptr_nonnull(params.branch);
    branch = *params.branch;
    params.branch = &branch;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
}

static real *field(int i)
{
    return (real *)((char *)&params + control_param_descriptors[i].offset);
}

START_TEST(each_field_is_held_to_its_range)
{
    const struct control_param_descriptor *d = &control_param_descriptors[_i];
    *field(_i) = nextafterf(d->minimum, -INFINITY);
    ck_assert_int_eq(control_params_validate(&params), _i);
    *field(_i) = nextafterf(d->maximum, INFINITY);
    ck_assert_int_eq(control_params_validate(&params), _i);
    *field(_i) = NAN;
    ck_assert_int_eq(control_params_validate(&params), _i);
    *field(_i) = INFINITY;
    ck_assert_int_eq(control_params_validate(&params), _i);
    *field(_i) = d->minimum; /* the ends belong to the range: whatever else is wrong then */
    ck_assert_int_ne(control_params_validate(&params), _i);
    *field(_i) = d->maximum;
    ck_assert_int_ne(control_params_validate(&params), _i);
}
END_TEST

START_TEST(fields_are_held_to_each_other)
{
    const struct control_params good = params;
    params.start_r0_m = nextafterf(params.r0_min_m, 0.0f);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_R0_ORDER);
    params.start_r0_m = params.r0_min_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params = good;
    params.start_r0_m = nextafterf(params.r0_max_m, 1.0f);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_R0_ORDER);
    params.start_r0_m = params.r0_max_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params = good;
    params.r0_ceiling_m = 0.0f; /* none is locked */
    params.r0_max_m = 0.401f * params.leg_length_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_R0_STROKE);
    params.r0_max_m = 0.399f * params.leg_length_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
}
END_TEST

/* What is locked for a person holds for whoever set the parameters; 0 locks nothing. */
START_TEST(what_is_locked_for_a_person_holds)
{
    const struct control_params good = params;
    params.kp_low_m_s_rad = 0.5f * params.kp_m_s_rad;
    params.kp_high_m_s_rad = params.kp_m_s_rad;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.kp_m_s_rad = nextafterf(params.kp_high_m_s_rad, 1.0f);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_GAIN);
    params.kp_m_s_rad = nextafterf(params.kp_low_m_s_rad, 0.0f);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_GAIN);
    params.kp_low_m_s_rad = params.kp_high_m_s_rad = 0.0f;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params = good;
    params.r0_ceiling_m = params.r0_max_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.r0_ceiling_m = nextafterf(params.r0_max_m, 0.0f);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_R0_CEILING);
    params.r0_ceiling_m = 0.0f;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.r0_change_ceiling_m = params.r0_change_max_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.r0_change_ceiling_m = nextafterf(params.r0_change_max_m, 0.0f);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_R0_CHANGE_CEILING);
    params.r0_change_ceiling_m = 0.0f;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
}
END_TEST

START_TEST(a_gain_range_has_its_ends_in_order)
{
    params.kp_m_s_rad = params.kp_low_m_s_rad = 0.04f;
    params.kp_high_m_s_rad = 0.04f;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.kp_high_m_s_rad = 0.039f;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_GAIN_RANGE);
    params.kp_m_s_rad = params.kp_low_m_s_rad = 0.0f;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
}
END_TEST

START_TEST(an_open_loop_push_off_is_held_to_the_limits_of_all_others)
{
    params.open_loop_r0_m = 0.99f * params.r0_min_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK); /* no law asks for it */
    params.law = (real)LAW_OPEN_LOOP;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OPEN_LOOP);
    params.open_loop_r0_m = params.r0_min_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.open_loop_r0_m = params.r0_max_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.open_loop_r0_m = 1.01f * params.r0_max_m;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OPEN_LOOP);
}
END_TEST

START_TEST(a_law_is_one_that_there_is_and_has_what_it_needs)
{
    static const struct {
        real law;
        bool is_one, needs_branch;
    } laws[] = {{0, true, false}, {1, true, false}, {2, true, true},      {3, true, true},
                {4, true, true},  {8, true, false}, {0.5f, false, false}, {2.5f, false, false}};
    params.open_loop_r0_m = params.start_r0_m;
    for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
        params.law = laws[i].law;
        params.branch = &branch;
        ck_assert_int_eq(control_params_validate(&params),
                         laws[i].is_one ? CONTROL_PARAMS_OK : CONTROL_PARAMS_LAW);
        params.branch = NULL;
        ck_assert_int_eq(control_params_validate(&params), !laws[i].is_one ? CONTROL_PARAMS_LAW
                                                           : laws[i].needs_branch
                                                               ? CONTROL_PARAMS_BRANCH
                                                               : CONTROL_PARAMS_OK);
    }
    branch.count = 3;
    params.branch = &branch;
    params.law = (real)LAW_DLQR;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_BRANCH);
}
END_TEST

/* The table's speeds at r0_min and at 95 % of r0_max; a law that knows a branch of gaits walks none
 * outside it. */
START_TEST(a_law_serves_the_speeds_whose_gaits_it_knows)
{
    real low, high, table_low, table_high;
    control_params_speeds(&params, &table_low, &table_high);
    assert_close(table_low, speed_table_speed(&params.table, params.r0_min_m), 0, 1e-6);
    assert_close(table_high, speed_table_speed(&params.table, 0.95f * params.r0_max_m), 0, 1e-6);
    params.law = (real)LAW_PREDICTIVE;
    params.branch = &branch;
    branch.count = 4;
    branch.speed_min_rad_s = 0.5f * table_low; /* beyond the table at either end */
    branch.speed_step_rad_s = table_high;
    control_params_speeds(&params, &low, &high);
    ck_assert(low == table_low && high == table_high);
    branch.speed_min_rad_s = table_low + 0.1f; /* within it */
    branch.speed_step_rad_s = 0.02f;
    control_params_speeds(&params, &low, &high);
    assert_close(low, table_low + 0.1f, 0, 1e-6);
    assert_close(high, table_low + 0.1f + 3 * 0.02f, 0, 1e-6);
}
END_TEST

START_TEST(a_speed_table_is_checked)
{
    struct speed_table *table = &params.table;
    const struct speed_table good = *table;
    table->count = 3;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_BAD_TABLE);
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_BAD_COUNT);
    table->count = SPEED_TABLE_MAX + 1;
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_BAD_COUNT);
    table->count = 4;
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_OK);
    static const real bad_grid[] = {0.0f, -0.01f, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        *table = good;
        table->r0_min_m = bad_grid[i];
        ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_BAD_GRID);
        *table = good;
        table->r0_step_m = bad_grid[i];
        ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_BAD_GRID);
    }
    *table = good;
    table->speed_rad_s[2] = table->speed_rad_s[1]; /* not rising is as bad as falling */
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_NOT_RISING);
    table->speed_rad_s[2] = NAN;
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_NOT_RISING);
    *table = good;
    table->speed_rad_s[table->count - 1] = INFINITY;
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_NOT_RISING);
    *table = good;
    table->speed_rad_s[0] = 0.0f;
    ck_assert_int_eq(speed_table_check(table), SPEED_TABLE_NOT_RISING);
}
END_TEST

/* Each number of a branch's head is positive and finite, but the weight of a push-off may be 0. */
START_TEST(the_head_of_a_branch_is_checked)
{
    real *const head[] = {&branch.speed_min_rad_s, &branch.speed_step_rad_s, &branch.travel_weight,
                          &branch.r0_weight};
    ck_assert_int_eq(gait_branch_check(&branch), 1);
    for (int i = 0; i < 4; i++) {
        const real good = *head[i];
        const real bad[] = {-1e-6f, NAN, INFINITY};
        for (int k = 0; k < 3; k++) {
            *head[i] = bad[k];
            ck_assert_int_eq(gait_branch_check(&branch), 0);
        }
        *head[i] = 0.0f;
        ck_assert_int_eq(gait_branch_check(&branch), head[i] == &branch.r0_weight ? 1 : 0);
        *head[i] = good;
    }
    branch.count = GAIT_BRANCH_MIN - 1;
    ck_assert_int_eq(gait_branch_check(&branch), 0);
    branch.count = GAIT_BRANCH_MIN;
    ck_assert_int_eq(gait_branch_check(&branch), 1);
    branch.count = GAIT_BRANCH_MAX + 1;
    ck_assert_int_eq(gait_branch_check(&branch), 0);
}
END_TEST

START_TEST(each_gait_of_a_branch_is_checked)
{
    struct gait_branch_point *point = &branch.point[branch.count / 2];
    const struct gait_branch_point good = *point;
    real *const numbers[] = {&point->r0_m,        &point->swing_angle_rad, &point->swing_rate_rad_s,
                             &point->cost[0],     &point->cost[5],         &point->lqr_gain[0],
                             &point->lqr_gain[2], &point->deadbeat_gain[2]};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        *numbers[i] = NAN;
        ck_assert_int_eq(gait_branch_check(&branch), 0);
        *point = good;
    }
    point->cost[0] = 0.0f; /* the cost of a speed that is off is never nothing */
    ck_assert_int_eq(gait_branch_check(&branch), 0);
    *point = good;
    point->r0_m = point[-1].r0_m;
    ck_assert_int_eq(gait_branch_check(&branch), 0);
    *point = good;
    branch.point[0].r0_m = 0.0f;
    ck_assert_int_eq(gait_branch_check(&branch), 0);
}
END_TEST

/* At an entry's speed the gait is the entry; beyond the ends it is the last one. */
START_TEST(a_branch_gives_its_entries_and_holds_its_ends)
{
    struct gait_branch_point gait;
    const real step = branch.speed_step_rad_s, low = branch.speed_min_rad_s;
    for (uint32_t i = 0; i < branch.count; i++) {
        const real speed = low + (real)i * step;
        assert_close(gait_branch_at(&branch, speed, &gait), speed, 1e-6, 0);
        assert_close(gait.r0_m, branch.point[i].r0_m, 1e-6, 1e-5);
        assert_close(gait.swing_angle_rad, branch.point[i].swing_angle_rad, 1e-5, 1e-5);
        assert_close(gait.cost[0], branch.point[i].cost[0], 1e-5, 1e-3);
    }
    const real last = low + (real)(branch.count - 1) * step;
    assert_close(gait_branch_at(&branch, last + 10.0f, &gait), last, 1e-6, 0);
    assert_close(gait.r0_m, branch.point[branch.count - 1].r0_m, 1e-6, 1e-5);
    assert_close(gait_branch_at(&branch, 0.0f, &gait), low, 1e-6, 0);
    assert_close(gait.r0_m, branch.point[0].r0_m, 1e-6, 1e-5);
}
END_TEST

/* A table may rise although the cubic through it does not everywhere: entries far apart, then close.
 * What comes back lies within the interval, and no search runs away. */
START_TEST(the_inverse_stays_in_its_interval_where_the_cubic_falls)
{
    const struct speed_table table = {
        .count = 4, .r0_min_m = 0.1f, .r0_step_m = 0.1f, .speed_rad_s = {0.1f, 1.0f, 1.001f, 3.0f}};
    ck_assert_int_eq(speed_table_check(&table), SPEED_TABLE_OK);
    for (int i = 0; i <= 100; i++) {
        const real speed = 1.0f + 0.001f * (real)i / 100.0f;
        const real r0 = speed_table_inverse(&table, speed);
        ck_assert(r0 >= 0.2f - 1e-6f && r0 <= 0.3f + 1e-6f);
    }
}
END_TEST

/* A person is never loaded from the first step: assistance needs steady steps before it, at least one. The bench
 * (engage_steps 0) is the compass walker's, which a hand holds. */
START_TEST(a_person_needs_steps_before_assistance)
{
    params.engage_steps = REAL(0.0);
    params.body = (real)BODY_COMPASS;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
    params.body = (real)BODY_PERSON;
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_ENGAGE);
    params.engage_steps = REAL(0.5);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_ENGAGE);
    params.engage_steps = REAL(1.0);
    ck_assert_int_eq(control_params_validate(&params), CONTROL_PARAMS_OK);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("control_params");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_loop_test(tests, each_field_is_held_to_its_range, 0, CONTROL_PARAM_COUNT);
    tcase_add_test(tests, fields_are_held_to_each_other);
    tcase_add_test(tests, what_is_locked_for_a_person_holds);
    tcase_add_test(tests, a_gain_range_has_its_ends_in_order);
    tcase_add_test(tests, an_open_loop_push_off_is_held_to_the_limits_of_all_others);
    tcase_add_test(tests, a_law_is_one_that_there_is_and_has_what_it_needs);
    tcase_add_test(tests, a_law_serves_the_speeds_whose_gaits_it_knows);
    tcase_add_test(tests, a_speed_table_is_checked);
    tcase_add_test(tests, the_head_of_a_branch_is_checked);
    tcase_add_test(tests, each_gait_of_a_branch_is_checked);
    tcase_add_test(tests, a_branch_gives_its_entries_and_holds_its_ends);
    tcase_add_test(tests, the_inverse_stays_in_its_interval_where_the_cubic_falls);
    tcase_add_test(tests, a_person_needs_steps_before_assistance);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
