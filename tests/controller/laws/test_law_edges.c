/* The law for a person against its formula in double (step_law.h), and every law where the apex
 * is no number, its walker is none, or nobody can walk as asked. */
#include <math.h>

#include "controller/laws/step_law.h"
#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

static struct control_params params;
static struct step_law law;

static void setup(void)
{
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
}

static real step(double speed_rad_s, double desired_rad_s)
{
    const struct apex_estimate apex = {(real)-speed_rad_s, 0.3f, -0.5f, 1.0f};
    return step_law_update(&law, &params, &apex, (real)desired_rad_s);
}

/* r0 = r0* - kp (m - v), m the mean of the steps before: of all, then over about the last 16. */
START_TEST(a_person_keeps_their_own_speed)
{
    params.law = (real)LAW_PERSON;
    params.start_r0_m = 0.04f;
    params.kp_m_s_rad = 0.02f;
    params.r0_change_max_m = 0.5f;
    step_law_init(&law, &params);
    double mean = 0.0, given = 0.0;
    for (int k = 1; k <= 400; k++) {
        const double v = 1.4 + 0.05 * sin(0.7 * k) + (k > 200 ? 0.02 : 0.0);
        mean = k == 1 ? v : mean;
        const double wanted = 0.04 - 0.02 * (mean - v);
        const real r0 = step(v, 0.1); /* whatever speed is asked for */
        assert_close(r0, wanted, 2e-7, 1e-5);
        assert_close(law.command_rad_s, mean, 0, 1e-5);
        ck_assert(law.is_final && !law.used_fallback);
        mean += (v - mean) / (k < 16 ? k : 16);
        given += k > 300 ? (double)r0 : 0.0;
    }
    assert_close(given / 100.0, 0.04, 2e-5, 0.0); /* over time what was prescribed */
}
END_TEST

/* Whatever they do, the energy of a push, which goes with r0^2, is at most 1.1 times the prescribed. */
START_TEST(a_persons_push_has_no_more_than_was_prescribed)
{
    params.law = (real)LAW_PERSON;
    params.start_r0_m = 0.04f;
    params.kp_m_s_rad = 1.0f;
    params.r0_max_m = 0.5f;
    params.r0_change_max_m = 0.5f;
    step_law_init(&law, &params);
    double most = 0.0;
    for (int k = 1; k <= 200; k++) {
        const double r0 = (double)step(k > 20 ? 1.4 * 1.3 : 1.4 + 0.2 * sin(2.0 * k), 0.1);
        most = fmax(most, r0);
    }
    ck_assert_msg(most * most <= 1.09 * 0.04 * 0.04 && most > 0.0411, "%g m", most);
}
END_TEST

START_TEST(a_persons_push_off_keeps_to_the_limits)
{
    params.law = (real)LAW_PERSON;
    params.start_r0_m = 0.04f;
    params.kp_m_s_rad = 1.0f;
    params.r0_min_m = 0.035f;
    params.r0_max_m = 0.05f;
    params.r0_change_max_m = 0.004f;
    step_law_init(&law, &params);
    real last = params.start_r0_m;
    for (int k = 1; k <= 200; k++) {
        const real r0 = step(1.4 + (k % 7 - 3) * 0.2, 1.0);
        ck_assert(r0 >= 0.035f && r0 <= 0.05f && fabsf(r0 - last) <= 0.0040001f);
        last = r0;
    }
}
END_TEST

/* A first apex that was no number is not the mean of anything. */
START_TEST(a_persons_mean_begins_with_a_number)
{
    params.law = (real)LAW_PERSON;
    step_law_init(&law, &params);
    ck_assert(step((double)NAN, 1.0) == params.start_r0_m);
    assert_close(step(1.4, 1.0), params.start_r0_m, 1e-7, 0);
    assert_close(law.command_rad_s, 1.4, 0, 1e-6);
}
END_TEST

START_TEST(what_is_no_number_leaves_the_last_answer)
{
    static const enum law_mode modes[] = {LAW_PROPORTIONAL, LAW_OPEN_LOOP,  LAW_DLQR,
                                          LAW_DEADBEAT,     LAW_PREDICTIVE, LAW_PERSON};
    params.law = (real)modes[_i];
    params.open_loop_r0_m = params.start_r0_m;
    step_law_init(&law, &params);
    const real r0 = step(0.45, 0.45);
    step_law_finish(&law, &params);
    const bool whole =
        modes[_i] == LAW_DLQR || modes[_i] == LAW_DEADBEAT || modes[_i] == LAW_PREDICTIVE;
    const struct apex_estimate no_angle = {-0.45f, NAN, -0.5f, 1.0f};
    const struct apex_estimate no_rate = {-0.45f, 0.3f, INFINITY, 1.0f};
    const real last = law.r0_m;
    ck_assert(isfinite(r0) && isfinite(last));
    ck_assert(step((double)NAN, 0.45) == last);
    ck_assert(step((double)INFINITY, 0.45) == last);
    ck_assert(step(0.45, (double)NAN) == last);
    ck_assert(law.is_final);
    ck_assert(!whole || step_law_update(&law, &params, &no_angle, 0.45f) == last);
    ck_assert(!whole || step_law_update(&law, &params, &no_rate, 0.45f) == last);
    ck_assert(law.is_final);
    law.steps = UINT32_MAX; /* after 136 years it still walks */
    ck_assert(isfinite(step(0.45, 0.45)));
    ck_assert_uint_eq(law.steps, UINT32_MAX);
}
END_TEST

/* Legs as heavy as the body: the model does not walk, the law is eq. (16). */
START_TEST(without_a_model_the_predictive_law_is_eq_16)
{
    params.law = (real)LAW_PREDICTIVE;
    params.leg_mass_kg = 10.0f * params.torso_mass_kg;
    params.r0_change_max_m = 0.5f;
    step_law_init(&law, &params);
    const real got = step(0.44, 0.45);
    ck_assert(law.is_final && law.used_fallback);
    ck_assert(!step_law_work(&law, &params));
    const real want = speed_table_inverse(&params.table, law.command_rad_s) -
                      params.kp_m_s_rad * (law.command_rad_s - 0.44f);
    assert_close(got, want, 1e-7, 0);
}
END_TEST

/* A failing memory may change the law's number before the checksum comes round: a law without long
 * work leaves the search alone, the answer can be made final, and no law at all means eq. (16). */
START_TEST(a_number_that_changes_in_mid_search_ends_well)
{
    params.law = (real)LAW_PREDICTIVE;
    params.r0_change_max_m = 0.5f;
    step_law_init(&law, &params);
    const real first = step(0.44, 0.45);
    ck_assert(!law.is_final);
    params.law = _i == 0 ? (real)LAW_PERSON : 6.5f;
    ck_assert(!step_law_work(&law, &params));
    step_law_finish(&law, &params);
    ck_assert(law.is_final && law.r0_m == first);
    if (_i != 0) {
        const real got = step(0.44, 0.45);
        const real want = speed_table_inverse(&params.table, law.command_rad_s) -
                          params.kp_m_s_rad * (law.command_rad_s - 0.44f);
        assert_close(got, want, 1e-7, 0);
    }
}
END_TEST

/* A branch with one number of one point that is none is no branch. */
START_TEST(each_number_of_a_branch_is_checked)
{
    static struct gait_branch branch;
    branch = *params.branch;
    ck_assert(gait_branch_check(&branch) != 0);
    real *const first = (real *)&branch.point[3];
    const size_t numbers = sizeof branch.point[3] / sizeof(real);
    for (size_t i = 0; i < numbers; i++) {
        const real before = first[i];
        first[i] = NAN;
        ck_assert_msg(gait_branch_check(&branch) == 0, "number %zu", i);
        first[i] = before;
    }
    ck_assert(gait_branch_check(&branch) != 0);
}
END_TEST

/* ---- the predictive law alone ------------------------------------------------------------- */

static struct predictive_search search;

/* From the steady gait of 0.45 rad/s a faster one is wanted; the motor stands at that gait's r0. */
static struct predictive_request faster(void)
{
    const struct walker_params body = {params.torso_mass_kg, params.leg_mass_kg,
                                       params.leg_length_m, params.spring_stiffness_n_m,
                                       params.gravity_m_s2};
    struct gait_branch_point gait;
    ck_assert_int_eq(predictive_search_init(&search, &body), 0);
    (void)gait_branch_at(params.branch, 0.45f, &gait);
    return (struct predictive_request){
        .apex = {-0.45f, gait.swing_angle_rad, gait.swing_rate_rad_s},
        .target_speed_rad_s = 0.55f,
        .r0_first_m = gait.r0_m + 0.01f,
        .r0_low_m = gait.r0_m - 0.02f,
        .r0_high_m = gait.r0_m + 0.02f,
        .r0_from_m = gait.r0_m,
        .motor_speed_m_s = params.sea_speed_max_m_s,
        .motor_acceleration_m_s2 = params.sea_acceleration_m_s2,
        .report_delay_s = 0.03f,
        .tick_s = 0.001f};
}

static int search_on(void)
{
    int units = 0;
    while (search.stage != PREDICTIVE_IDLE && units <= PREDICTIVE_UNITS) {
        (void)predictive_search_work(&search, params.branch);
        units++;
    }
    ck_assert_int_le(units, PREDICTIVE_UNITS);
    return units;
}

/* Told of the apex too late for the motor to move, it keeps where the motor is, and foretells that. */
START_TEST(without_time_to_move_the_motor_stays)
{
    struct predictive_request request = faster();
    predictive_search_begin(&search, params.branch, &request);
    (void)search_on();
    ck_assert(search.answered && search.r0_m > request.r0_from_m + 0.001f); /* in time it moves */
    request.report_delay_s = 1.0f;                                          /* a step lasts less */
    predictive_search_begin(&search, params.branch, &request);
    (void)search_on();
    ck_assert(search.answered && search.has_prediction);
    ck_assert(search.r0_m == request.r0_from_m);
    assert_close(search.predicted.stance_rate_rad_s, -0.45, 0, 0.01); /* the steady gait goes on */
}
END_TEST

/* The answer is final: more work changes nothing of it, and it is counted once. */
START_TEST(a_final_answer_stays)
{
    const struct predictive_request request = faster();
    predictive_search_begin(&search, params.branch, &request);
    predictive_search_finish(&search); /* before any work: the caller's own */
    ck_assert_uint_eq(search.fallbacks, 1);
    const struct predictive_search final = search;
    for (int i = 0; i < 3; i++) {
        ck_assert(!predictive_search_work(&search, params.branch));
        predictive_search_finish(&search);
    }
    ck_assert_mem_eq(&search, &final, sizeof final);
    ck_assert(search.r0_m == request.r0_first_m && !search.has_prediction);
}
END_TEST

/* A step of which nothing was foretold is no wrong prediction: distrust wears off, down to none. */
START_TEST(distrust_wears_off_where_nothing_was_foretold)
{
    const struct predictive_request request = faster();
    search.misprediction_count = PREDICTIVE_UNRELIABLE + 1;
    for (int k = PREDICTIVE_UNRELIABLE; k >= -3; k--) {
        ck_assert_int_eq(predictive_search_is_reliable(&search), k + 1 < PREDICTIVE_UNRELIABLE);
        predictive_search_begin(&search, params.branch, &request);
        ck_assert_uint_eq(search.misprediction_count, k > 0 ? (unsigned)k : 0u);
        predictive_search_finish(&search);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("law edges");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, a_person_keeps_their_own_speed);
    tcase_add_test(tests, a_persons_push_has_no_more_than_was_prescribed);
    tcase_add_test(tests, a_persons_push_off_keeps_to_the_limits);
    tcase_add_test(tests, a_persons_mean_begins_with_a_number);
    tcase_add_loop_test(tests, what_is_no_number_leaves_the_last_answer, 0, 6);
    tcase_add_test(tests, without_a_model_the_predictive_law_is_eq_16);
    tcase_add_loop_test(tests, a_number_that_changes_in_mid_search_ends_well, 0, 2);
    tcase_add_test(tests, each_number_of_a_branch_is_checked);
    tcase_add_test(tests, without_time_to_move_the_motor_stays);
    tcase_add_test(tests, a_final_answer_stays);
    tcase_add_test(tests, distrust_wears_off_where_nothing_was_foretold);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
