/* Screening of the samples: which changes are accepted, and what replaces the others (numbers from
 * the comments beside the limits). */
#include "controller/screening/samples.h"
#include "tests/support/assert_close.h"

#include <math.h>
#include <string.h>

/* A leg of 1 m; the motor's reference may go at 1.5 m/s. */
static struct control_params params;
static struct samples samples;
static struct controller_input input;

static void setup(void)
{
    memset(&params, 0, sizeof params);
    memset(&input, 0, sizeof input);
    params.leg_length_m = REAL(1.0);
    params.gravity_m_s2 = REAL(9.81);
    params.sea_speed_max_m_s = REAL(1.5);
    samples_init(&samples);
}

static struct controller_input screened(void)
{
    struct controller_input values = input;
    samples_screen(&samples, &params, &values);
    return values;
}

/* Legs that swing against each other at 1 rad/s for 50 ticks. */
static void swing(void)
{
    for (int i = 0; i < 50; i++) {
        input.leg[SIDE_LEFT].leg_angle_rad += REAL(0.001);
        input.leg[SIDE_RIGHT].leg_angle_rad -= REAL(0.001);
        (void)screened();
    }
}

START_TEST(any_first_sample_is_accepted)
{
    input.leg[SIDE_LEFT].leg_angle_rad = REAL(1.4);
    input.leg[SIDE_RIGHT].ankle_extension_m = REAL(0.3);
    input.sea[SIDE_LEFT].precompression_m = REAL(0.2);
    const struct controller_input values = screened();
    ck_assert(values.leg[SIDE_LEFT].leg_angle_rad == REAL(1.4));
    ck_assert(values.leg[SIDE_RIGHT].ankle_extension_m == REAL(0.3));
    ck_assert(values.sea[SIDE_LEFT].precompression_m == REAL(0.2));
}
END_TEST

START_TEST(one_wild_sample_is_bridged_at_the_last_rate)
{
    swing();
    const struct controller_input well = input;
    input.leg[SIDE_LEFT].leg_angle_rad += REAL(0.5);
    input.leg[SIDE_RIGHT].ankle_extension_m += REAL(0.3);
    input.sea[SIDE_LEFT].precompression_m += REAL(0.2);
    const struct controller_input values = screened();
    assert_close((double)values.leg[SIDE_LEFT].leg_angle_rad,
                 (double)well.leg[SIDE_LEFT].leg_angle_rad + 0.001, 1e-6, 0.0);
    assert_close((double)values.leg[SIDE_RIGHT].ankle_extension_m, 0.0, 1e-9, 0.0);
    assert_close((double)values.sea[SIDE_LEFT].precompression_m, 0.0, 1e-9, 0.0);
    ck_assert_uint_eq(samples.leg[SIDE_LEFT].angle_rejected_ticks, 1);
    ck_assert_uint_eq(samples.leg[SIDE_RIGHT].extension_rejected_ticks, 1);
    ck_assert_uint_eq(samples.leg[SIDE_LEFT].motor_rejected_ticks, 1);
    input = well;
    (void)screened(); /* and it is over */
    ck_assert_uint_eq(samples.leg[SIDE_LEFT].angle_rejected_ticks, 0);
}
END_TEST

START_TEST(what_is_not_finite_is_replaced)
{
    const real wrong = _i == 0 ? (real)NAN : (real)INFINITY;
    swing();
    input.leg[SIDE_LEFT].leg_angle_rad = wrong;
    input.leg[SIDE_LEFT].ankle_extension_m = wrong;
    input.sea[SIDE_LEFT].precompression_m = wrong;
    const struct controller_input values = screened();
    ck_assert(isfinite(values.leg[SIDE_LEFT].leg_angle_rad));
    ck_assert(values.leg[SIDE_LEFT].ankle_extension_m == REAL(0.0));
    ck_assert(values.sea[SIDE_LEFT].precompression_m == REAL(0.0));
}
END_TEST

/* 50 ticks at the last rate, then it stays where it is. */
START_TEST(a_lost_angle_does_not_run_away)
{
    swing();
    const real last = input.leg[SIDE_LEFT].leg_angle_rad;
    struct controller_input values = input;
    for (uint16_t age = 1; age < 1000; age++) {
        input.leg[SIDE_LEFT].age_ticks = age;
        values = screened();
    }
    assert_close((double)(values.leg[SIDE_LEFT].leg_angle_rad - last), 0.05, 1e-4, 0.0);
}
END_TEST

/* What was bridged counts in the rate, too: a leg at 1 rad/s that was lost for five ticks is bridged at
 * 1 rad/s again. */
START_TEST(a_leg_that_comes_back_has_kept_its_rate)
{
    swing();
    for (int round = 0; round < 3; round++) {
        for (uint16_t age = 1; age <= 5; age++) {
            input.leg[SIDE_LEFT].leg_angle_rad += REAL(0.001);
            input.leg[SIDE_LEFT].age_ticks = age;
            const struct controller_input values = screened();
            assert_close((double)values.leg[SIDE_LEFT].leg_angle_rad,
                         (double)input.leg[SIDE_LEFT].leg_angle_rad, 1e-6, 0.0);
        }
        input.leg[SIDE_LEFT].leg_angle_rad += REAL(0.001);
        input.leg[SIDE_LEFT].age_ticks = 0;
        (void)screened();
    }
    /* And where it came back elsewhere, at the mean rate of the ticks since: 1 rad/s up to here, then
     * five ticks to 0.01 rad farther than bridged: (0.01 + 5 * 0.001) / 6 a tick. */
    for (uint16_t age = 1; age <= 5; age++) {
        input.leg[SIDE_LEFT].age_ticks = age;
        (void)screened();
    }
    input.leg[SIDE_LEFT].age_ticks = 0;
    input.leg[SIDE_LEFT].leg_angle_rad += REAL(0.015);
    const real back = screened().leg[SIDE_LEFT].leg_angle_rad;
    input.leg[SIDE_LEFT].age_ticks = 1;
    assert_close((double)(screened().leg[SIDE_LEFT].leg_angle_rad - back), 0.015 / 6.0, 1e-6, 0.0);
}
END_TEST

/* Whether a jump of the left angle is accepted after so many lost samples. */
static bool angle_is_accepted(double jump_rad, int lost)
{
    setup();
    for (int i = 0; i < 3; i++) {
        (void)screened();
    }
    for (int i = 0; i < lost; i++) {
        input.leg[SIDE_LEFT].age_ticks = (uint16_t)(i + 1);
        (void)screened();
    }
    input.leg[SIDE_LEFT].age_ticks = 0;
    input.leg[SIDE_LEFT].leg_angle_rad = (real)jump_rad;
    return screened().leg[SIDE_LEFT].leg_angle_rad == (real)jump_rad;
}

/* A leg swings at 6 sqrt(g/l) at most, a sample has 0.02 rad of noise; after lost samples it may
 * have gone that much farther. */
START_TEST(an_angle_may_change_so_much_and_no_more)
{
    const double a_tick = 6.0 * sqrt(9.81) * 1e-3;
    for (int lost = 0; lost < 4; lost++) {
        const double most = a_tick * (lost + 1) + 0.02;
        ck_assert(angle_is_accepted(0.98 * most, lost));
        ck_assert(angle_is_accepted(-0.98 * most, lost));
        ck_assert(!angle_is_accepted(1.02 * most, lost));
        ck_assert(!angle_is_accepted(-1.02 * most, lost));
    }
}
END_TEST

/* The ankle at 6 sqrt(g l), the motor at twice its reference's limit; noise 0.5 and 0.2 % of the leg. */
START_TEST(an_ankle_and_a_motor_may_move_so_much_and_no_more)
{
    const double ankle = 6.0 * sqrt(9.81) * (double)CONTROL_PERIOD_S + 0.005,
                 motor = 2.0 * 1.5 * (double)CONTROL_PERIOD_S + 0.002;
    for (int beyond = 0; beyond < 2; beyond++) {
        const double factor = beyond != 0 ? 1.02 : 0.98;
        setup();
        (void)screened();
        input.leg[SIDE_RIGHT].ankle_extension_m = (real)(factor * ankle);
        input.sea[SIDE_RIGHT].precompression_m = (real)(factor * motor);
        const struct controller_input values = screened();
        ck_assert_int_eq(values.leg[SIDE_RIGHT].ankle_extension_m > REAL(0.0), beyond == 0);
        ck_assert_int_eq(values.sea[SIDE_RIGHT].precompression_m > REAL(0.0), beyond == 0);
    }
}
END_TEST

/* 0.007 m are more than one tick of the fastest motor, and less than two: an encoder that jumps so far stays
 * rejected. 0.02 m are seven ticks, and one that was silent so long may have moved there. After 120 ms, in which a
 * walk has ended, the new place counts. */
START_TEST(a_motor_s_jump_is_no_motion_however_long_it_lasts)
{
    (void)screened();
    input.sea[SIDE_LEFT].precompression_m = REAL(0.007);
    input.sea[SIDE_RIGHT].precompression_m = REAL(0.02);
    input.sea[SIDE_RIGHT].age_ticks = 1;
    for (uint16_t i = 1; i <= TICKS_OF_MS(120); i++) {
        const struct controller_input values = screened();
        ck_assert(values.sea[SIDE_LEFT].precompression_m == REAL(0.0));
        ck_assert_uint_eq(samples.leg[SIDE_LEFT].motor_rejected_ticks, i);
        if (i == 7) {
            input.sea[SIDE_RIGHT].age_ticks = 0; /* six answers were lost */
        }
        ck_assert_int_eq(values.sea[SIDE_RIGHT].precompression_m > REAL(0.0), i > 7);
    }
    ck_assert(screened().sea[SIDE_LEFT].precompression_m == REAL(0.0));
    ck_assert(screened().sea[SIDE_LEFT].precompression_m == REAL(0.007));
    ck_assert_uint_eq(samples.leg[SIDE_LEFT].motor_missing_ticks, 0);
}
END_TEST

/* Two wrong answers in a row may be corrupted frames. After a third the right place is not believed either, for 120 ms:
 * a drive leads a reading that has jumped back to where it was. Lost answers do not count among the three. */
START_TEST(three_wrong_answers_are_a_jump)
{
    for (int wrong = 1; wrong <= 4; wrong++) {
        for (int lost = 0; lost < 2; lost++) {
            setup();
            (void)screened();
            input.sea[SIDE_LEFT].precompression_m = REAL(0.04);
            for (int i = 0; i < wrong + lost; i++) {
                input.sea[SIDE_LEFT].age_ticks = lost == 1 && i == 1 ? 1 : 0;
                (void)screened();
            }
            input.sea[SIDE_LEFT].age_ticks = 0;
            input.sea[SIDE_LEFT].precompression_m = REAL(0.001);
            const bool taken = screened().sea[SIDE_LEFT].precompression_m == REAL(0.001);
            ck_assert_int_eq(taken, wrong < 3);
            for (int i = wrong + lost + 1; i <= TICKS_OF_MS(120) && !taken; i++) {
                ck_assert(screened().sea[SIDE_LEFT].precompression_m == REAL(0.0));
            }
            ck_assert(screened().sea[SIDE_LEFT].precompression_m == REAL(0.001));
        }
    }
}
END_TEST

/* What was not received in this tick is not taken, however well it would fit; each value by its own age. */
START_TEST(what_is_old_is_not_taken)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        setup();
        input.leg[side].ankle_extension_m = REAL(0.01);
        input.sea[side].precompression_m = REAL(0.02);
        (void)screened();
        input.leg[side].ankle_extension_m = REAL(0.011);
        input.leg[side].leg_angle_rad = REAL(0.001);
        input.leg[side].age_ticks = 1;
        input.sea[side].precompression_m = REAL(0.021);
        input.sea[side].age_ticks = 1;
        const struct controller_input values = screened();
        assert_close((double)values.leg[side].leg_angle_rad, 0.0, 1e-9, 0.0);
        assert_close((double)values.leg[side].ankle_extension_m, 0.01, 1e-9, 0.0);
        assert_close((double)values.sea[side].precompression_m, 0.02, 1e-9, 0.0);
        ck_assert_uint_eq(values.leg[side].age_ticks, 1); /* ages stay as received */
        ck_assert_uint_eq(values.sea[side].age_ticks, 1);
        input.sea[side].age_ticks = 0; /* the motor's telegram comes, the leg's does not */
        ck_assert(screened().sea[side].precompression_m == REAL(0.021));
        input.leg[side].age_ticks = 0;
        ck_assert(screened().leg[side].ankle_extension_m == REAL(0.011));
        ck_assert_uint_eq(samples.leg[side].angle_rejected_ticks, 0);
        ck_assert_uint_eq(samples.leg[side].extension_rejected_ticks, 0);
        ck_assert_uint_eq(samples.leg[side].motor_rejected_ticks, 0);
    }
}
END_TEST

/* After lost samples an ankle and a motor may have gone farther, too: by their fastest of each tick. */
START_TEST(a_lost_ankle_and_motor_may_have_gone_farther)
{
    for (int lost = 1; lost < 6; lost++) {
        const double ankle = 6.0 * sqrt(9.81) * (double)CONTROL_PERIOD_S * (lost + 1) + 0.005;
        const double motor = 2.0 * 1.5 * (double)CONTROL_PERIOD_S * (lost + 1) + 0.002;
        for (int beyond = 0; beyond < 2; beyond++) {
            const double factor = beyond != 0 ? -1.01 : -0.99;
            setup();
            (void)screened();
            for (int i = 1; i <= lost; i++) {
                input.leg[SIDE_LEFT].age_ticks = input.sea[SIDE_LEFT].age_ticks = (uint16_t)i;
                (void)screened();
                ck_assert_uint_eq(samples.leg[SIDE_LEFT].extension_rejected_ticks, (unsigned)i);
                ck_assert_uint_eq(samples.leg[SIDE_LEFT].motor_rejected_ticks, (unsigned)i);
            }
            input.leg[SIDE_LEFT].age_ticks = input.sea[SIDE_LEFT].age_ticks = 0;
            input.leg[SIDE_LEFT].ankle_extension_m = (real)(factor * ankle);
            input.sea[SIDE_LEFT].precompression_m = (real)(factor * motor);
            const struct controller_input values = screened();
            ck_assert_int_eq(values.leg[SIDE_LEFT].ankle_extension_m < REAL(0.0), beyond == 0);
            ck_assert_int_eq(values.sea[SIDE_LEFT].precompression_m < REAL(0.0), beyond == 0);
        }
    }
}
END_TEST

/* Speeds scale with the leg: sqrt(g/l) of its angle, sqrt(g l) of its ankle; the noise of a length with l. */
START_TEST(limits_scale_with_the_leg)
{
    const double leg_m = 0.5;
    const double angle = 6.0 * sqrt(9.81 / leg_m) * (double)CONTROL_PERIOD_S + 0.02;
    const double ankle = 6.0 * sqrt(9.81 * leg_m) * (double)CONTROL_PERIOD_S + 0.005 * leg_m;
    const double motor = 2.0 * 1.5 * (double)CONTROL_PERIOD_S + 0.002 * leg_m;
    for (int beyond = 0; beyond < 2; beyond++) {
        const double factor = beyond != 0 ? 1.01 : 0.99;
        setup();
        params.leg_length_m = (real)leg_m;
        (void)screened();
        input.leg[SIDE_LEFT].leg_angle_rad = (real)(factor * angle);
        input.leg[SIDE_LEFT].ankle_extension_m = (real)(factor * ankle);
        input.sea[SIDE_LEFT].precompression_m = (real)(factor * motor);
        const struct controller_input values = screened();
        ck_assert_int_eq(values.leg[SIDE_LEFT].leg_angle_rad > REAL(0.0), beyond == 0);
        ck_assert_int_eq(values.leg[SIDE_LEFT].ankle_extension_m > REAL(0.0), beyond == 0);
        ck_assert_int_eq(values.sea[SIDE_LEFT].precompression_m > REAL(0.0), beyond == 0);
    }
}
END_TEST

/* Told as received, number or not, of either leg and of each of its three values. */
START_TEST(what_was_received_is_told)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int value = 0; value < 3; value++) {
            setup();
            (void)screened();
            ck_assert(samples.leg[side].received_finite);
            real *const places[] = {&input.leg[side].leg_angle_rad,
                                    &input.leg[side].ankle_extension_m,
                                    &input.sea[side].precompression_m};
            *places[value] = (real)NAN;
            (void)screened();
            ck_assert(!samples.leg[side].received_finite);
            ck_assert(samples.leg[1 - side].received_finite);
        }
        setup();
        (void)screened();
        input.leg[side].leg_angle_rad = REAL(0.9);
        (void)screened();
        ck_assert(samples.leg[side].received_rad == REAL(0.9));
        samples_init(&samples); /* nothing is remembered: any first sample is taken again */
        ck_assert(screened().leg[side].leg_angle_rad == REAL(0.9));
        ck_assert(samples.leg[side].received_rad == REAL(0.9));
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("samples");
    TCase *tests = tcase_create("all");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_add_test(tests, any_first_sample_is_accepted);
    tcase_add_test(tests, one_wild_sample_is_bridged_at_the_last_rate);
    tcase_add_loop_test(tests, what_is_not_finite_is_replaced, 0, 2);
    tcase_add_test(tests, a_lost_angle_does_not_run_away);
    tcase_add_test(tests, a_leg_that_comes_back_has_kept_its_rate);
    tcase_add_test(tests, an_angle_may_change_so_much_and_no_more);
    tcase_add_test(tests, an_ankle_and_a_motor_may_move_so_much_and_no_more);
    tcase_add_test(tests, a_motor_s_jump_is_no_motion_however_long_it_lasts);
    tcase_add_test(tests, three_wrong_answers_are_a_jump);
    tcase_add_test(tests, what_is_old_is_not_taken);
    tcase_add_test(tests, a_lost_ankle_and_motor_may_have_gone_farther);
    tcase_add_test(tests, limits_scale_with_the_leg);
    tcase_add_test(tests, what_was_received_is_told);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
