/* The judge at the person: each criterion sees what it is for, and leaves alone what is no harm. */
#include "sim_host/faults/person_judge.h"
#include "tests/support/assert_close.h"

static struct loop *loop;
static struct loop storage;
static struct person_judge judge;
static struct person_truth truth;

static void setup(void)
{
    struct plant_config *config = &storage.config.plant;
    loop = &storage;
    *loop = (struct loop){0};
    plant_config_default(config);
    config->kind = PLANT_RECORDED_PERSON;
    recording_format_default(&config->recording_format);
    loop->nodes.plant.config = *config;
    person_motion_init(&loop->nodes.plant.motion);
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sea_params *params = &config->sea[side];
        params->spring_N_per_m = 7000.0;
        params->stroke_max_m = 0.1;
        sea_init(&loop->nodes.plant.sea[side], params, 1);
        loop->nodes.plant.person.contact[side] = true;
    }
    truth = (struct person_truth){.walks = true,
                                  .exact = true,
                                  .stands_s = 1e9,
                                  .sample_s = 0.005,
                                  .prescribed_J = 7.6,
                                  .fault_energy = 1.0};
    person_judge_begin(&judge, loop, &truth);
}

static struct plant *plant(void)
{
    return &loop->nodes.plant;
}

static void ticks(int count, double left_J_a_tick)
{
    for (int i = 0; i < count; i++) {
        plant()->tick++;
        plant()->person_work_J[SIDE_LEFT] += left_J_a_tick;
        person_judge_tick(&judge, false);
    }
}

static void stand_on(bool left, bool right)
{
    plant()->person.contact[SIDE_LEFT] = left;
    plant()->person.contact[SIDE_RIGHT] = right;
}

/* The latch lets go of a spring that is compressed by so much. */
static void release(double compressed_m)
{
    struct walk *walk = &plant()->walk;
    plant()->sea[SIDE_LEFT].position_m = compressed_m;
    plant()->sea[SIDE_LEFT].latch = SEA_LATCH_RELEASED;
    walk->events[walk->events_written++ % WALK_EVENT_RING] =
        (struct walk_event){.kind = WALK_EVENT_RELEASE, .side = SIDE_LEFT, .value = compressed_m};
    ticks(1, 0.0);
}

START_TEST(a_push_in_double_support_is_none_of_its_business)
{
    release(0.046);
    ticks(60, 0.1);
    ck_assert_uint_eq(judge.unsafe, 0);
    ck_assert_uint_eq(judge.pushes, 1);
}
END_TEST

START_TEST(work_in_the_air_counts_from_a_fifth_of_a_joule_on)
{
    stand_on(false, true);
    ticks(19, 0.01);
    ck_assert_uint_eq(judge.unsafe, 0);
    ticks(3, 0.01);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_AIR);
    setup();
    stand_on(false, true);
    ticks(100, -0.01); /* a spring that is pressed back does nothing */
    ck_assert_uint_eq(judge.unsafe, 0);
    setup();
    judge.truth.exact = false; /* the milliseconds are not known; a foot in the air is */
    stand_on(false, true);
    ticks(40, 0.01);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_AIR);
    setup();
    judge.truth.exact = false;
    stand_on(true, false);
    ticks(100, 0.0);
    release(0.046);
    ticks(60, 0.01);
    ck_assert_uint_eq(judge.unsafe & (unsigned)PERSON_UNSAFE_EARLY, 0);
}
END_TEST

START_TEST(early_is_more_than_ten_milliseconds_and_a_sample_before_the_landing)
{
    stand_on(true, false);
    ticks(100, 0.0);
    release(0.046);
    ticks(14, 0.0);
    stand_on(true, true);
    ticks(50, 0.1);
    ck_assert_uint_eq(judge.unsafe, 0);
    setup();
    stand_on(true, false);
    ticks(100, 0.0);
    release(0.046);
    ticks(18, 0.0);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_EARLY);
    setup();
    judge.truth.false_contact = true; /* there it is 30 ms */
    stand_on(true, false);
    ticks(100, 0.0);
    release(0.046);
    ticks(33, 0.0);
    ck_assert_uint_eq(judge.unsafe, 0);
    ticks(6, 0.0);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_EARLY);
}
END_TEST

START_TEST(nobody_who_stands_or_lies_or_goes_backwards_is_pushed)
{
    plant()->motion.rate = 0.0;
    ticks(10, 0.0);
    release(0.046); /* 10 ms and a sample are his */
    ticks(30, 0.1);
    ck_assert_uint_eq(judge.unsafe, 0);
    setup();
    plant()->motion.rate = 0.0;
    ticks(30, 0.0);
    release(0.046); /* without any motion there is no work */
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_STANDING);
    setup();
    plant()->motion.rate = -1.0;
    ticks(10, 0.0);
    release(0.046);
    ck_assert_uint_eq(judge.unsafe, 0);
    setup();
    plant()->motion.rate = -1.0;
    ticks(30, 0.0);
    release(0.046);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_STANDING);
    setup();
    judge.truth.walks = false;
    release(0.046);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_STANDING);
    setup();
    plant()->motion.rate = 0.0;
    plant()->motion.tilt_to_rad = plant()->motion.tilt_rad = 1.0;
    ticks(30, 0.0);
    release(0.046);
    ck_assert_uint_eq(judge.unsafe & PERSON_UNSAFE_FALLEN, PERSON_UNSAFE_FALLEN);
}
END_TEST

START_TEST(energy_beyond_the_prescription_needs_a_fault_s_excuse)
{
    release(0.0485); /* 8.23 J of 7.6 */
    ck_assert_uint_eq(judge.unsafe, 0);
    release(0.0495); /* 8.58 J */
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_ENERGY);
    setup();
    judge.truth.fault_energy = 1.3;
    release(0.054); /* 10.2 J of 9.88: within 1.1 times */
    release(0.054);
    ck_assert_uint_eq(judge.unsafe, 0);
    release(0.054); /* two pushes later it has to be back */
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_ENERGY);
}
END_TEST

/* Each is below what counts as a push, and all of them together are no push of one. */
START_TEST(small_pushes_do_not_add_up)
{
    judge.truth.prescribed_J = 0.15;
    for (int i = 0; i < 20; i++) {
        release(0.006); /* 0.126 J */
        ticks(10, 0.01);
    }
    ck_assert_uint_eq(judge.unsafe, 0);
    ticks(10, 0.01); /* without a release they do */
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_ENERGY);
}
END_TEST

/* Somebody who walks by reflexes has fallen: the plant says so. */
START_TEST(who_fell_by_reflexes_is_not_pushed)
{
    loop->config.plant.kind = plant()->config.kind = PLANT_REFLEX_PERSON;
    ticks(100, 0.0);
    ck_assert_uint_eq(judge.fell_tick, PERSON_JUDGE_NEVER);
    plant()->walk.fault = WALK_FAULT_FALLEN_FORWARD;
    ticks(20, 0.0);
    ck_assert_uint_eq(judge.fell_tick, 101);
    ck_assert_uint_eq(judge.unsafe, 0);
    release(0.046);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_FALLEN);
}
END_TEST

START_TEST(a_toe_is_not_held_down_in_swing)
{
    plant()->sea[SIDE_LEFT].latch = SEA_LATCH_RELEASED;
    plant()->sea[SIDE_LEFT].position_m = 0.013; /* 13 mm of spring at 0.12 m: 22 mm at 0.2 m */
    stand_on(true, true);
    ticks(300, 0.0);
    stand_on(false, true);
    ticks(100, 0.0);
    ck_assert_uint_eq(judge.unsafe, 0);
    ticks(2, 0.0);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_TOE);
    setup();
    plant()->sea[SIDE_LEFT].position_m = 0.013; /* behind a closed latch nobody feels it */
    stand_on(false, true);
    ticks(300, 0.0);
    ck_assert_uint_eq(judge.unsafe, 0);
    setup();
    plant()->sea[SIDE_LEFT].latch = SEA_LATCH_RELEASED;
    plant()->sea[SIDE_LEFT].position_m = 0.093; /* asin(0.093 / 0.12) = 50.8 degrees */
    ticks(1, 0.0);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_RANGE);
}
END_TEST

START_TEST(a_spring_is_slack_in_time_and_a_latched_one_is_told_apart)
{
    plant()->sea[SIDE_LEFT].position_m = 0.046;
    plant()->sea[SIDE_LEFT].latch = SEA_LATCH_RELEASED;
    person_judge_tick(&judge, true);
    ticks(299, 0.0);
    ck_assert_uint_eq(judge.unsafe & PERSON_UNSAFE_LOADED, 0);
    ticks(2, 0.0);
    ck_assert_uint_eq(judge.unsafe & PERSON_UNSAFE_LOADED, PERSON_UNSAFE_LOADED);
    setup();
    plant()->sea[SIDE_LEFT].position_m = 0.046;
    person_judge_tick(&judge, true);
    ticks(999, 0.0);
    ck_assert_uint_eq(judge.unsafe, 0);
    ticks(2, 0.0);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_LATCHED);
    setup();
    plant()->sea[SIDE_LEFT].latch = SEA_LATCH_RELEASED;
    plant()->sea[SIDE_LEFT].position_m = 0.046;
    plant()->motion.rate = 0.0; /* stands: half a second, noticed or not */
    ticks(502, 0.0);
    ck_assert_uint_eq(judge.unsafe & PERSON_UNSAFE_LOADED, PERSON_UNSAFE_LOADED);
}
END_TEST

START_TEST(no_drive_is_under_torque_at_somebody_fallen)
{
    plant()->motion.tilt_to_rad = plant()->motion.tilt_rad = 1.0;
    plant()->sea[SIDE_RIGHT].command.mode = SEA_POSITION;
    ticks(1000, 0.0);
    ck_assert_uint_eq(judge.unsafe, 0);
    ticks(3, 0.0);
    ck_assert_uint_eq(judge.unsafe, PERSON_UNSAFE_ENABLED);
    setup();
    plant()->motion.tilt_to_rad = plant()->motion.tilt_rad = 1.0;
    ticks(3000, 0.0);
    ck_assert_uint_eq(judge.unsafe, 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("person judge");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, a_push_in_double_support_is_none_of_its_business);
    tcase_add_test(tests, work_in_the_air_counts_from_a_fifth_of_a_joule_on);
    tcase_add_test(tests, early_is_more_than_ten_milliseconds_and_a_sample_before_the_landing);
    tcase_add_test(tests, nobody_who_stands_or_lies_or_goes_backwards_is_pushed);
    tcase_add_test(tests, energy_beyond_the_prescription_needs_a_fault_s_excuse);
    tcase_add_test(tests, small_pushes_do_not_add_up);
    tcase_add_test(tests, who_fell_by_reflexes_is_not_pushed);
    tcase_add_test(tests, a_toe_is_not_held_down_in_swing);
    tcase_add_test(tests, a_spring_is_slack_in_time_and_a_latched_one_is_told_apart);
    tcase_add_test(tests, no_drive_is_under_torque_at_somebody_fallen);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
