/* The observer's gains against the closed form of their steady state, and what the law
 * makes of a noisy speed on the ideal map. */
#include <check.h>
#include <math.h>

#include "controller/estimator/observer_gains.h"
#include "sim_host/study/noisy_map.h"
#include "sim_host/study/observer/estimators.h"
#include "sim_host/study/observer/gains.h"
#include "tests/support/assert_close.h"

/* x'' = spring x + noise(q), measured with noise r: the filter's characteristic
 * polynomial s^2 + g1 s + (g2 - spring) has g2 = spring + sqrt(spring^2 + q / r) and
 * g1 = sqrt(2 g2) (from the algebraic Riccati equation, by hand). */
START_TEST(steady_gains)
{
    const double springs[] = {1.0, -2.0};
    const struct gain_assumptions a = gain_assumptions_default();
    const double w = sqrt(9.80665);
    const double since[] = {30.0};
    double gain[1][2];
    gain_schedule(&a, springs[_i], a.stance_density, since, 1, gain);
    const double ratio =
        a.stance_density / (w * w * w) / (a.noise_rad * a.noise_rad * a.sample_s * w);
    const double rate_gain = springs[_i] + sqrt(springs[_i] * springs[_i] + ratio);
    assert_close(gain[0][1], rate_gain, 0.0, 1e-6);
    assert_close(gain[0][0], sqrt(2.0 * rate_gain), 0.0, 1e-6);
}
END_TEST

/* From total ignorance of the rate the first gains are those of a least-squares line:
 * 4/n and 6/n^2 a sample (alpha-beta filter), whatever the noise. */
START_TEST(first_gains_are_least_squares)
{
    struct gain_assumptions a = gain_assumptions_default();
    a.start_angle_rad = 5e-3;
    a.start_rate_rad_s = 3.0;
    const double since[] = {0.02};
    double gain[1][2];
    gain_schedule(&a, 1.0, 1e-12, since, 1, gain);
    assert_close(gain[0][0], 4.0 / 0.02, 0.0, 0.02);
    assert_close(gain[0][1], 6.0 / (0.02 * 0.02), 0.0, 0.02);
}
END_TEST

START_TEST(the_committed_table_is_the_computed_one)
{
    const struct gain_assumptions a = gain_assumptions_default();
    double since[OBSERVER_GAIN_KNOTS], stance[OBSERVER_GAIN_KNOTS][2],
        swing[OBSERVER_GAIN_KNOTS][2];
    for (int i = 0; i < OBSERVER_GAIN_KNOTS; i++) {
        since[i] = i == 0 ? 0.0 : 0.01 * pow(2.0, 0.5 * (i - 1)); /* two knots an octave */
        assert_close(observer_gains[i].since, since[i], 1e-6, 0.0);
    }
    gain_schedule(&a, 1.0, a.stance_density, since, OBSERVER_GAIN_KNOTS, stance);
    gain_schedule(&a, -2.0, a.swing_density, since, OBSERVER_GAIN_KNOTS, swing);
    for (int i = 0; i < OBSERVER_GAIN_KNOTS; i++) {
        for (int k = 0; k < 2; k++) {
            assert_close(observer_gains[i].stance[k], stance[i][k], 1e-5, 1e-5);
            assert_close(observer_gains[i].swing[k], swing[i][k], 1e-5, 1e-5);
        }
    }
}
END_TEST

/* model/README.md: at 0.8 rad/s an error of 0.05 % spreads the speed by 1.3 % (peak to peak over
 * tens of steps), 0.3 % by 5 %, and 1 % falls within 30 steps. */
START_TEST(noise_costs_the_law_what_is_known)
{
    struct noisy_walk walk;
    ck_assert_int_eq(noisy_map_walk(0.8, 0.042, 0.0, 100, 1, &walk), 0);
    ck_assert(!walk.fell && walk.spread < 1e-4);
    ck_assert_int_eq(noisy_map_walk(0.8, 0.042, 5e-4, 200, 1, &walk), 0);
    ck_assert(!walk.fell && walk.spread > 5e-4 && walk.spread < 5e-3);
    int falls = 0;
    for (uint64_t seed = 1; seed <= 10; seed++) {
        ck_assert_int_eq(noisy_map_walk(0.8, 0.042, 0.01, 60, seed, &walk), 0);
        falls += walk.fell;
    }
    ck_assert_int_ge(falls, 8);
}
END_TEST

START_TEST(naive_estimators_on_a_straight_fall)
{
    struct naive_estimator naive;
    bool plain, filtered;
    int seen = 0;
    naive_estimator_init(&naive, 10.0, 1000.0);
    for (int n = -300; n < 300; n++) {
        naive_estimator_update(&naive, -0.0008 * n - 0.0001, 1e-3, &plain, &filtered);
        if (plain) {
            assert_close(naive.plain_rad_s, 0.8, 1e-9, 0.0);
            seen++;
        }
        if (filtered) {
            assert_close(naive.filtered_rad_s, 0.8, 1e-3, 0.0);
            seen++;
        }
    }
    ck_assert_int_eq(seen, 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gains");
    TCase *tcase = tcase_create("gains and costs");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, steady_gains, 0, 2);
    tcase_add_test(tcase, first_gains_are_least_squares);
    tcase_add_test(tcase, the_committed_table_is_the_computed_one);
    tcase_add_test(tcase, noise_costs_the_law_what_is_known);
    tcase_add_test(tcase, naive_estimators_on_a_straight_fall);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
