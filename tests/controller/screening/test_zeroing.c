/* Zeroing while standing: offsets come out as put in, and no wrong moment is taken. */
#include <check.h>
#include <math.h>

#include "controller/screening/zeroing.h"
#include "tests/support/assert_close.h"

static struct zeroing zeroing;

struct stance {
    double offset_rad[SIDE_COUNT], offset_m[SIDE_COUNT];
    double sway_rad, noise_rad;
    int lost_from, lost_to; /* ticks without samples */
};

static void stand(const struct stance *stance, int ticks)
{
    for (int n = 0; n < ticks; n++) {
        struct leg_measurement leg[SIDE_COUNT];
        for (int side = 0; side < SIDE_COUNT; side++) {
            const double sway = stance->sway_rad * sin(2.0 * 3.14159265 * 0.4 * 1e-3 * n);
            const double noise = stance->noise_rad * ((n * 7919 + side * 31) % 13 - 6) / 4.0;
            leg[side] = (struct leg_measurement){
                (real)(stance->offset_rad[side] + sway + noise), (real)stance->offset_m[side],
                (uint16_t)(n >= stance->lost_from && n < stance->lost_to ? 1 : 0), FOOT_UNKNOWN};
        }
        zeroing_update(&zeroing, leg);
    }
}

START_TEST(offsets_are_found)
{
    const struct stance stance = {{0.03, -0.05}, {0.002, 0.0}, 0.006, 1e-3, 100, 110};
    zeroing = (struct zeroing){0};
    stand(&stance, 100);
    ck_assert_int_eq(zeroing.state, ZEROING_IDLE);
    zeroing_start(&zeroing);
    stand(&stance, 2900);
    ck_assert_int_eq(zeroing.state, ZEROING_RUNNING);
    stand(&stance, 200);
    ck_assert_int_eq(zeroing.state, ZEROING_DONE);
    assert_close((double)zeroing.mean.angle_rad[SIDE_LEFT], 0.03, 2e-3, 0.0);
    assert_close((double)zeroing.mean.angle_rad[SIDE_RIGHT], -0.05, 2e-3, 0.0);
    assert_close((double)zeroing.mean.ankle_m[SIDE_LEFT], 0.002, 1e-6, 0.0);
    assert_close((double)zeroing.mean.ankle_m[SIDE_RIGHT], 0.0, 1e-6, 0.0);
}
END_TEST

START_TEST(wrong_moments_are_refused)
{
    static const struct {
        struct stance stance;
        enum zeroing_state verdict;
    } cases[] = {
        {{{0, 0}, {0, 0}, 0.03, 0, 0, 0}, ZEROING_MOVED},
        {{{0.3, 0}, {0, 0}, 0, 0, 0, 0}, ZEROING_TOO_FAR},
        {{{0, 0}, {0, 0.05}, 0, 0, 0, 0}, ZEROING_TOO_FAR},
        {{{0, 0}, {0, 0}, 0, 0, 50, 90}, ZEROING_NO_SAMPLE},
        {{{(double)NAN, 0}, {0, 0}, 0, 0, 0, 0}, ZEROING_NO_SAMPLE},
    };
    zeroing_start(&zeroing);
    stand(&cases[_i].stance, 4000);
    ck_assert_int_eq(zeroing.state, cases[_i].verdict);
}
END_TEST

START_TEST(a_run_can_be_given_up)
{
    const struct stance still = {0};
    zeroing_start(&zeroing);
    stand(&still, 1000);
    zeroing_stop(&zeroing);
    ck_assert_int_eq(zeroing.state, ZEROING_MOVED);
    stand(&still, 4000);
    ck_assert_int_eq(zeroing.state, ZEROING_MOVED);
}
END_TEST

/* Each limit from both sides, of either leg: 0.035 rad of sway from end to end, 0.2 rad and 30 mm of mounting. */
START_TEST(limits_hold_from_both_sides)
{
    static const struct {
        double sway_rad, offset_rad, offset_m;
        enum zeroing_state verdict;
    } cases[] = {{0.0174, 0, 0, ZEROING_DONE},  {0.0176, 0, 0, ZEROING_MOVED},
                 {0, 0.199, 0, ZEROING_DONE},   {0, 0.201, 0, ZEROING_TOO_FAR},
                 {0, -0.199, 0, ZEROING_DONE},  {0, -0.201, 0, ZEROING_TOO_FAR},
                 {0, 0, 0.0299, ZEROING_DONE},  {0, 0, 0.0301, ZEROING_TOO_FAR},
                 {0, 0, -0.0299, ZEROING_DONE}, {0, 0, -0.0301, ZEROING_TOO_FAR}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (int side = 0; side < SIDE_COUNT; side++) {
            struct stance stance = {.sway_rad = cases[i].sway_rad};
            stance.offset_rad[side] = cases[i].offset_rad;
            stance.offset_m[side] = cases[i].offset_m;
            zeroing_start(&zeroing);
            stand(&stance, 3000);
            ck_assert_msg(zeroing.state == cases[i].verdict, "case %zu: %d", i, (int)zeroing.state);
        }
    }
}
END_TEST

/* One leg alone that moves is enough. */
START_TEST(either_leg_may_be_the_one_that_moves)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct leg_measurement leg[SIDE_COUNT] = {0};
        zeroing_start(&zeroing);
        zeroing_update(&zeroing, leg);
        leg[side].leg_angle_rad = REAL(-0.036);
        zeroing_update(&zeroing, leg);
        ck_assert_int_eq(zeroing.state, ZEROING_MOVED);
    }
}
END_TEST

/* 3 s of samples, those that were missing not counted: 20 may be. What is no number is missing. */
START_TEST(it_takes_3_s_of_samples_of_both_legs)
{
    for (int kind = 0; kind < 6; kind++) {
        struct leg_measurement good[SIDE_COUNT] = {0}, bad[SIDE_COUNT] = {0};
        const int side = kind % 2;
        if (kind < 2) {
            bad[side].age_ticks = 1;
        } else if (kind < 4) {
            bad[side].leg_angle_rad = (real)NAN;
        } else {
            bad[side].ankle_extension_m = (real)INFINITY;
        }
        zeroing_start(&zeroing); /* of the run before nothing is left */
        for (int i = 0; i < 20; i++) {
            zeroing_update(&zeroing, bad);
        }
        for (int i = 0; i < 2999; i++) {
            zeroing_update(&zeroing, good);
        }
        ck_assert_int_eq(zeroing.state, ZEROING_RUNNING);
        zeroing_update(&zeroing, good);
        ck_assert_int_eq(zeroing.state, ZEROING_DONE);
        zeroing_start(&zeroing);
        for (int i = 0; i < 20; i++) {
            zeroing_update(&zeroing, bad);
            ck_assert_int_eq(zeroing.state, ZEROING_RUNNING);
        }
        zeroing_update(&zeroing, bad);
        ck_assert_int_eq(zeroing.state, ZEROING_NO_SAMPLE);
    }
}
END_TEST

/* Giving up what does not run changes nothing. */
START_TEST(only_a_run_can_be_given_up)
{
    static const enum zeroing_state states[] = {ZEROING_IDLE, ZEROING_DONE, ZEROING_TOO_FAR,
                                                ZEROING_NO_SAMPLE};
    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
        zeroing.state = states[i];
        zeroing_stop(&zeroing);
        ck_assert_int_eq(zeroing.state, states[i]);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("zeroing");
    TCase *tcase = tcase_create("standing");
    tcase_add_test(tcase, offsets_are_found);
    tcase_add_loop_test(tcase, wrong_moments_are_refused, 0, 5);
    tcase_add_test(tcase, a_run_can_be_given_up);
    tcase_add_test(tcase, limits_hold_from_both_sides);
    tcase_add_test(tcase, either_leg_may_be_the_one_that_moves);
    tcase_add_test(tcase, it_takes_3_s_of_samples_of_both_legs);
    tcase_add_test(tcase, only_a_run_can_be_given_up);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
