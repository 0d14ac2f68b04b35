/* A whole person: walks without a device within the published bounds of level walking, the same twice, from a snapshot,
 * and with half the step. Bounds: comfortable walking has 1.2 to 1.3 m/s and 85 to 125 steps a minute, and neither foot
 * carries 1.5 body weights (Perry & Burnfield 2010, Gait Analysis). */
#include "sim_host/reflex/reflex_person.h"
#include "tests/support/assert_close.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const struct reflex_person_loads alone;

struct walked {
    double speed_m_s, peak_weights;
    unsigned steps;
};

/* Walks to the second `until_s`; what is counted begins at from_s. */
static struct walked walk(struct reflex_person *person, double from_s, double until_s)
{
    const struct reflex_person_params *params = &person->params;
    const double weight_N = params->mass_kg * params->gravity_m_s2;
    struct walked walked = {0.0, 0.0, 0};
    double start_m = person->body.q[MULTIBODY_X];
    int stood[SIDE_COUNT] = {0, 0};
    for (double now_s = (double)person->steps * params->step_s; now_s < until_s;
         now_s = (double)person->steps * params->step_s) {
        reflex_person_step(person, &alone);
        ck_assert_msg(!reflex_person_fell(person), "fell after %g s", now_s);
        if (now_s < from_s) {
            start_m = person->body.q[MULTIBODY_X];
        }
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double load = person->ground_N[side].y / weight_N;
            walked.peak_weights =
                now_s > from_s && load > walked.peak_weights ? load : walked.peak_weights;
            walked.steps += now_s > from_s && load > 0.05 && !stood[side];
            stood[side] = load > 0.05;
        }
    }
    walked.speed_m_s = (person->body.q[MULTIBODY_X] - start_m) / (until_s - from_s);
    return walked;
}

static void begin_noisy(struct reflex_person *person, double step_s, double noise_share,
                        uint64_t seed)
{
    struct reflex_person_params params;
    reflex_person_default(80.0, 1.0, &params);
    params.step_s = step_s;
    params.noise_share = noise_share;
    params.noise_seed = seed;
    ck_assert_ptr_null(reflex_person_check(&params));
    reflex_person_init(person, &params);
}

static void begin(struct reflex_person *person, double step_s)
{
    begin_noisy(person, step_s, REFLEX_NOISE_NONE, 0);
}

START_TEST(a_healthy_person_walks_as_people_do)
{
    struct reflex_person person;
    begin(&person, 0.00025);
    const struct walked walked = walk(&person, 10.0, 70.0);
    ck_assert_msg(walked.speed_m_s > 1.2 && walked.speed_m_s < 1.3, "%g m/s", walked.speed_m_s);
    ck_assert_msg(walked.peak_weights < 1.5 && walked.peak_weights > 1.0, "%g",
                  walked.peak_weights);
    ck_assert_uint_ge(
        walked.steps,
        85); /* a minute; people of that speed make 105 to 115, longer steps are a miss */
    ck_assert_uint_le(walked.steps, 125);
}
END_TEST

START_TEST(half_the_step_walks_alike)
{
    struct reflex_person coarse, fine;
    begin(&coarse, 0.00025);
    begin(&fine, 0.000125);
    const double speed = walk(&coarse, 10.0, 30.0).speed_m_s,
                 other = walk(&fine, 10.0, 30.0).speed_m_s;
    assert_close(other, speed, 0.0, 0.02);
}
END_TEST

START_TEST(a_copy_is_a_snapshot)
{
    struct reflex_person one, two, third;
    begin(&one, 0.00025);
    begin(&third, 0.00025);
    (void)walk(&one, 0.0, 3.0);
    memcpy(&two, &one, sizeof one);
    (void)walk(&one, 0.0, 6.0);
    (void)walk(&two, 0.0, 6.0);
    (void)walk(&third, 0.0, 6.0);
    ck_assert_mem_eq(&one.body, &two.body, sizeof one.body);
    ck_assert_mem_eq(&one.muscle, &two.muscle, sizeof one.muscle);
    ck_assert_mem_eq(&one.body, &third.body, sizeof one.body);
}
END_TEST

START_TEST(a_noisy_walk_repeats_by_its_seed)
{
    struct reflex_person one, two, copy, other;
    begin_noisy(&one, 0.00025, 0.02, 4);
    begin_noisy(&two, 0.00025, 0.02, 4);
    begin_noisy(&other, 0.00025, 0.02, 5);
    (void)walk(&one, 0.0, 2.0);
    memcpy(&copy, &one, sizeof copy);
    (void)walk(&one, 0.0, 4.0);
    (void)walk(&copy, 0.0, 4.0);
    (void)walk(&two, 0.0, 4.0);
    (void)walk(&other, 0.0, 4.0);
    ck_assert_mem_eq(&one.body, &copy.body, sizeof one.body);
    ck_assert_mem_eq(&one.body, &two.body, sizeof one.body);
    ck_assert_mem_eq(&one.noise, &two.noise, sizeof one.noise);
    ck_assert_mem_ne(&one.body, &other.body, sizeof one.body);
}
END_TEST

/* An impulse changes the momentum of the whole by itself, whatever the pose. */
START_TEST(a_push_gives_its_momentum)
{
    struct reflex_person person;
    struct vector2 at, before, after;
    begin(&person, 0.00025);
    (void)walk(&person, 0.0, 2.0);
    multibody_centre(&person.params.segments, &person.body, &at, &before);
    reflex_person_push(&person, (struct vector2){16.0, -8.0});
    multibody_centre(&person.params.segments, &person.body, &at, &after);
    assert_close(after.x - before.x, 16.0 / 80.0, 1e-12, 0.0);
    assert_close(after.y - before.y, -8.0 / 80.0, 1e-12, 0.0);
}
END_TEST

/* The ball stands still along the ground, nothing pulls it up or down, and what it loses of energy is what an impulse
 * takes that stops it: half of impulse times speed. */
START_TEST(a_trip_stops_the_foot)
{
    struct reflex_person person;
    struct multibody_pose pose;
    struct vector2 at, before, after, speed, still;
    begin(&person, 0.00025);
    (void)walk(&person, 0.0, 2.0);
    const struct segments *segments = &person.params.segments;
    const enum side swing = SIDE_LEFT;
    do { /* until that foot swings */
        reflex_person_step(&person, &alone);
        multibody_pose(segments, &person.body, &pose);
        multibody_foot_point(&person.body, &pose, swing, segments->ball_m, &at, &speed);
    } while (speed.x < 1.0 && person.steps < 20000);
    ck_assert(speed.x >= 1.0);
    multibody_centre(segments, &person.body, &at, &before);
    const double before_J = multibody_energy_J(segments, &person.body);
    reflex_person_trip(&person, swing, FOOT_BALL);
    multibody_foot_point(&person.body, &pose, swing, segments->ball_m, &at, &still);
    multibody_centre(segments, &person.body, &at, &after);
    assert_close(still.x, 0.0, 1e-9, 0.0);
    assert_close(after.y, before.y, 1e-9, 0.0);
    const double impulse_Ns = 80.0 * (after.x - before.x);
    ck_assert(impulse_Ns < 0.0);
    const struct multibody_state stopped = person.body;
    person.body.dq[MULTIBODY_X] -= 1.0; /* away from what it met */
    const struct multibody_state away = person.body;
    reflex_person_trip(&person, swing, FOOT_BALL);
    ck_assert_mem_eq(&person.body, &away, sizeof away);
    person.body = stopped;
    assert_close(multibody_energy_J(segments, &person.body) - before_J, 0.5 * impulse_Ns * speed.x,
                 0.0, 1e-6);
}
END_TEST

/* A device's torque extends the ankle, and what it does there is what the body gains. In the air, so that nothing else
 * takes it. */
START_TEST(a_device_plantarflexes_and_gives_its_work)
{
    struct reflex_person with, without;
    struct joint_angles before, after;
    const struct reflex_person_loads loads = {.ankle_Nm = {[SIDE_LEFT] = 40.0}};
    begin(&with, 0.00025);
    (void)walk(&with, 0.0, 2.0);
    with.params.step_s =
        1e-6; /* what muscles and joint ends do of the change vanishes with its square */
    with.body.q[MULTIBODY_Y] += 0.5;
    with.body.dq[MULTIBODY_LEFT + PART_FOOT] -=
        6.0; /* the foot turns down already: there is power */
    without = with;
    muscles_joint_angles(&with.body, SIDE_LEFT, &before);
    reflex_person_step(&with, &loads);
    reflex_person_step(&without, &alone);
    muscles_joint_angles(&with.body, SIDE_LEFT, &after);
    const double turned_rad = after.angle_rad[JOINT_ANKLE] - before.angle_rad[JOINT_ANKLE];
    ck_assert(after.rate_rad_s[JOINT_ANKLE] > before.rate_rad_s[JOINT_ANKLE]);
    ck_assert(with.body.dq[MULTIBODY_LEFT + PART_FOOT] <
              without.body.dq[MULTIBODY_LEFT + PART_FOOT]);
    const double gained_J = multibody_energy_J(&with.params.segments, &with.body) -
                            multibody_energy_J(&without.params.segments, &without.body);
    assert_close(gained_J, 40.0 * turned_rad, 0.0, 0.02);
}
END_TEST

START_TEST(whoever_has_no_legs_to_stand_on_falls)
{
    struct reflex_person person;
    begin(&person, 0.00025);
    for (int side = 0; side < SIDE_COUNT; side++) {
        person.params.muscle[side][MUSCLE_VAS].force_max_N = 60.0; /* 1 % of its strength */
    }
    int fell_at = 0;
    for (int i = 1; i < 20000 && fell_at == 0; i++) {
        reflex_person_step(&person, &alone);
        fell_at = reflex_person_fell(&person) ? i : 0;
    }
    ck_assert_int_gt(fell_at, 0);
    person.body.q[MULTIBODY_Y] = (double)NAN;
    ck_assert(reflex_person_fell(&person));
}
END_TEST

START_TEST(what_is_out_of_range_is_named)
{
    static const struct {
        size_t offset;
        double value;
        const char *name;
    } bad[] = {
        {offsetof(struct reflex_person_params, mass_kg), (double)NAN, "mass_kg"},
        {offsetof(struct reflex_person_params, leg_m), 0.1, "leg_m"},
        {offsetof(struct reflex_person_params, gravity_m_s2), -1.0, "gravity_m_s2"},
        {offsetof(struct reflex_person_params, start_speed_m_s), 9.0, "start_speed_m_s"},
        {offsetof(struct reflex_person_params, start_lean_rad), 1.0, "start_lean_rad"},
        {offsetof(struct reflex_person_params, noise_share), 0.3, "noise_share"},
        {offsetof(struct reflex_person_params, noise_share), (double)NAN, "noise_share"},
        {offsetof(struct reflex_person_params, step_s), 0.0003, "step_s"},
        {offsetof(struct reflex_person_params, gains.load), (double)NAN, "gain"},
        {offsetof(struct reflex_person_params, gains.glu_force), 1e9, "gain"},
        {offsetof(struct reflex_person_params, muscle[1][MUSCLE_TA].slack_m), -1.0, "muscle"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct reflex_person_params params;
        reflex_person_default(80.0, 1.0, &params);
        memcpy((char *)&params + bad[i].offset, &bad[i].value, sizeof bad[i].value);
        const char *words = reflex_person_check(&params);
        ck_assert_ptr_nonnull(words);
        ck_assert_ptr_nonnull(strstr(words, bad[i].name));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("reflex_person");
    TCase *tests = tcase_create("all");
    tcase_set_timeout(tests, 240);
    tcase_add_test(tests, a_healthy_person_walks_as_people_do);
    tcase_add_test(tests, half_the_step_walks_alike);
    tcase_add_test(tests, a_copy_is_a_snapshot);
    tcase_add_test(tests, a_noisy_walk_repeats_by_its_seed);
    tcase_add_test(tests, a_push_gives_its_momentum);
    tcase_add_test(tests, a_trip_stops_the_foot);
    tcase_add_test(tests, a_device_plantarflexes_and_gives_its_work);
    tcase_add_test(tests, whoever_has_no_legs_to_stand_on_falls);
    tcase_add_test(tests, what_is_out_of_range_is_named);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
