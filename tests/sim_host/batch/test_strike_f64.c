/* The batch engine's strides from heel strike to heel strike against the scalar map: another method altogether. */
#include <math.h>
#include <stdlib.h>

#include "model/stride.h"
#include "sim_host/batch/batch.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/random/rng.h"
#include "tests/support/assert_close.h"

#define COUNT 3000
#define GAITS 30

static const struct batch_walker paper = {1.0, 0.01, 1.0, 100.0, 9.80665};

/* Strikes about those of steady gaits: most lead on to another, some into a fault. */
static struct batch_item *make_strikes(void)
{
    const struct gait_walker walker = gait_walker_of_paper();
    struct batch_item *items = calloc(COUNT, sizeof *items);
    struct gait_point gait[GAITS];
    struct rng rng;
    ck_assert_ptr_nonnull(items);
    ck_assert_int_eq(gait_curve(&walker, 0.02, 0.006, GAITS, gait, NULL), GAIT_CURVE_OK);
    rng_init(&rng, 9, 0);
    for (int i = 0; i < COUNT; i++) {
        const struct gait_point *g = &gait[i % GAITS];
        items[i].apex[0] = g->strike[2] * (0.8 + 0.4 * rng_uniform(&rng));
        items[i].apex[1] = g->strike[1] * (0.8 + 0.4 * rng_uniform(&rng));
        items[i].apex[2] = g->strike[3] * (0.8 + 0.4 * rng_uniform(&rng));
        items[i].push_m = g->r0_m * (0.8 + 0.4 * rng_uniform(&rng));
    }
    return items;
}

static enum stride_fault scalar(const struct batch_item *from, struct stride_result *result)
{
    const struct walker_params params = walker_paper_params();
    struct walker walker;
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    struct stride_settings settings = stride_settings_accurate(&walker);
    settings.single_step_s *= 0.5;
    settings.double_step_s *= 0.5;
    *result = (struct stride_result){.fault = STRIDE_OK};
    result->strike[STANCE_ANGLE] = -from->apex[1];
    result->strike[SWING_ANGLE] = from->apex[1];
    result->strike[STANCE_RATE] = from->apex[0];
    result->strike[SWING_RATE] = from->apex[2];
    enum stride_fault fault = stride_push_off(&walker, &settings, from->push_m, result);
    fault = fault == STRIDE_OK ? stride_from_lift_off(&walker, &settings, result) : fault;
    const struct apex apex = result->next;
    return fault == STRIDE_OK ? stride_to_strike(&walker, &settings, &apex, result) : fault;
}

START_TEST(from_strike_to_strike_as_on_the_scalar_map)
{
    struct batch_item *from = make_strikes(), *got = make_strikes();
    const struct batch_job job = {
        .walkers = &paper, .walker_count = 1, .items = got, .count = COUNT, .strides = 1};
    const struct batch_settings settings = {.accuracy = 1e-12, .from_strike = 1};
    int whole = 0, faults = 0;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    for (int i = 0; i < COUNT; i++) {
        struct stride_result want;
        const enum stride_fault fault = scalar(&from[i], &want);
        ck_assert_int_eq(got[i].fault == 0, fault == STRIDE_OK);
        if (fault != STRIDE_OK) {
            faults++;
            continue;
        }
        /* Where the walker hardly moves at the apex, errors grow: 1e-9 at the pace of a gait. */
        const double pace = fabs(want.next.stance_rate_rad_s);
        const double tolerance = 1e-9 / (pace < 0.2 ? pace * pace : 1.0);
        assert_close(got[i].apex[0], want.strike[STANCE_RATE], tolerance, 0.0);
        assert_close(got[i].apex[1], want.strike[SWING_ANGLE], tolerance, 0.0);
        assert_close(got[i].apex[2], want.strike[SWING_RATE], tolerance, 0.0);
        assert_close(got[i].times_s[0], want.apex_to_strike_s, tolerance, 0.0);
        assert_close(got[i].times_s[2], want.lift_off_to_apex_s, tolerance, 0.0);
        whole++;
    }
    ck_assert_int_gt(whole, COUNT / 4);
    ck_assert_int_gt(faults, COUNT / 20);
    free(from);
    free(got);
}
END_TEST

START_TEST(legs_apart_level_ground_and_no_derivatives_or_it_is_refused)
{
    const struct gait_walker walker = gait_walker_of_paper();
    struct gait_point gait;
    ck_assert_int_eq(gait_curve(&walker, 0.1, 0.0, 1, &gait, NULL), GAIT_CURVE_OK);
    struct batch_item items[4] = {
        {.apex = {gait.strike[2], gait.strike[1], gait.strike[3]}, .push_m = 0.1}};
    struct batch_slopes slopes[4];
    const struct batch_settings settings = {.from_strike = 1};
    struct batch_job job = {
        .walkers = &paper, .walker_count = 1, .items = items, .count = 4, .strides = 1};
    for (int i = 1; i < 4; i++) {
        items[i] = items[0];
    }
    items[0].apex[1] = 0.0;
    items[1].apex[1] = 1.6;
    items[2].slope_rad = 0.01;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(items[i].fault, STRIDE_BAD_INPUT);
    }
    ck_assert_int_eq(items[3].fault, STRIDE_OK);
    items[3].strides = 0;
    job.slopes = slopes;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    ck_assert_int_eq(items[3].fault, STRIDE_BAD_INPUT);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("batch_strike");
    TCase *tests = tcase_create("batch_strike");
    tcase_set_timeout(tests, 60);
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, from_strike_to_strike_as_on_the_scalar_map);
    tcase_add_test(tests, legs_apart_level_ground_and_no_derivatives_or_it_is_refused);
    return run_suite(suite);
}
