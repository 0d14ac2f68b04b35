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

/* The ankle at 6 sqrt(g l), the motor at twice its reference's limit; noise 0.5 % of the leg. */
START_TEST(an_ankle_and_a_motor_may_move_so_much_and_no_more)
{
    const double ankle = 6.0 * sqrt(9.81) * 1e-3 + 0.005, motor = 2.0 * 1.5 * 1e-3 + 0.005;
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

/* 0.02 m are seven ticks of the fastest motor: an encoder that jumps so far stays rejected, and one that was silent so
 * long may have moved there. After 120 ms, in which a walk has ended, the new place counts. */
START_TEST(a_motor_s_jump_is_no_motion_however_long_it_lasts)
{
    (void)screened();
    input.sea[SIDE_LEFT].precompression_m = input.sea[SIDE_RIGHT].precompression_m = REAL(0.02);
    input.sea[SIDE_RIGHT].age_ticks = 1;
    for (uint16_t i = 1; i <= 120; i++) {
        const struct controller_input values = screened();
        ck_assert(values.sea[SIDE_LEFT].precompression_m == REAL(0.0));
        ck_assert_uint_eq(samples.leg[SIDE_LEFT].motor_rejected_ticks, i);
        if (i == 7) {
            input.sea[SIDE_RIGHT].age_ticks = 0; /* six answers were lost */
        }
        ck_assert_int_eq(values.sea[SIDE_RIGHT].precompression_m > REAL(0.0), i > 7);
    }
    ck_assert(screened().sea[SIDE_LEFT].precompression_m == REAL(0.0));
    ck_assert(screened().sea[SIDE_LEFT].precompression_m == REAL(0.02));
    ck_assert_uint_eq(samples.leg[SIDE_LEFT].motor_missing_ticks, 0);
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
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
