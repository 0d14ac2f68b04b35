/* The gait observer tick by tick on legs that are straight lines, so that every crossing is known:
 * what is an apex, whose it is, and what stands when the model has gone astray. */
#include "controller/estimator/gait_observer.h"

#include <math.h>

#include "sim_host/subjects/subject.h"
#include "tests/support/assert_close.h"

#define RATE_RAD_S 0.8

static struct control_params params;
static struct gait_observer observer;
static struct controller_input input;
static double angle[SIDE_COUNT], rate[SIDE_COUNT]; /* of the next tick; rad/s */
static int apexes;
static struct gait_event last_apex;

static void setup(void)
{
    struct subject subject;
    char message[SUBJECT_MESSAGE_MAX];
    subject_default(&subject);
    ck_assert_int_eq(subject_control_params(&subject, &params, message), 0);
    params.sensor_latency_s = 0.0f;
}

static void start(double left_rad, double right_rad)
{
    gait_observer_init(&observer, &params);
    input = (struct controller_input){.tick = 10000};
    angle[SIDE_LEFT] = left_rad;
    angle[SIDE_RIGHT] = right_rad;
    rate[SIDE_LEFT] = -RATE_RAD_S;
    rate[SIDE_RIGHT] = RATE_RAD_S;
    apexes = 0;
}

static void tick(void)
{
    input.tick++;
    for (int side = 0; side < SIDE_COUNT; side++) {
        input.leg[side].leg_angle_rad = (real)angle[side];
        angle[side] += 1e-3 * rate[side];
    }
    gait_observer_update(&observer, &params, &input);
    if (observer.state.event[GAIT_APEX].happened) {
        last_apex = observer.state.event[GAIT_APEX];
        apexes++;
    }
}

static void run(int ticks)
{
    for (int i = 0; i < ticks; i++) {
        tick();
    }
}

/* Legs together: nobody knows which one carries the body, and no push-off may come of it. */
START_TEST(legs_side_by_side_are_no_phase)
{
    start(0.004, -0.004);
    rate[SIDE_LEFT] = rate[SIDE_RIGHT] = 0.0;
    run(1000);
    ck_assert_int_eq(observer.state.phase, PHASE_UNKNOWN);
    ck_assert(!observer.state.strike_near);
    ck_assert_int_eq(apexes, 0);
    start(-0.1, 0.1); /* the leg in front carries the body next */
    run(1);
    ck_assert_int_eq(observer.state.phase, PHASE_SINGLE_SUPPORT);
    ck_assert_int_eq(observer.state.stance, SIDE_RIGHT);
}
END_TEST

/* Until the tick before the work on this leg's next apex begins. */
static void run_to_work(enum side side)
{
    for (int i = 0; i < 1000 && !observer.apex.apex_pending[side]; i++) {
        tick();
    }
    ck_assert(observer.apex.apex_pending[side]);
    run((int)observer.apex.window_ticks - 1);
}

/* The model goes along in this leg's single support, at this state. */
static void put_model(enum side stance, double angle_rad, double rate_rad_s)
{
    observer.model.phase = MODEL_SINGLE;
    observer.model.stance = stance;
    observer.model.since_tick = input.tick - 200;
    observer.model.off_ticks = 0;
    observer.model.state[STANCE_ANGLE] = (real)angle_rad;
    observer.model.state[STANCE_RATE] = (real)rate_rad_s;
    observer.model.state[SWING_ANGLE] = (real)angle[side_other(stance)];
    observer.model.state[SWING_RATE] = (real)RATE_RAD_S;
}

/* The one that falls back through the vertical is the one that stands, whatever was thought. */
START_TEST(the_leg_that_falls_back_is_the_stance_leg)
{
    start(0.12, 0.10); /* left in front: taken for the stance leg */
    rate[SIDE_LEFT] = 0.0;
    rate[SIDE_RIGHT] = -RATE_RAD_S;
    run(5);
    ck_assert_int_eq(observer.state.stance, SIDE_LEFT);
    run_to_work(SIDE_RIGHT);
    ck_assert_int_eq(observer.state.phase, PHASE_SINGLE_SUPPORT);
    ck_assert_int_eq(observer.state.stance, SIDE_RIGHT);
    ck_assert(observer.state.stance_past_apex && observer.state.strike_near);
    put_model(SIDE_LEFT, angle[SIDE_LEFT], -RATE_RAD_S);
    run(20);
    ck_assert_int_eq(apexes, 1); /* from the samples alone: the model was of the other leg */
    ck_assert_int_eq(last_apex.side, SIDE_RIGHT);
    ck_assert(!observer.apex.work.modelled && observer.state.apex.confidence == 0.0f);
    assert_close(last_apex.speed_rad_s, RATE_RAD_S, 0, 1e-4);
}
END_TEST

/* From double support, too: it was over without anybody noticing. */
START_TEST(an_apex_in_double_support_ends_it)
{
    start(0.05, -0.05);
    run(20);
    observer.state.phase = PHASE_DOUBLE_SUPPORT;
    observer.state.stance = SIDE_RIGHT;
    observer.state.phase_since_tick = input.tick;
    observer.body.compass.extension_peak_m = 0.002f; /* its push-off goes on */
    observer.body.compass.extension_peak_tick = input.tick + 1000;
    input.sea[SIDE_RIGHT].precompression_m = 0.05f;
    input.leg[SIDE_RIGHT].ankle_extension_m = 0.002f;
    for (int i = 0; i < 60 && observer.state.phase == PHASE_DOUBLE_SUPPORT; i++) {
        observer.body.compass.extension_peak_tick = input.tick;
        tick();
    }
    ck_assert_int_eq(observer.state.phase, PHASE_SINGLE_SUPPORT);
    ck_assert_int_eq(observer.state.stance, SIDE_LEFT);
    ck_assert(observer.state.stance_past_apex);
    assert_close(angle[SIDE_LEFT], -1e-3 * RATE_RAD_S, 1.1e-3 * RATE_RAD_S, 0.0);
}
END_TEST

/* The model went along well until the report, and then leads back to no apex: standing still there,
 * moving forwards, or upright at another time altogether. What the samples say stands. */
START_TEST(a_model_that_finds_no_apex_is_not_asked)
{
    static const struct {
        double past_ms, rate_rad_s; /* of where the samples say that the leg is */
        bool lands;
    } cases[] = {{0, -0.8, true}, {10, -0.8, true},  {0, 0.8, false},
                 {0, 0.0, false}, {45, -0.8, false}, {-45, -0.8, false}};
    start(0.1, -0.1);
    run_to_work(SIDE_LEFT);
    put_model(SIDE_LEFT, angle[SIDE_LEFT] - 1e-3 * RATE_RAD_S * cases[_i].past_ms,
              cases[_i].rate_rad_s);
    tick();
    ck_assert(observer.apex.work.busy && observer.apex.work.modelled);
    run(20);
    ck_assert_int_eq(apexes, 1);
    ck_assert_int_eq(observer.apex.work.modelled, cases[_i].lands);
    if (!cases[_i].lands) {
        ck_assert(observer.state.apex.confidence == 0.0f);
        assert_close(last_apex.speed_rad_s, RATE_RAD_S, 0, 1e-4);
    }
}
END_TEST

/* A person's leg must have been 0.06 rad ahead, or as far as the hysteresis asks if that is more. */
START_TEST(a_person_s_apex_begins_with_the_leg_well_ahead)
{
    static const struct {
        double hysteresis_rad, ahead_rad;
        bool counts;
    } cases[] = {
        {0.01, 0.055, false}, {0.01, 0.065, true}, {0.1, 0.095, false}, {0.1, 0.105, true}};
    params.body = (real)BODY_PERSON;
    params.angle_hysteresis_rad = (real)cases[_i].hysteresis_rad;
    start(cases[_i].ahead_rad, -0.2);
    for (int i = 0; i < 300; i++) {
        observer.body.leg[SIDE_RIGHT].contact = LEG_SWING; /* the other leg is on its way */
        tick();
    }
    ck_assert_int_eq(apexes, cases[_i].counts ? 1 : 0);
}
END_TEST

/* After 49 days of samples the next apex is seen as the first one was. */
START_TEST(the_count_of_samples_ends_at_its_limit)
{
    start(0.1, -0.1);
    run(10);
    observer.samples = UINT32_MAX - 1;
    run(250);
    ck_assert_uint_eq(observer.samples, UINT32_MAX);
    ck_assert_int_eq(apexes, 1);
    assert_close(last_apex.speed_rad_s, RATE_RAD_S, 0, 1e-4);
}
END_TEST

/* A foot that lands at the very sample is 0 old; its event is of this tick. */
START_TEST(an_event_of_this_very_sample_is_of_this_tick)
{
    start(-0.1, 0.12); /* left stands behind, right swings down in front of it */
    observer.state.phase = PHASE_SINGLE_SUPPORT;
    observer.state.stance = SIDE_LEFT;
    rate[SIDE_LEFT] = 0.0;
    rate[SIDE_RIGHT] = 0.0;
    run(3);
    angle[SIDE_RIGHT] = 0.1; /* the sum is 0 */
    tick();
    const struct gait_event *strike = &observer.state.event[GAIT_HEEL_STRIKE];
    ck_assert(strike->happened);
    ck_assert_int_eq(strike->side, SIDE_RIGHT);
    ck_assert_uint_eq(strike->tick, input.tick);
    ck_assert(strike->before_tick_s == 0.0f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gait observer edges");
    TCase *tests = tcase_create("all");
    tcase_add_unchecked_fixture(tests, setup, NULL); /* its gaits take a while to find */
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, legs_side_by_side_are_no_phase);
    tcase_add_test(tests, the_leg_that_falls_back_is_the_stance_leg);
    tcase_add_test(tests, an_apex_in_double_support_ends_it);
    tcase_add_loop_test(tests, a_model_that_finds_no_apex_is_not_asked, 0, 6);
    tcase_add_loop_test(tests, a_person_s_apex_begins_with_the_leg_well_ahead, 0, 4);
    tcase_add_test(tests, the_count_of_samples_ends_at_its_limit);
    tcase_add_test(tests, an_event_of_this_very_sample_is_of_this_tick);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
