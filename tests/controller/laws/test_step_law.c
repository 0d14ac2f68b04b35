/* Every law in float against the return map: eq. (16) against the formula, the others by the walks
 * they make. The map here is the accurate one in no way shared with the law's own large steps. */
#include "controller/laws/step_law.h"

#include <math.h>
#include <string.h>

#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

static struct control_params params;
static struct walker walker;

static void make_params(void)
{
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_msg(subject_control_params(&subject, &params, message) == 0, "%s", message);
    const struct walker_params body = walker_paper_params();
    ck_assert_int_eq(walker_init(&walker, &body), WALKER_OK);
}

static struct apex_estimate steady(float speed, float *r0)
{
    struct gait_branch_point gait;
    (void)gait_branch_at(params.branch, speed, &gait);
    *r0 = gait.r0_m;
    return (struct apex_estimate){-speed, gait.swing_angle_rad, gait.swing_rate_rad_s, 1.0f};
}

/* Walks from one steady gait with another's speed wanted; returns the number of steps from which on the
 * speed stays within 1 %, or -1 when the walker falls. */
static int walk(enum law_mode mode, float from, float to, int steps, struct step_law *law)
{
    struct control_params p = params;
    const struct stride_settings fine = stride_settings_fixed(&walker, 0.002f);
    float r0;
    struct apex_estimate apex = steady(from, &r0);
    int settled = 0;
    p.law = (float)mode;
    p.start_r0_m = r0;
    p.speed_ramp_rad_s = 1.0f;
    ck_assert_int_eq(control_params_validate(&p), CONTROL_PARAMS_OK);
    step_law_init(law, &p);
    for (int k = 1; k <= steps; k++) {
        struct stride_result result;
        int calls = 0;
        (void)step_law_update(law, &p, &apex, to);
        while (!law->is_final) {
            (void)step_law_work(law, &p);
            ck_assert_int_le(++calls, PREDICTIVE_UNITS);
        }
        ck_assert(law->r0_m >= p.r0_min_m && law->r0_m <= p.r0_max_m);
        const struct apex x = {apex.stance_rate_rad_s, apex.swing_angle_rad, apex.swing_rate_rad_s};
        if (stride(&walker, &fine, &x, law->r0_m, &result) != STRIDE_OK) {
            return -1;
        }
        apex = (struct apex_estimate){result.next.stance_rate_rad_s, result.next.swing_angle_rad,
                                      result.next.swing_rate_rad_s, 1.0f};
        if (fabsf(-apex.stance_rate_rad_s - to) > 0.01f * to) {
            settled = k;
        }
    }
    return settled;
}

START_TEST(proportional_is_equation_16_to_the_bit)
{
    struct step_law law;
    struct control_params p = params;
    p.law = (float)LAW_PROPORTIONAL;
    step_law_init(&law, &p);
    float command = speed_table_speed(&p.table, p.start_r0_m), r0 = p.start_r0_m;
    for (int k = 0; k < 200; k++) {
        const float v = 0.4f + 0.3f * (float)k / 200.0f + 0.01f * (float)(k % 7), wanted = 0.7f;
        const struct apex_estimate apex = {-v, 99.0f, -99.0f, 0.0f}; /* the rest must not matter */
        const float step = wanted - command, ramp = p.speed_ramp_rad_s;
        command += step > ramp ? ramp : step < -ramp ? -ramp : step;
        float answer = speed_table_inverse(&p.table, command) - p.kp_m_s_rad * (command - v);
        const float change = answer - r0, most = p.r0_change_max_m;
        answer = r0 + (change > most ? most : change < -most ? -most : change);
        r0 = answer < p.r0_min_m ? p.r0_min_m : answer > p.r0_max_m ? p.r0_max_m : answer;
        const float got = step_law_update(&law, &p, &apex, wanted);
        ck_assert(law.is_final);
        ck_assert_mem_eq(&got, &r0, sizeof r0);
        ck_assert_mem_eq(&law.command_rad_s, &command, sizeof command);
    }
}
END_TEST

START_TEST(all_laws_hold_a_gait)
{
    static const enum law_mode modes[] = {LAW_PROPORTIONAL, LAW_DLQR, LAW_DEADBEAT, LAW_PREDICTIVE};
    struct step_law law;
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(walk(modes[i], 0.8f, 0.8f, 40, &law), 0);
        ck_assert_int_eq(walk(modes[i], 0.5f, 0.5f, 40, &law), 0);
    }
}
END_TEST

START_TEST(predictive_takes_every_jump)
{
    static const float speed[] = {0.2f, 0.4f, 0.6f, 0.8f, 1.0f};
    struct step_law law;
    for (int i = 0; i < 5; i++) {
        for (int j = 0; j < 5; j++) {
            const int settled = walk(LAW_PREDICTIVE, speed[i], speed[j], 60, &law);
            const int allowed = j < i ? 12 : 40;
            ck_assert_msg(settled >= 0, "fell from %g to %g", (double)speed[i], (double)speed[j]);
            ck_assert_msg(settled <= allowed, "%g to %g takes %d steps", (double)speed[i],
                          (double)speed[j], settled);
            ck_assert_int_eq(law.predictive.fallbacks, 0);
        }
    }
}
END_TEST

/* What the probe found and the law must beat: eq. (16) falls on jumps. */
START_TEST(equation_16_falls_on_jumps)
{
    struct step_law law;
    ck_assert_int_eq(walk(LAW_PROPORTIONAL, 0.4f, 0.6f, 60, &law), -1);
    ck_assert_int_eq(walk(LAW_PROPORTIONAL, 0.8f, 0.6f, 60, &law), -1);
}
END_TEST

START_TEST(an_answer_stands_at_every_moment)
{
    struct step_law law;
    struct control_params p = params;
    float r0;
    const struct apex_estimate apex = steady(0.6f, &r0);
    p.law = (float)LAW_PREDICTIVE;
    p.start_r0_m = r0;
    for (int calls = 0; calls < PREDICTIVE_UNITS; calls++) {
        step_law_init(&law, &p);
        (void)step_law_update(&law, &p, &apex, 0.6f);
        for (int i = 0; i < calls; i++) {
            (void)step_law_work(&law, &p);
        }
        step_law_finish(&law, &params);
        ck_assert(law.is_final);
        assert_close(law.r0_m, r0, 0.002,
                     0.0); /* in the steady gait eq. (16) and the search agree */
    }
}
END_TEST

/* A walker that does not do what the model says: eq. (16) takes over, and gives back. */
START_TEST(wrong_predictions_hand_over_to_equation_16)
{
    struct step_law law;
    struct control_params p = params;
    float r0;
    struct apex_estimate apex = steady(0.6f, &r0);
    p.law = (float)LAW_PREDICTIVE;
    p.start_r0_m = r0;
    step_law_init(&law, &p);
    int handed_over = 0;
    for (int k = 0; k < 20; k++) {
        apex.stance_rate_rad_s = k % 2 ? -0.2f : -1.1f;
        (void)step_law_update(&law, &p, &apex, 0.6f);
        while (!law.is_final) {
            (void)step_law_work(&law, &p);
        }
        handed_over += law.used_fallback;
    }
    ck_assert(!predictive_search_is_reliable(&law.predictive));
    ck_assert_int_ge(handed_over, 10);
    apex = steady(0.6f, &r0);
    const struct stride_settings fine = stride_settings_fixed(&walker, 0.002f);
    for (int k = 0; k < 60; k++) {
        struct stride_result result;
        const struct apex x = {apex.stance_rate_rad_s, apex.swing_angle_rad, apex.swing_rate_rad_s};
        (void)step_law_update(&law, &p, &apex, 0.6f);
        while (!law.is_final) {
            (void)step_law_work(&law, &p);
        }
        if (stride(&walker, &fine, &x, law.r0_m, &result) != STRIDE_OK) {
            apex = steady(0.6f, &r0); /* a fresh start */
            continue;
        }
        apex = (struct apex_estimate){result.next.stance_rate_rad_s, result.next.swing_angle_rad,
                                      result.next.swing_rate_rad_s, 1.0f};
    }
    ck_assert(predictive_search_is_reliable(&law.predictive));
    ck_assert(!law.used_fallback);
}
END_TEST

START_TEST(bad_numbers_leave_the_answer_standing)
{
    struct step_law law;
    struct control_params p = params;
    for (int mode = 0; mode <= LAW_PREDICTIVE; mode++) {
        p.law = (float)mode;
        step_law_init(&law, &p);
        const float before = law.r0_m;
        const struct apex_estimate bad = {NAN, NAN, NAN, 0.0f}, strange = {5.0f, 9.0f, -3.0f, 0.0f};
        ck_assert(step_law_update(&law, &p, &bad, 0.6f) == before);
        ck_assert(law.is_final);
        ck_assert(step_law_update(&law, &p, &strange, INFINITY) == before);
        (void)step_law_update(&law, &p, &strange, 0.6f);
        for (int i = 0; i < PREDICTIVE_UNITS; i++) {
            (void)step_law_work(&law, &p);
        }
        ck_assert(law.is_final);
        ck_assert(law.r0_m >= p.r0_min_m && law.r0_m <= p.r0_max_m);
    }
}
END_TEST

START_TEST(parameters_name_a_law_that_exists)
{
    struct control_params p = params;
    struct gait_branch branch = *params.branch;
    p.law = 0.0f;
    while (law_of((real)p.law) != NULL) {
        p.law += 1.0f;
    }
    ck_assert(p.law <= (float)LAW_LARGEST); /* a number in range that no law has */
    ck_assert_int_eq(control_params_validate(&p), CONTROL_PARAMS_LAW);
    p.law = (float)LAW_PREDICTIVE;
    ck_assert_int_eq(control_params_validate(&p), CONTROL_PARAMS_OK);
    p.branch = NULL;
    ck_assert_int_eq(control_params_validate(&p), CONTROL_PARAMS_BRANCH);
    p.branch = &branch;
    branch.count = 0;
    ck_assert_int_eq(control_params_validate(&p), CONTROL_PARAMS_BRANCH);
    branch = *params.branch;
    branch.point[7].cost[3] = NAN;
    ck_assert_int_eq(control_params_validate(&p), CONTROL_PARAMS_BRANCH);
    p.law = (float)LAW_PROPORTIONAL;
    ck_assert_int_eq(control_params_validate(&p), CONTROL_PARAMS_OK);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("step_law");
    TCase *tests = tcase_create("all");
    tcase_add_unchecked_fixture(tests, make_params, NULL);
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, proportional_is_equation_16_to_the_bit);
    tcase_add_test(tests, all_laws_hold_a_gait);
    tcase_add_test(tests, predictive_takes_every_jump);
    tcase_add_test(tests, equation_16_falls_on_jumps);
    tcase_add_test(tests, an_answer_stands_at_every_moment);
    tcase_add_test(tests, wrong_predictions_hand_over_to_equation_16);
    tcase_add_test(tests, bad_numbers_leave_the_answer_standing);
    tcase_add_test(tests, parameters_name_a_law_that_exists);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
