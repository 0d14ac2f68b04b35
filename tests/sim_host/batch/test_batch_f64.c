/* The batch engine against the scalar map (another method altogether), and against itself: other vectors, other
 * threads, other company in the block must not change a bit. Derivatives against differences. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/stride.h"
#include "sim_host/batch/batch.h"
#include "tests/support/assert_close.h"

#define COUNT 3000

static const struct batch_walker walkers[] = {
    {1.0, 0.01, 1.0, 100.0, 9.80665},   /* the paper's */
    {65.0, 2.5, 0.93, 7000.0, 9.80665}, /* an adult */
    {1.0, 0.2, 1.0, 60.0, 9.80665},     /* heavy legs, weak spring */
    {1.0, 0.0, 0.4, 400.0, 1.62},       /* massless legs, on the moon */
};
#define WALKERS ((uint32_t)(sizeof walkers / sizeof walkers[0]))

/* Numbers without a library: the same on every machine. */
static double next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* Apexes in and around the region where walkers walk, scaled to each walker. */
static struct batch_item *make_items(void)
{
    struct batch_item *items = calloc(COUNT, sizeof *items);
    uint64_t seed = 20;
    ck_assert_ptr_nonnull(items);
    for (int i = 0; i < COUNT; i++) {
        const uint32_t w = (uint32_t)i % WALKERS;
        const double pace = sqrt(walkers[w].gravity_m_s2 / walkers[w].leg_length_m / 9.80665);
        items[i].walker = w;
        /* Every third one strides out so far that the clamp may act. */
        const int fast = i % 3 == 0;
        items[i].apex[0] = -pace * ((fast ? 0.6 : 0.2) + (fast ? 1.0 : 0.6) * next_random(&seed));
        items[i].apex[1] = (fast ? -0.6 : -0.35) + (fast ? 0.9 : 0.5) * next_random(&seed);
        items[i].apex[2] = pace * ((fast ? 3.0 : 0.6) + (fast ? 1.0 : 2.0) * next_random(&seed));
        items[i].push_m = walkers[w].leg_length_m *
                          ((fast ? 0.24 : 0.005) + (fast ? 0.06 : 0.25) * next_random(&seed));
    }
    return items;
}

static struct batch_job job_of(struct batch_item *items, int64_t strides)
{
    const struct batch_job job = {.walkers = walkers,
                                  .walker_count = WALKERS,
                                  .items = items,
                                  .count = COUNT,
                                  .strides = strides};
    return job;
}

static struct walker scalar_walker(const struct batch_walker *from)
{
    const struct walker_params params = {from->hip_mass_kg, from->leg_mass_kg, from->leg_length_m,
                                         from->ankle_stiffness_N_m, from->gravity_m_s2};
    struct walker walker;
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    return walker;
}

static void assert_stride_equals_scalar(const struct batch_item *from, const struct batch_item *got,
                                        double tolerance)
{
    const struct walker walker = scalar_walker(&walkers[from->walker]);
    struct stride_settings settings = stride_settings_accurate(&walker);
    settings.single_step_s *= 0.5;
    settings.double_step_s *= 0.5;
    const struct apex apex = {from->apex[0], from->apex[1], from->apex[2]};
    struct stride_result want;
    stride(&walker, &settings, &apex, from->push_m, &want);
    /* A walker that tumbles crosses both limits between two looks; which is named depends on their spacing. */
    const int both_tumble = (got->fault == STRIDE_FALLEN || got->fault == STRIDE_INTER_LEG_ANGLE) &&
                            (want.fault == STRIDE_FALLEN || want.fault == STRIDE_INTER_LEG_ANGLE);
    ck_assert_msg(got->fault == (int)want.fault || both_tumble,
                  "fault %d, scalar map %d for %g %g %g, r0 %g, walker %u", got->fault, want.fault,
                  from->apex[0], from->apex[1], from->apex[2], from->push_m, from->walker);
    if (want.fault != STRIDE_OK) {
        return;
    }
    assert_close(got->apex[0], want.next.stance_rate_rad_s, tolerance, 0.0);
    assert_close(got->apex[1], want.next.swing_angle_rad, tolerance, 0.0);
    assert_close(got->apex[2], want.next.swing_rate_rad_s, tolerance, 0.0);
    assert_close(got->times_s[0], want.apex_to_strike_s, tolerance, 0.0);
    assert_close(got->times_s[1], want.double_support_s, tolerance, 0.0);
    assert_close(got->times_s[2], want.lift_off_to_apex_s, tolerance, 0.0);
    assert_close(got->step_length_m, want.step_length_m, tolerance, 0.0);
    assert_close(got->ankle_rate_m_s, want.ankle_rate_m_s, tolerance, 0.0);
    ck_assert_int_eq(got->clamped, want.clamped);
}

START_TEST(one_stride_is_that_of_the_scalar_map)
{
    struct batch_item *from = make_items(), *got = make_items();
    const struct batch_job job = job_of(got, 1);
    const struct batch_settings settings = {.accuracy = 1e-12, .want_times = 1};
    int whole = 0, clamped = 0, faults[STRIDE_FAULT_COUNT] = {0};
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    for (int i = 0; i < COUNT; i++) {
        assert_stride_equals_scalar(&from[i], &got[i], 2e-10);
        whole += got[i].fault == STRIDE_OK;
        clamped += got[i].fault == STRIDE_OK && got[i].clamped;
        faults[got[i].fault]++;
    }
    ck_assert_int_gt(whole, COUNT / 4);
    ck_assert_int_gt(clamped, 20);
    ck_assert_int_gt(faults[STRIDE_WALKING_BACKWARDS], 5);
    ck_assert_int_gt(faults[STRIDE_NO_ROOM_TO_EXTEND], 1);
    ck_assert_int_gt(faults[STRIDE_NO_LIFT_OFF], 5);
    free(from);
    free(got);
}
END_TEST

static int differ(const struct batch_item *a, const struct batch_item *b)
{
    int count = 0;
    for (int i = 0; i < COUNT; i++) {
        count += memcmp(a[i].apex, b[i].apex, sizeof a[i].apex) != 0 || a[i].fault != b[i].fault ||
                 a[i].strides != b[i].strides ||
                 memcmp(a[i].times_s, b[i].times_s, sizeof a[i].times_s) != 0;
    }
    return count;
}

START_TEST(bits_do_not_depend_on_lanes_or_threads)
{
    static const int lanes[] = {2, 4, 8};
    const struct batch_settings settings = {.want_times = 1};
    struct batch_item *first = make_items();
    const struct batch_job job = job_of(first, 30);
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    for (int i = 0; i < 3; i++) {
        struct batch_item *again = make_items();
        const struct batch_job other = job_of(again, 30);
        if (batch_use_lanes(lanes[i]) == BATCH_OK) {
            ck_assert_int_eq(batch_run_threads(&settings, &other, 1 + i), BATCH_OK);
            ck_assert_int_eq(differ(first, again), 0);
        }
        free(again);
    }
    ck_assert_int_eq(batch_use_lanes(0), BATCH_OK);
    free(first);
}
END_TEST

START_TEST(bits_do_not_depend_on_the_company)
{
    const struct batch_settings settings = {.want_times = 1};
    struct batch_item *all = make_items(), *alone = make_items();
    const struct batch_job job = job_of(all, 5);
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    for (int i = 0; i < COUNT; i++) {
        struct batch_job one = job_of(&alone[i], 5);
        one.count = 1;
        ck_assert_int_eq(batch_run(&settings, &one), BATCH_OK);
    }
    ck_assert_int_eq(differ(all, alone), 0);
    free(all);
    free(alone);
}
END_TEST

/* The stride with one of (apex, r0) shifted; 0 when it falls. */
static int shifted(const struct batch_item *from, int direction, double shift, double next[3])
{
    struct batch_item item = *from;
    struct batch_job job = job_of(&item, 1);
    const struct batch_settings settings = {.accuracy = 1e-12};
    job.count = 1;
    if (direction < 3) {
        item.apex[direction] += shift;
    } else {
        item.push_m += shift;
    }
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    memcpy(next, item.apex, sizeof item.apex);
    return item.fault == STRIDE_OK;
}

/* One item's derivatives against sixth-order differences; 0 when those would need a walker that falls. */
static int agree_with_differences(const struct batch_item *from, const struct batch_slopes *slopes)
{
    static const double at[6] = {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0};
    const double h = 5e-5;
    double value[4][6][3];
    for (int j = 0; j < 4; j++) {
        for (int s = 0; s < 6; s++) {
            if (!shifted(from, j, at[s] * h, value[j][s])) {
                return 0;
            }
        }
    }
    for (int j = 0; j < 4; j++) {
        for (int k = 0; k < 3; k++) {
            const double want =
                (45.0 * (value[j][3][k] - value[j][2][k]) -
                 9.0 * (value[j][4][k] - value[j][1][k]) + (value[j][5][k] - value[j][0][k])) /
                (60.0 * h);
            const double is = j < 3 ? slopes->by_apex[k][j] : slopes->by_push[k];
            assert_close(is, want, 1e-6, 1e-6);
        }
    }
    return 1;
}

START_TEST(derivatives_equal_extrapolated_differences)
{
    struct batch_item *from = make_items(), *got = make_items();
    struct batch_slopes *slopes = calloc(COUNT, sizeof *slopes);
    const struct batch_settings settings = {.accuracy = 1e-12};
    struct batch_job job = job_of(got, 1);
    int checked = 0;
    ck_assert_ptr_nonnull(slopes);
    job.slopes = slopes;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    for (int i = 0; i < COUNT && checked < 200; i++) {
        /* Near the clamp and near a fall differences see the corner. */
        if (got[i].fault != STRIDE_OK || got[i].ankle_rate_m_s < 0.05 || got[i].apex[0] > -0.2) {
            continue;
        }
        checked += agree_with_differences(&from[i], &slopes[i]);
    }
    ck_assert_int_eq(checked, 200);
    free(from);
    free(got);
    free(slopes);
}
END_TEST

START_TEST(the_papers_gait_settles_and_its_eigenvalues_follow)
{
    struct batch_item item = {.apex = {-0.4069, -0.0596, 1.7568}, .push_m = 0.05};
    struct batch_slopes slopes;
    struct batch_job job = job_of(&item, 100);
    const struct batch_settings settings = {.accuracy = 1e-12};
    job.count = 1;
    job.slopes = &slopes;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    ck_assert_int_eq(item.strides, 100);
    assert_close(item.apex[0], -0.406960, 1e-6, 0.0);
    assert_close(item.apex[1], -0.059569, 1e-6, 0.0);
    assert_close(item.apex[2], 1.756768, 1e-6, 0.0);
    /* Sum, sum of principal minors and product of -0.57144, -0.11020, 0. */
    double(*a)[3] = slopes.by_apex;
    const double minors = a[0][0] * a[1][1] - a[0][1] * a[1][0] + a[0][0] * a[2][2] -
                          a[0][2] * a[2][0] + a[1][1] * a[2][2] - a[1][2] * a[2][1];
    const double product = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
                           a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
                           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    assert_close(a[0][0] + a[1][1] + a[2][2], -0.57144 - 0.11020, 1.5e-5, 0.0);
    assert_close(minors, 0.57144 * 0.11020, 1e-5, 0.0);
    assert_close(product, 0.0, 1e-11, 0.0);
}
END_TEST

static int push_harder(void *context, size_t index, struct batch_item *item,
                       const struct batch_slopes *slopes)
{
    int *calls = context;
    (void)index;
    (void)slopes;
    (*calls)++;
    item->push_m *= 1.05;
    return item->strides == 3;
}

START_TEST(the_caller_may_step_in_after_each_stride)
{
    struct batch_item item = {.apex = {-0.4069, -0.0596, 1.7568}, .push_m = 0.05};
    struct batch_item plain = item;
    const struct batch_settings settings = {0};
    int calls = 0;
    struct batch_job job = job_of(&item, 10);
    job.count = 1;
    job.stride_done = push_harder;
    job.context = &calls;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    ck_assert_int_eq(calls, 3);
    ck_assert_int_eq(item.strides, 3);
    for (int i = 0; i < 3; i++) {
        struct batch_job one = job_of(&plain, i + 1);
        one.count = 1;
        ck_assert_int_eq(batch_run(&settings, &one), BATCH_OK);
        plain.push_m *= 1.05;
    }
    ck_assert_mem_eq(item.apex, plain.apex, sizeof item.apex);
}
END_TEST

START_TEST(the_law_holds_a_speed_at_which_the_open_gait_would_not_stay)
{
    /* Eigenvalues beyond -1 at r0 = 0.2 without the law; kp = 0.042 stabilises (paper, section 5). */
    struct batch_item item = {
        .apex = {-0.8, -0.16, 1.2}, .push_m = 0.12, .gain_m_s = 0.042, .target_speed_rad_s = 0.66};
    const struct batch_settings settings = {0};
    double by_hand = item.push_m + item.gain_m_s * (0.8 - 0.66);
    struct batch_item plain = {.apex = {-0.8, -0.16, 1.2}, .push_m = by_hand};
    struct batch_job job = job_of(&item, 1), other = job_of(&plain, 1);
    job.count = other.count = 1;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    ck_assert_int_eq(batch_run(&settings, &other), BATCH_OK);
    ck_assert_mem_eq(item.apex, plain.apex, sizeof item.apex);
}
END_TEST

START_TEST(bad_input_is_named_and_harms_nobody_else)
{
    struct batch_item items[6] = {{.apex = {-0.4069, -0.0596, 1.7568}, .push_m = 0.05}};
    struct batch_item good = items[0];
    const struct batch_settings settings = {0};
    struct batch_job job = job_of(items, 1), alone = job_of(&good, 1);
    for (int i = 1; i < 6; i++) {
        items[i] = items[0];
    }
    items[0].apex[0] = (double)NAN;
    items[1].push_m = -0.01;
    items[2].apex[2] = (double)INFINITY;
    items[3].apex[0] = 0.1;
    items[4].apex[1] = -4.0;
    job.count = 6;
    alone.count = 1;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    ck_assert_int_eq(batch_run(&settings, &alone), BATCH_OK);
    ck_assert_int_eq(items[0].fault, STRIDE_BAD_INPUT);
    ck_assert_int_eq(items[1].fault, STRIDE_BAD_INPUT);
    ck_assert_int_eq(items[2].fault, STRIDE_BAD_INPUT);
    ck_assert_int_eq(items[3].fault, STRIDE_WALKING_BACKWARDS);
    ck_assert_int_eq(items[4].fault, STRIDE_INTER_LEG_ANGLE);
    ck_assert_mem_eq(items[5].apex, good.apex, sizeof good.apex);

    const struct batch_settings vague = {.accuracy = 1.0};
    ck_assert_int_eq(batch_run(&vague, &job), BATCH_BAD_ACCURACY);
    items[2].walker = WALKERS;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_BAD_INDEX);
    const struct batch_walker upside_down = {1.0, 0.01, -1.0, 100.0, 9.8};
    alone.walkers = &upside_down;
    alone.walker_count = 1;
    ck_assert_int_eq(batch_run(&settings, &alone), BATCH_BAD_WALKER);
    ck_assert_int_eq(batch_use_lanes(3), BATCH_NO_SUCH_VECTORS);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("batch");
    TCase *tests = tcase_create("batch");
    tcase_set_timeout(tests, 60);
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, one_stride_is_that_of_the_scalar_map);
    tcase_add_test(tests, bits_do_not_depend_on_lanes_or_threads);
    tcase_add_test(tests, bits_do_not_depend_on_the_company);
    tcase_add_test(tests, derivatives_equal_extrapolated_differences);
    tcase_add_test(tests, the_papers_gait_settles_and_its_eigenvalues_follow);
    tcase_add_test(tests, the_caller_may_step_in_after_each_stride);
    tcase_add_test(tests, the_law_holds_a_speed_at_which_the_open_gait_would_not_stay);
    tcase_add_test(tests, bad_input_is_named_and_harms_nobody_else);
    return run_suite(suite);
}
