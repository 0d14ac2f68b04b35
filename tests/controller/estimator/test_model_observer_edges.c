/* Where the observer that carries the model along must give it up, as its interface says: what
 * cannot be recalled, what is no number, a lift-off that the chain's motion does not explain. */
#include "controller/estimator/model_observer.h"

#include <math.h>
#include <string.h>

#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

enum { TICK = 1000, WELL_INTO = TICK + MODEL_HISTORY };

static struct control_params params;
static struct model_observer observer;
static const real at_apex[SINGLE_SUPPORT_STATES] = {
    [STANCE_ANGLE] = 0.0f, [SWING_ANGLE] = -0.1f, [STANCE_RATE] = -0.8f, [SWING_RATE] = 1.5f};

static void setup(void)
{
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
}

static void reset(void)
{
    model_observer_init(&observer, &params);
}

static void begin(void)
{
    model_observer_begin(&observer, SIDE_LEFT, TICK, at_apex, 0.0f);
    ck_assert_int_eq(observer.phase, MODEL_SINGLE);
    for (int i = 0; i < MODEL_HISTORY; i++) { /* as if it had stood still so long */
        observer.history[i][STANCE_ANGLE] = -0.2f;
        observer.history[i][SWING_ANGLE] = 0.2f;
        observer.history[i][STANCE_RATE] = -0.8f;
        observer.history[i][SWING_RATE] = 0.5f;
    }
}

START_TEST(parameters_that_make_no_walker_leave_it_lost)
{
    params.leg_length_m = -1.0f;
    model_observer_init(&observer, &params);
    model_observer_begin(&observer, SIDE_LEFT, TICK, at_apex, 0.0f);
    ck_assert_int_eq(observer.phase, MODEL_LOST);
}
END_TEST

START_TEST(no_number_begins_nothing)
{
    for (int i = 0; i < SINGLE_SUPPORT_STATES; i++) {
        real state[SINGLE_SUPPORT_STATES] = {0.0f, 0.0f, 0.0f, 0.0f};
        state[i] = NAN;
        reset();
        model_observer_begin(&observer, SIDE_LEFT, TICK, state, 0.001f);
        ck_assert_int_eq(observer.phase, MODEL_LOST);
    }
}
END_TEST

/* A strike is looked up in the history: not before its begin, not beyond its end. */
START_TEST(a_strike_that_cannot_be_recalled_loses_it)
{
    static const struct {
        uint32_t tick;
        real age_s;
    } beyond[] = {{TICK + 1, 0.0f},     /* began just now */
                  {WELL_INTO, NAN},     /* no age */
                  {WELL_INTO, -0.01f},  /* in the future */
                  {WELL_INTO, 0.0315f}, /* 32 ticks are kept, two of them needed */
                  {TICK + 11, 0.010f}}; /* older than the single support */
    for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        reset();
        begin();
        model_observer_strike(&observer, beyond[i].tick, beyond[i].age_s, 0.05f);
        ck_assert_msg(observer.phase == MODEL_LOST, "case %zu", i);
    }
    reset();
    model_observer_strike(&observer, WELL_INTO, 0.001f, 0.05f); /* lost already */
    ck_assert_int_eq(observer.phase, MODEL_LOST);
    reset();
    begin();
    model_observer_strike(&observer, WELL_INTO, 0.001f, 0.05f);
    ck_assert_int_eq(observer.phase, MODEL_DOUBLE);
    /* The chord between the feet of legs 0.4 rad apart. */
    assert_close(observer.toe_distance_m, 2.0 * (double)params.leg_length_m * sin(0.2), 2e-3, 0.0);
}
END_TEST

/* A state of before it began is none: 10.5 ms ago is two ticks farther back than whole ones. */
START_TEST(the_oldest_strike_that_can_be_recalled)
{
    for (uint32_t ticks = 11; ticks <= 13; ticks++) {
        reset();
        begin();
        model_observer_strike(&observer, TICK + ticks, 0.0105f, 0.05f);
        ck_assert_int_eq(observer.phase, ticks < 12 ? MODEL_LOST : MODEL_DOUBLE);
    }
}
END_TEST

/* A single support that began right after power-on has a past like any other. */
START_TEST(a_strike_soon_after_power_on_is_recalled)
{
    for (uint32_t began = 0; began <= 10; began += 5) {
        reset();
        begin();
        observer.since_tick = began;
        model_observer_strike(&observer, 40, 0.001f, 0.05f);
        ck_assert_int_eq(observer.phase, MODEL_DOUBLE);
    }
}
END_TEST

/* Lift-off is where the ankle reaches its rest; it must be on its way there, and near. */
START_TEST(a_lift_off_that_the_motion_does_not_explain_loses_it)
{
    static const struct {
        real ankle_m, rate_m_s;
        enum model_phase phase;
    } cases[] = {{0.049f, 0.5f, MODEL_SINGLE}, /* 2 ms away */
                 {0.051f, 0.5f, MODEL_SINGLE}, /* 2 ms past */
                 {0.040f, 0.2f, MODEL_LOST},   /* 50 ms away */
                 {0.049f, 0.0f, MODEL_LOST},   /* it stands */
                 {0.049f, -0.5f, MODEL_LOST}}; /* it goes back */
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        reset();
        begin();
        model_observer_strike(&observer, WELL_INTO, 0.001f, 0.05f);
        ck_assert_int_eq(observer.phase, MODEL_DOUBLE);
        observer.ankle[ANKLE] = cases[i].ankle_m;
        observer.ankle[ANKLE_RATE] = cases[i].rate_m_s;
        model_observer_lift_off(&observer, WELL_INTO + 100, 0.05f);
        ck_assert_msg(observer.phase == cases[i].phase, "case %zu", i);
        if (observer.phase == MODEL_SINGLE) {
            ck_assert_int_eq(observer.stance, SIDE_RIGHT); /* the legs take turns */
            ck_assert_uint_eq(observer.since_tick, WELL_INTO + 100);
        }
    }
    reset();
    begin();
    model_observer_lift_off(&observer, WELL_INTO, 0.05f); /* of a foot that is not down */
    ck_assert_int_eq(observer.phase, MODEL_LOST);
}
END_TEST

/* A strike is looked up in what was kept of each tick: angles and rates, all as they were then. */
START_TEST(each_tick_s_state_is_kept_whole)
{
    struct controller_input input = {0};
    real seen[MODEL_HISTORY][SINGLE_SUPPORT_STATES];
    reset();
    begin();
    for (uint32_t i = 1; i < MODEL_HISTORY; i++) {
        input.tick = TICK + i;
        input.leg[SIDE_LEFT].leg_angle_rad = observer.state[STANCE_ANGLE];
        input.leg[SIDE_RIGHT].leg_angle_rad = observer.state[SWING_ANGLE];
        model_observer_advance(&observer, &input);
        ck_assert_int_eq(observer.phase, MODEL_SINGLE);
        memcpy(seen[i], observer.state, sizeof seen[i]);
    }
    for (uint32_t i = 1; i < MODEL_HISTORY; i++) {
        ck_assert_mem_eq(observer.history[(TICK + i) % MODEL_HISTORY], seen[i], sizeof seen[i]);
    }
    ck_assert(seen[20][STANCE_ANGLE] != seen[21][STANCE_ANGLE]);
}
END_TEST

/* A sample that is no number, in single and in double support: what it has spoiled is not kept. */
START_TEST(a_sample_that_is_no_number_loses_it)
{
    struct controller_input input = {.tick = TICK};
    for (int side = 0; side < SIDE_COUNT; side++) {
        reset();
        begin();
        input.tick = TICK + 1;
        input.leg[side].leg_angle_rad = NAN;
        model_observer_advance(&observer, &input);
        ck_assert_int_eq(observer.phase, MODEL_LOST);
        input.leg[side].leg_angle_rad = 0.0f;
    }
    reset();
    begin();
    model_observer_strike(&observer, WELL_INTO, 0.001f, 0.05f);
    ck_assert_int_eq(observer.phase, MODEL_DOUBLE);
    input.tick = WELL_INTO + 1;
    input.leg[SIDE_LEFT].ankle_extension_m = NAN;
    model_observer_advance(&observer, &input);
    ck_assert_int_eq(observer.phase, MODEL_LOST);
}
END_TEST

/* Feet 2 l sin 0.2 apart: no ankle is longer than that beyond its leg, or the hip's triangle does
 * not close. Gross, but no number is wrong: a loose strap, or a foot that has slipped. */
START_TEST(an_ankle_that_no_triangle_explains_loses_it)
{
    struct controller_input input = {.tick = WELL_INTO + 1};
    const real apart_m = 2.0f * params.leg_length_m * sinf(0.2f);
    for (int beyond = 0; beyond < 2; beyond++) {
        reset();
        begin();
        model_observer_strike(&observer, WELL_INTO, 0.001f, 0.05f);
        ck_assert_int_eq(observer.phase, MODEL_DOUBLE);
        observer.ankle[ANKLE] = 0.98f * apart_m;
        observer.ankle[ANKLE_RATE] = 0.0f;
        observer.behind_s = -0.001f; /* no time goes by: only the sample moves it, by 5.6 % */
        input.leg[SIDE_LEFT].ankle_extension_m = apart_m * (beyond != 0 ? 2.0f : 0.99f);
        model_observer_advance(&observer, &input);
        ck_assert(isfinite(observer.ankle[ANKLE]));
        ck_assert_int_eq(observer.phase, beyond != 0 ? MODEL_LOST : MODEL_DOUBLE);
    }
    reset();
    begin();
    model_observer_strike(&observer, WELL_INTO, 0.001f, 0.05f);
    observer.ankle[ANKLE_RATE] = 0.5f;
    model_observer_lift_off(&observer, WELL_INTO + 100,
                            1.02f * apart_m); /* nor does it end there */
    ck_assert_int_eq(observer.phase, MODEL_LOST);
}
END_TEST

/* Both feet in one place: there is no chord to stand on. */
START_TEST(a_strike_beside_the_other_foot_loses_it)
{
    reset();
    begin();
    for (int i = 0; i < MODEL_HISTORY; i++) {
        observer.history[i][STANCE_ANGLE] = observer.history[i][SWING_ANGLE] = 0.0f;
        observer.history[i][STANCE_RATE] = observer.history[i][SWING_RATE] = 0.0f;
    }
    model_observer_strike(&observer, WELL_INTO, 0.0f, 0.05f);
    ck_assert_int_eq(observer.phase, MODEL_LOST);
}
END_TEST

/* On level ground the strike is where theta_s + theta_n falls through 0; where the sum rises there is
 * no such moment near, and the detection's own counts. */
START_TEST(a_strike_of_a_rising_sum_is_when_it_was_detected)
{
    static const struct {
        real swing_rate_rad_s;
        double age_s;
    } cases[] = {{0.5f, 0.001 - 0.005}, /* 1 ms ago 1.5 mrad above 0, falling by 0.3 rad/s */
                 {0.9f, 0.0015},        /* rising */
                 {0.8f, 0.0015}};       /* or neither */
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        reset();
        begin();
        for (int k = 0; k < MODEL_HISTORY; k++) {
            observer.history[k][SWING_ANGLE] = 0.2015f;
            observer.history[k][SWING_RATE] = cases[i].swing_rate_rad_s;
        }
        model_observer_strike(&observer, WELL_INTO, 0.0015f, 0.05f);
        ck_assert_int_eq(observer.phase, MODEL_DOUBLE);
        assert_close(observer.behind_s, cases[i].age_s, 1e-5, 0.0);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("model_observer_edges");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 60.0);
    tcase_add_unchecked_fixture(tests, setup, NULL); /* its gaits take a while to find */
    tcase_add_test(tests, parameters_that_make_no_walker_leave_it_lost);
    tcase_add_test(tests, no_number_begins_nothing);
    tcase_add_test(tests, a_strike_that_cannot_be_recalled_loses_it);
    tcase_add_test(tests, a_lift_off_that_the_motion_does_not_explain_loses_it);
    tcase_add_test(tests, each_tick_s_state_is_kept_whole);
    tcase_add_test(tests, a_sample_that_is_no_number_loses_it);
    tcase_add_test(tests, an_ankle_that_no_triangle_explains_loses_it);
    tcase_add_test(tests, a_strike_beside_the_other_foot_loses_it);
    tcase_add_test(tests, a_strike_of_a_rising_sum_is_when_it_was_detected);
    tcase_add_test(tests, the_oldest_strike_that_can_be_recalled);
    tcase_add_test(tests, a_strike_soon_after_power_on_is_recalled);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
