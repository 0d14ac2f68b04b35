/* Where the observer that carries the model along must give it up, as its interface says: what
 * cannot be recalled, what is no number, a lift-off that the chain's motion does not explain. */
#include "controller/model_observer.h"

#include <math.h>

#include "sim_host/host/subject.h"
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
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
