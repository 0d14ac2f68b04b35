/* The noise against the statistics of a first-order process, from its formula. */
#include "sim_host/reflex/reflex_noise.h"
#include "tests/support/assert_close.h"

#include <math.h>
#include <string.h>

enum { SECONDS = 400, LAG_MS = 50 };
static const double share = 0.02;

/* n of a muscle that is stimulated by 0.5. */
static double next(struct reflex_noise *noise, enum side side, enum muscle_id id)
{
    double stimulation[MUSCLE_COUNT];
    for (int i = 0; i < MUSCLE_COUNT; i++) {
        stimulation[i] = 0.5;
    }
    reflex_noise_add(noise, share, side, stimulation);
    return (stimulation[id] / 0.5 - 1.0) / share;
}

START_TEST(it_has_the_stated_size_and_memory)
{
    struct reflex_noise noise;
    double sum = 0.0, squares = 0.0, products = 0.0, past[LAG_MS] = {0.0};
    const int count = 1000 * SECONDS;
    reflex_noise_init(&noise, 5);
    for (int i = 0; i < count; i++) {
        const double n = next(&noise, SIDE_RIGHT, MUSCLE_GAS);
        sum += n;
        squares += n * n;
        products += n * past[i % LAG_MS];
        past[i % LAG_MS] = n;
    }
    /* 400 s hold 4,000 times the memory: three deviations of each estimate */
    assert_close(sum / count, 0.0, 3.0 * sqrt(2.0 * 0.05 / SECONDS), 0.0);
    assert_close(squares / count, 1.0, 3.0 * sqrt(2.0 * 0.05 / SECONDS), 0.0);
    assert_close(products / count, exp(-1.0), 0.06, 0.0); /* a memory of 50 ms */
}
END_TEST

START_TEST(it_grows_with_the_command)
{
    struct reflex_noise one, two;
    double quiet[MUSCLE_COUNT], loud[MUSCLE_COUNT];
    reflex_noise_init(&one, 9);
    memcpy(&two, &one, sizeof two);
    for (int i = 0; i < MUSCLE_COUNT; i++) {
        quiet[i] = 0.1 * i;
        loud[i] = 0.2 * i;
    }
    reflex_noise_add(&one, share, SIDE_LEFT, quiet);
    reflex_noise_add(&two, share, SIDE_LEFT, loud);
    ck_assert(quiet[0] == 0.0);
    for (int i = 1; i < MUSCLE_COUNT; i++) {
        ck_assert(quiet[i] != 0.1 * i);
        assert_close(loud[i], 2.0 * quiet[i], 1e-15, 0.0);
    }
}
END_TEST

START_TEST(muscles_and_seeds_differ)
{
    struct reflex_noise noise, other;
    double together = 0.0, seeds = 0.0;
    reflex_noise_init(&noise, 1);
    reflex_noise_init(&other, 2);
    const int count = 1000 * SECONDS;
    for (int i = 0; i < count; i++) {
        struct reflex_noise same = noise;
        const double left = next(&noise, SIDE_LEFT, MUSCLE_SOL),
                     right = next(&same, SIDE_RIGHT, MUSCLE_SOL);
        together += left * right;
        seeds += left * next(&other, SIDE_LEFT, MUSCLE_SOL);
    }
    assert_close(together / count, 0.0, 0.05, 0.0);
    assert_close(seeds / count, 0.0, 0.05, 0.0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("reflex_noise");
    TCase *tests = tcase_create("all");
    tcase_add_test(tests, it_has_the_stated_size_and_memory);
    tcase_add_test(tests, it_grows_with_the_command);
    tcase_add_test(tests, muscles_and_seeds_differ);
    suite_add_tcase(suite, tests);
    return run_suite(suite);
}
