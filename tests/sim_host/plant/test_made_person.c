/* A made person against the positions that textbooks print, and changed copies against their formulas. */
#include <math.h>
#include <stdlib.h>

#include "sim_host/plant/changed_copy.h"
#include "sim_host/plant/made_person.h"
#include "sim_host/plant/person_motion.h"
#include "tests/support/assert_close.h"

static struct recording_format format;
static struct made_person_params params;
static struct recording walk;

static void setup(void)
{
    recording_format_default(&format);
    made_person_usual(&params);
    ck_assert_int_eq(made_person_record(&walk, &params, &format), RECORDING_OK);
}

static void teardown(void)
{
    recording_free(&walk);
}

/* Perry, Burnfield (2010): the joints' positions at the ends of the phases, degrees; +-3, as other books
 * differ by that. Thigh from the vertical, knee flexion, dorsiflexion. */
static const struct {
    double share, thigh, knee, ankle;
} positions[] = {
    {0.00, 20, 5, 0},     {0.12, 20, 15, -5}, {0.31, 0, 5, 5},   {0.50, -20, 10, 10},
    {0.62, -10, 40, -15}, {0.75, 15, 60, -5}, {0.87, 25, 25, 0},
};

START_TEST(angles_are_those_of_textbooks)
{
    for (size_t i = 0; i < sizeof positions / sizeof positions[0]; i++) {
        double thigh, shank, ankle;
        made_person_angles(positions[i].share, 0.62, &thigh, &shank, &ankle);
        assert_close(thigh, positions[i].thigh, 3.0, 0.0);
        assert_close(thigh - shank, positions[i].knee, 3.0, 0.0);
        assert_close(ankle, positions[i].ankle, 3.0, 0.0);
    }
}
END_TEST

static double first_edge_s(const struct recording *recording, int side, bool to, double from_s)
{
    for (size_t i = 1; i < recording->count; i++) {
        if (recording->samples[i].time_s > from_s && recording->samples[i].contact[side] == to &&
            recording->samples[i - 1].contact[side] != to) {
            return recording->samples[i].time_s;
        }
    }
    return -1.0;
}

START_TEST(strides_last_as_asked_and_feet_take_turns)
{
    double strike_s = first_edge_s(&walk, SIDE_LEFT, true, 0.0);
    for (int i = 0; i < 10; i++) {
        const double next_s = first_edge_s(&walk, SIDE_LEFT, true, strike_s);
        const double other_s = first_edge_s(&walk, SIDE_RIGHT, true, strike_s);
        const double off_s = first_edge_s(&walk, SIDE_LEFT, false, strike_s);
        assert_close(next_s - strike_s, 1.12, 0.05, 0.0);
        assert_close((other_s - strike_s) / (next_s - strike_s), 0.5, 0.01, 0.0);
        assert_close((off_s - strike_s) / (next_s - strike_s), 0.62, 0.01, 0.0);
        strike_s = next_s;
    }
}
END_TEST

START_TEST(parameters_change_what_they_say)
{
    struct recording slow = {0};
    struct made_person_params other = params;
    ck_assert_ptr_null(made_person_check(&params));
    other.stride_s = 1.6;
    other.size = 0.6;
    other.asymmetry = 0.2;
    ck_assert_double_lt(made_person_speed_m_s(&other, 0.9),
                        0.6 * made_person_speed_m_s(&params, 0.9));
    assert_close(made_person_speed_m_s(&params, 0.9), 1.15, 0.2, 0.0);
    ck_assert_int_eq(made_person_record(&slow, &other, &format), RECORDING_OK);
    double widest[SIDE_COUNT] = {0.0};
    for (size_t i = 0; i < slow.count; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double size = fabs(slow.samples[i].leg_angle_rad[side]);
            widest[side] = size > widest[side] ? size : widest[side];
        }
    }
    assert_close(widest[SIDE_LEFT] / widest[SIDE_RIGHT], 0.8, 0.01, 0.0);
    recording_free(&slow);
    other.toe_off = 0.4;
    ck_assert_str_eq(made_person_check(&other), "toe_off");
}
END_TEST

/* ---- copies ------------------------------------------------------------------------- */

static void copy_of(enum copy_kind kind, double phase, struct recording *copy,
                    struct copy_truth *truth)
{
    ck_assert_int_eq(changed_copy_make(copy, &walk, kind, phase, &format, truth), RECORDING_OK);
    for (size_t i = 1; i < copy->count; i++) {
        ck_assert_double_gt(copy->samples[i].time_s, copy->samples[i - 1].time_s);
    }
}

START_TEST(every_copy_can_be_made_and_says_who_walks)
{
    for (int kind = 0; kind < COPY_KINDS; kind++) {
        struct recording copy;
        struct copy_truth truth;
        copy_of((enum copy_kind)kind, 0.3, &copy, &truth);
        ck_assert_int_eq(truth.walks, kind < COPY_BACKWARDS);
        ck_assert_int_eq(truth.stands_s < COPY_NEVER, kind == COPY_STOP || kind == COPY_LEG_HELD);
        recording_free(&copy);
    }
}
END_TEST

START_TEST(slow_short_and_limping_are_scaled)
{
    struct recording copy;
    struct copy_truth truth;
    const struct recording_sample *was = &walk.samples[1000];
    copy_of(COPY_SLOW, 0.0, &copy, &truth);
    assert_close(copy.samples[1000].leg_angle_rad[SIDE_LEFT], 0.6 * was->leg_angle_rad[SIDE_LEFT],
                 1e-12, 0.0);
    assert_close(copy.samples[1000].time_s, 1.8 * was->time_s, 1e-9, 0.0);
    recording_free(&copy);
    copy_of(COPY_LIMP, 0.0, &copy, &truth);
    assert_close(copy.samples[1000].leg_angle_rad[SIDE_LEFT], 0.7 * was->leg_angle_rad[SIDE_LEFT],
                 1e-12, 0.0);
    assert_close(copy.samples[1000].leg_angle_rad[SIDE_RIGHT], was->leg_angle_rad[SIDE_RIGHT],
                 1e-12, 0.0);
    /* Strides keep about their length. */
    assert_close(copy.samples[copy.count - 1].time_s, walk.samples[walk.count - 1].time_s, 0.3,
                 0.0);
    recording_free(&copy);
}
END_TEST

START_TEST(a_stop_stands_still_from_its_phase_on)
{
    struct recording copy;
    struct copy_truth truth;
    for (double phase = 0.0; phase < 1.0; phase += 0.25) {
        copy_of(COPY_STOP, phase, &copy, &truth);
        const double from_s =
            first_edge_s(&walk, SIDE_LEFT, true, walk.samples[2 * walk.count / 3].time_s - 0.01);
        assert_close(truth.stands_s, from_s + phase * 1.12, 0.06, 0.0);
        for (size_t i = 0; i + 1 < copy.count; i++) {
            if (copy.samples[i].time_s > truth.stands_s) {
                assert_close(copy.samples[i].leg_angle_rad[SIDE_LEFT],
                             copy.samples[copy.count - 1].leg_angle_rad[SIDE_LEFT], 1e-12, 0.0);
            }
        }
        assert_close(copy.samples[copy.count - 1].time_s - truth.stands_s, 3.0, 0.01, 0.0);
        recording_free(&copy);
    }
}
END_TEST

START_TEST(a_harness_has_no_ground_and_backwards_ends_at_the_beginning)
{
    struct recording copy;
    struct copy_truth truth;
    copy_of(COPY_HARNESS, 0.0, &copy, &truth);
    for (size_t i = 0; i < copy.count; i++) {
        ck_assert(!copy.samples[i].contact[SIDE_LEFT] && !copy.samples[i].contact[SIDE_RIGHT]);
        assert_close(copy.samples[i].ankle_m[SIDE_LEFT], 0.0, 1e-12, 0.0);
    }
    recording_free(&copy);
    copy_of(COPY_BACKWARDS, 0.0, &copy, &truth);
    assert_close(copy.samples[0].leg_angle_rad[SIDE_RIGHT],
                 walk.samples[walk.count - 1].leg_angle_rad[SIDE_RIGHT], 1e-12, 0.0);
    recording_free(&copy);
}
END_TEST

/* ---- what befalls a person ------------------------------------------------------------- */

START_TEST(who_falls_lies_down_without_ground_and_a_tripped_leg_comes_back)
{
    struct person_motion motion;
    struct recorded_person_state now = {.contact = {true, true}};
    person_motion_init(&motion);
    struct recorded_person_state next = now;
    person_motion_apply(&motion, 0.001, &now, &next);
    assert_close(next.leg_angle_rad[SIDE_LEFT], 0.0, 1e-15, 0.0); /* as recorded */
    ck_assert(next.contact[SIDE_LEFT]);
    motion.tilt_to_rad = -1.2;
    for (int i = 0; i < 481; i++) { /* 1.2 rad at 2.5 rad/s */
        next = now;
        person_motion_apply(&motion, 0.001, &now, &next);
        ck_assert(i < 198 ? !person_motion_is_down(&motion)
                          : i < 202 || person_motion_is_down(&motion)); /* 0.5 rad */
    }
    assert_close(next.leg_angle_rad[SIDE_LEFT], -1.2, 1e-9, 0.0);
    ck_assert(!next.contact[SIDE_LEFT] && !next.contact[SIDE_RIGHT]);
    person_motion_init(&motion);
    now.leg_angle_rad[SIDE_LEFT] = 0.3;
    person_motion_hold(&motion, SIDE_LEFT, &now);
    next = (struct recorded_person_state){.leg_angle_rad = {-0.1, 0.2}};
    person_motion_apply(&motion, 0.001, &now, &next);
    assert_close(next.leg_angle_rad[SIDE_LEFT], 0.3, 1e-12, 0.0);
    assert_close(next.leg_angle_rad[SIDE_RIGHT], 0.2, 1e-12, 0.0);
    motion.held[SIDE_LEFT] = false;
    for (int i = 0; i < 151; i++) {
        next = (struct recorded_person_state){.leg_angle_rad = {-0.1, 0.2}};
        person_motion_apply(&motion, 0.001, &now, &next);
    }
    assert_close(next.leg_angle_rad[SIDE_LEFT], -0.1, 1e-12, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("made person");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, angles_are_those_of_textbooks);
    tcase_add_test(tests, strides_last_as_asked_and_feet_take_turns);
    tcase_add_test(tests, parameters_change_what_they_say);
    tcase_add_test(tests, every_copy_can_be_made_and_says_who_walks);
    tcase_add_test(tests, slow_short_and_limping_are_scaled);
    tcase_add_test(tests, a_stop_stands_still_from_its_phase_on);
    tcase_add_test(tests, a_harness_has_no_ground_and_backwards_ends_at_the_beginning);
    tcase_add_test(tests, who_falls_lies_down_without_ground_and_a_tripped_leg_comes_back);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
