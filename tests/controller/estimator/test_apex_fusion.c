/* Whom to believe at an apex: a quiet model or the noisy samples, on made-up steps whose
 * truth is known. */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "controller/estimator/apex_fusion.h"
#include "tests/support/assert_close.h"

#define NOISE_RAD 4e-4 /* one count of 14 bit */
#define SPEED 0.8
#define WINDOW 80u

/* Standard error of a cubic's slope at the centre of 2 w + 1 samples, w large: 2.5 sqrt(3) noise
 * over w sqrt(2 w), per sample (Savitzky & Golay 1964, from their weights). */
#define SLOPE_SCATTER (4.33 * NOISE_RAD / (1e-3 * WINDOW * 12.65))

static double normal(void)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        sum += (double)rand() / RAND_MAX;
    }
    return sum;
}

static struct apex_estimate estimate(double speed, double scatter)
{
    return (struct apex_estimate){(real)(-speed + scatter * normal()),
                                  (real)(-0.06 + 0.1 * scatter * normal()),
                                  (real)(1.7 + scatter * normal()), REAL(0.0)};
}

static const struct apex_noise noise = {(real)(NOISE_RAD * NOISE_RAD), REAL(0.0)};

static struct apex_estimate decide(struct apex_fusion *fusion, enum side side,
                                   const struct apex_estimate *fit, double model_speed)
{
    const struct apex_estimate model = estimate(model_speed, 0.05 * SLOPE_SCATTER);
    return apex_fusion_decide(fusion, side, fit, &model, &noise, WINDOW);
}

static void start(struct apex_fusion *fusion)
{
    srand(5);
    apex_fusion_init(fusion);
}

START_TEST(where_they_agree_the_quieter_is_believed)
{
    struct apex_fusion fusion;
    double squares = 0.0, fit_squares = 0.0;
    start(&fusion);
    for (int step = 0; step < 400; step++) {
        const struct apex_estimate fit = estimate(SPEED, SLOPE_SCATTER);
        const struct apex_estimate said = decide(&fusion, (enum side)(step % 2), &fit, SPEED);
        squares += pow((double)said.stance_rate_rad_s + SPEED, 2);
        fit_squares += pow((double)fit.stance_rate_rad_s + SPEED, 2);
    }
    ck_assert(fusion.model_weight > REAL(0.9));
    ck_assert(squares < fit_squares / 25.0);
}
END_TEST

/* A model of another walker, off by the same in every step, and not alike on both legs. */
START_TEST(a_steady_difference_is_learned_for_each_leg)
{
    const double off[SIDE_COUNT] = {0.008, -0.004};
    struct apex_fusion fusion;
    double worst = 0.0, mean = 0.0;
    start(&fusion);
    for (int step = 0; step < 300; step++) {
        const enum side side = (enum side)(step % 2);
        const struct apex_estimate fit = estimate(SPEED, SLOPE_SCATTER);
        const struct apex_estimate said = decide(&fusion, side, &fit, SPEED + off[side]);
        if (step >= 200) {
            worst = fmax(worst, fabs((double)said.stance_rate_rad_s + SPEED));
            mean += ((double)said.stance_rate_rad_s + SPEED) / 100.0;
        }
    }
    ck_assert(fusion.model_weight > REAL(0.9));
    ck_assert(worst < 1.5 * SLOPE_SCATTER); /* the learned mean's own scatter is in it */
    ck_assert(fabs(mean) < 0.5 * SLOPE_SCATTER);
}
END_TEST

/* The body leaves the model little by little: what is said follows the samples, at no step
 * further from them than where the two still count as agreeing, and without a jump. */
START_TEST(parting_makes_no_jump)
{
    const double tolerance = 3.5 * SLOPE_SCATTER + 0.001 * SPEED;
    struct apex_fusion fusion;
    double before = SPEED, biggest = 0.0;
    start(&fusion);
    for (int step = 0; step < 200; step++) {
        const double body = SPEED + (step > 50 ? 2e-3 * fmin(step - 50, 100) : 0.0);
        const struct apex_estimate fit = estimate(body, 0.0);
        const double said = -(double)decide(&fusion, SIDE_LEFT, &fit, SPEED).stance_rate_rad_s;
        ck_assert(fabs(said - body) < 1.5 * tolerance);
        biggest = fmax(biggest, fabs(said - before));
        before = said;
    }
    ck_assert(fusion.model_weight == REAL(0.0)); /* off by a quarter: another body */
    assert_close(before, SPEED + 0.2, 1e-6, 0.0);
    ck_assert(biggest < tolerance);
}
END_TEST

START_TEST(a_single_wrong_model_is_passed_over)
{
    struct apex_fusion fusion;
    start(&fusion);
    for (int step = 0; step < 60; step++) {
        const struct apex_estimate fit = estimate(SPEED, SLOPE_SCATTER);
        const struct apex_estimate said =
            decide(&fusion, SIDE_LEFT, &fit, step == 50 ? 1.5 * SPEED : SPEED);
        if (step == 50) {
            ck_assert(said.confidence == REAL(0.0));
            ck_assert(said.stance_rate_rad_s == fit.stance_rate_rad_s);
        }
    }
}
END_TEST

/* Without a model the samples stand; model_weight comes back by a quarter a step. */
START_TEST(trust_comes_back_over_some_steps)
{
    struct apex_fusion fusion;
    start(&fusion);
    for (int step = 0; step < 40; step++) {
        const struct apex_estimate fit = estimate(SPEED, 0.2 * SLOPE_SCATTER);
        if (step == 30) {
            const struct apex_estimate alone =
                apex_fusion_decide(&fusion, SIDE_LEFT, &fit, NULL, &noise, WINDOW);
            ck_assert(alone.confidence == REAL(0.0));
            ck_assert(alone.stance_rate_rad_s == fit.stance_rate_rad_s);
            continue;
        }
        const struct apex_estimate said = decide(&fusion, SIDE_LEFT, &fit, SPEED);
        if (step > 30) {
            assert_close((double)said.confidence, fmin(1.0, 0.25 * (step - 30)), 1e-6, 0.0);
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("apex_fusion");
    TCase *tcase = tcase_create("fusion");
    tcase_add_test(tcase, where_they_agree_the_quieter_is_believed);
    tcase_add_test(tcase, a_steady_difference_is_learned_for_each_leg);
    tcase_add_test(tcase, parting_makes_no_jump);
    tcase_add_test(tcase, a_single_wrong_model_is_passed_over);
    tcase_add_test(tcase, trust_comes_back_over_some_steps);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
