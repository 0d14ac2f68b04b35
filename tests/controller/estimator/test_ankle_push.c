/* The end of an ankle's push, on pushes of known shape: the extension rises as
 * A (1 - cos w t) / 2, so its rate is A w sin(w t) / 2: highest at a quarter of the
 * period, and down to half of that at 5/12 of it. */
#include <check.h>
#include <math.h>
#include <stdlib.h>

#include "controller/estimator/ankle_push.h"
#include "controller/signals.h"
#include "tests/support/assert_close.h"

#define LEAST_1_S REAL(0.08)

struct push {
    double height, period_s, from; /* extension: from + ..., not below 0 */
    double noise, drop;            /* amplitude; share of the samples lost */
};

static double chance(void)
{
    return (double)rand() / RAND_MAX;
}

/* Lets the ankle push once, from 0.2 s on, the filter settled. Returns when the end was marked, less the
 * filter's lag; NAN if never. */
static double end_of(const struct push *p)
{
    struct ankle_push push = {0};
    double over_s = (double)NAN;
    srand(3);
    for (uint32_t tick = 1; tick < 1000; tick++) {
        const double t = fmin(fmax(1e-3 * tick - 0.2, 0.0), p->period_s);
        double extension = p->from + 0.5 * p->height * (1.0 - cos(2.0 * M_PI * t / p->period_s));
        extension += p->noise * (chance() + chance() - 1.0);
        ankle_push_update(&push, (real)fmax(extension, 0.0), chance() >= p->drop, tick > 100,
                          LEAST_1_S, tick);
        if (push.over) {
            over_s = 1e-3 * push.over_tick - (double)ANKLE_PUSH_LAG_S;
        }
    }
    return over_s;
}

START_TEST(half_of_the_peak_rate)
{
    static const struct {
        struct push push;
        double tolerance_s;
    } cases[] = {
        {{0.045, 0.25, 0.0, 0.0, 0.0}, 0.002},    {{0.045, 0.15, 0.0, 0.0, 0.0}, 0.003},
        {{0.02, 0.25, 0.0, 0.0, 0.0}, 0.002},     {{0.045, 0.25, 0.01, 0.0, 0.0}, 0.002},
        {{0.045, 0.25, -0.015, 0.0, 0.0}, 0.002}, /* seen from half way on only */
        {{0.045, 0.25, 0.0, 2e-4, 0.0}, 0.004},   {{0.045, 0.25, 0.0, 0.0, 0.2}, 0.003},
    };
    const struct push *p = &cases[_i].push;
    assert_close(end_of(p), 0.2 + p->period_s * 5.0 / 12.0, cases[_i].tolerance_s, 0.0);
}
END_TEST

/* A twitch, a slow rise, noise: no push. */
START_TEST(what_is_no_push)
{
    static const struct push cases[] = {
        {0.003, 0.25, 0.0, 0.0, 0.0}, {0.045, 3.0, 0.0, 0.0, 0.0}, {0.0, 0.25, 0.02, 2e-4, 0.0}};
    ck_assert(isnan(end_of(&cases[_i])));
}
END_TEST

/* The last push is what counts: a heel's small rise before it does not. */
START_TEST(a_smaller_rise_before_it)
{
    struct ankle_push push = {0};
    for (uint32_t tick = 1; tick < 600; tick++) {
        const double t = 1e-3 * tick;
        const double heel = 0.5 * 0.012 * (1.0 - cos(2.0 * M_PI * fmin(t, 0.1) / 0.2));
        const double calf = t < 0.2 ? 0.0 : 0.5 * 0.04 * (1.0 - cos(2.0 * M_PI * (t - 0.2) / 0.25));
        ankle_push_update(&push, (real)(heel + calf), true, true, LEAST_1_S, tick);
        if (tick == 150) {
            ck_assert(push.over);
        } else if (tick == 260) {
            ck_assert(ankle_push_under_way(&push, LEAST_1_S));
        }
    }
    assert_close(1e-3 * push.over_tick - (double)ANKLE_PUSH_LAG_S, 0.2 + 0.25 * 5.0 / 12.0, 0.003,
                 0.0);
}
END_TEST

START_TEST(forgotten_when_it_may_not_push)
{
    struct ankle_push push = {0};
    for (uint32_t tick = 1; tick < 200; tick++) {
        ankle_push_update(&push, (real)(2e-4 * tick), true, true, LEAST_1_S, tick);
    }
    ck_assert(ankle_push_under_way(&push, LEAST_1_S));
    ankle_push_update(&push, REAL(0.04), true, false, LEAST_1_S, 200);
    ck_assert(!ankle_push_under_way(&push, LEAST_1_S));
    ck_assert(!push.over);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("ankle_push");
    TCase *tcase = tcase_create("push");
    tcase_add_loop_test(tcase, half_of_the_peak_rate, 0, 7);
    tcase_add_loop_test(tcase, what_is_no_push, 0, 3);
    tcase_add_test(tcase, a_smaller_rise_before_it);
    tcase_add_test(tcase, forgotten_when_it_may_not_push);
    suite_add_tcase(suite, tcase);
    return run_suite(suite);
}
