/* The batch engine on ground that slopes or rises, against the scalar map: another method altogether. */
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
};
#define WALKERS ((uint32_t)(sizeof walkers / sizeof walkers[0]))

static double next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* Every fourth on level ground, the others on a slope, a rise or both. */
static struct batch_item *make_items(void)
{
    struct batch_item *items = calloc(COUNT, sizeof *items);
    uint64_t seed = 31;
    ck_assert_ptr_nonnull(items);
    for (int i = 0; i < COUNT; i++) {
        const uint32_t w = (uint32_t)i % WALKERS;
        const double pace = sqrt(walkers[w].gravity_m_s2 / walkers[w].leg_length_m / 9.80665);
        items[i].walker = w;
        items[i].apex[0] = -pace * (0.2 + 0.9 * next_random(&seed));
        items[i].apex[1] = -0.4 + 0.5 * next_random(&seed);
        items[i].apex[2] = pace * (0.6 + 3.0 * next_random(&seed));
        items[i].push_m = walkers[w].leg_length_m * (0.005 + 0.25 * next_random(&seed));
        items[i].slope_rad = i % 4 == 1 || i % 4 == 3 ? 0.16 * (next_random(&seed) - 0.5) : 0.0;
        items[i].height_rise = i % 4 == 2 || i % 4 == 3 ? 0.06 * (next_random(&seed) - 0.5) : 0.0;
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

static enum stride_fault scalar(const struct batch_item *from, struct stride_result *result)
{
    const struct batch_walker *w = &walkers[from->walker];
    const struct walker_params params = {w->hip_mass_kg, w->leg_mass_kg, w->leg_length_m,
                                         w->ankle_stiffness_N_m, w->gravity_m_s2};
    const struct apex apex = {from->apex[0], from->apex[1], from->apex[2]};
    const struct ground ground = {from->slope_rad, from->height_rise};
    struct walker walker;
    ck_assert_int_eq(walker_init(&walker, &params), WALKER_OK);
    struct stride_settings settings = stride_settings_accurate(&walker);
    settings.single_step_s *= 0.25;
    settings.double_step_s *= 0.25;
    return stride_on_ground(&walker, &settings, &apex, from->push_m, &ground, result);
}

START_TEST(one_stride_is_that_of_the_scalar_map)
{
    struct batch_item *from = make_items(), *got = make_items();
    const struct batch_job job = job_of(got, 1);
    const struct batch_settings settings = {.accuracy = 1e-12, .want_times = 1};
    int whole[4] = {0}, faults = 0, grazes = 0;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    for (int i = 0; i < COUNT; i++) {
        struct stride_result want;
        (void)scalar(&from[i], &want);
        if (got[i].fault != (int)want.fault) {
            ck_assert(from[i].height_rise != 0.0);
            grazes++;
            continue;
        }
        if (want.fault != STRIDE_OK) {
            faults++;
            continue;
        }
        whole[i % 4]++;
        /* Where the walker hardly moves, errors of a stride grow: 1e-10 at the pace of a gait. */
        const double pace = real_abs(want.next.stance_rate_rad_s);
        const double tolerance = 2e-10 / (pace < 0.2 ? pace * pace : 1.0);
        assert_close(got[i].apex[0], want.next.stance_rate_rad_s, tolerance, 0.0);
        assert_close(got[i].apex[1], want.next.swing_angle_rad, tolerance, 0.0);
        assert_close(got[i].apex[2], want.next.swing_rate_rad_s, tolerance, 0.0);
        assert_close(got[i].times_s[0], want.apex_to_strike_s, tolerance, 0.0);
        assert_close(got[i].times_s[1], want.double_support_s, 1e-9, 1e-7);
        assert_close(got[i].step_length_m, want.step_length_m, tolerance, 0.0);
        assert_close(got[i].inter_leg_rad, want.inter_leg_rad, tolerance, 0.0);
    }
    for (int kind = 0; kind < 4; kind++) {
        ck_assert_int_gt(whole[kind], COUNT / 16);
    }
    ck_assert_int_gt(faults, COUNT / 20);
    /* A toe that clears a rise for less than a step of either: only the one that looks there finds the strike. */
    ck_assert_int_le(grazes, COUNT / 500);
    free(from);
    free(got);
}
END_TEST

START_TEST(level_walkers_do_not_notice_others_on_slopes)
{
    static const int lanes[] = {0, 2, 4, 8};
    struct batch_item *mixed = make_items(), *level = make_items(), *again = make_items();
    const struct batch_settings settings = {.want_times = 1};
    const struct batch_job all = job_of(mixed, 4);
    ck_assert_int_eq(batch_run(&settings, &all), BATCH_OK);
    for (int i = 0; i < COUNT; i++) {
        level[i].fault = i % 4 == 0 ? 0 : -1;
    }
    const struct batch_job some = job_of(level, 4);
    ck_assert_int_eq(batch_run(&settings, &some), BATCH_OK);
    for (int i = 0; i < COUNT; i += 4) {
        ck_assert_mem_eq(level[i].apex, mixed[i].apex, sizeof level[i].apex);
        ck_assert_mem_eq(level[i].times_s, mixed[i].times_s, sizeof level[i].times_s);
        ck_assert_int_eq(level[i].fault, mixed[i].fault);
    }
    for (int k = 1; k < 4; k++) {
        if (batch_use_lanes(lanes[k]) != BATCH_OK) {
            continue;
        }
        struct batch_item *other = make_items();
        const struct batch_job job = job_of(other, 4);
        ck_assert_int_eq(batch_run_threads(&settings, &job, k), BATCH_OK);
        for (int i = 0; i < COUNT; i++) {
            ck_assert_mem_eq(other[i].apex, mixed[i].apex, sizeof other[i].apex);
            ck_assert_int_eq(other[i].fault, mixed[i].fault);
        }
        free(other);
    }
    ck_assert_int_eq(batch_use_lanes(0), BATCH_OK);
    free(mixed);
    free(level);
    free(again);
}
END_TEST

/* What a comparison of laws does: a law and rough ground between strides. */
struct course {
    uint64_t seed[8];
};

static int law_and_ground(void *context, size_t index, struct batch_item *item,
                          const struct batch_slopes *slopes)
{
    struct course *course = context;
    (void)slopes;
    item->push_m = 0.12 + 0.042 * (-item->apex[0] - 0.6490820649);
    item->slope_rad = 0.01 * (next_random(&course->seed[index]) - 0.5);
    item->height_rise = 0.002 * (next_random(&course->seed[index]) - 0.5);
    return 0;
}

START_TEST(a_law_on_uneven_ground_walks_as_it_does_on_the_scalar_map)
{
    struct batch_item items[8] = {{.fault = 0}};
    struct course course, again;
    const struct batch_settings settings = {.accuracy = 1e-12};
    struct batch_job job = job_of(items, 12);
    for (int i = 0; i < 8; i++) {
        course.seed[i] = again.seed[i] = (uint64_t)i;
        items[i] = (struct batch_item){.apex = {-0.6490820649, -0.08979975757, 2.581857166},
                                       .push_m = 0.12};
    }
    job.count = 8;
    job.stride_done = law_and_ground;
    job.context = &course;
    ck_assert_int_eq(batch_run_threads(&settings, &job, 2), BATCH_OK);
    for (int i = 0; i < 8; i++) {
        struct batch_item plain = {.apex = {-0.6490820649, -0.08979975757, 2.581857166},
                                   .push_m = 0.12};
        for (int k = 0; k < 12 && plain.fault == 0; k++) {
            struct stride_result result;
            plain.fault = (int32_t)scalar(&plain, &result);
            plain.apex[0] = result.next.stance_rate_rad_s;
            plain.apex[1] = result.next.swing_angle_rad;
            plain.apex[2] = result.next.swing_rate_rad_s;
            plain.strides += plain.fault == 0;
            law_and_ground(&again, (size_t)i, &plain, NULL);
        }
        ck_assert_int_eq(items[i].strides, plain.strides);
        ck_assert_int_ge(plain.strides, 3);
        ck_assert_int_eq(items[i].fault, plain.fault);
        for (int k = 0; k < 3 && plain.fault == 0; k++) {
            assert_close(items[i].apex[k], plain.apex[k], 1e-7, 0.0);
        }
    }
}
END_TEST

START_TEST(bad_ground_is_refused)
{
    struct batch_item items[4] = {{.apex = {-0.4069, -0.0596, 1.7568}, .push_m = 0.05}};
    struct batch_slopes slopes[4];
    const struct batch_settings settings = {0};
    struct batch_job job = job_of(items, 1);
    for (int i = 1; i < 4; i++) {
        items[i] = items[0];
    }
    items[0].slope_rad = 1.58;
    items[1].height_rise = (double)NAN;
    items[2].slope_rad = 0.01;
    job.count = 4;
    job.slopes = slopes;
    ck_assert_int_eq(batch_run(&settings, &job), BATCH_OK);
    ck_assert_int_eq(items[0].fault, STRIDE_BAD_INPUT);
    ck_assert_int_eq(items[1].fault, STRIDE_BAD_INPUT);
    ck_assert_int_eq(items[2].fault, STRIDE_BAD_INPUT); /* no derivatives there */
    ck_assert_int_eq(items[3].fault, STRIDE_OK);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("batch_ground");
    TCase *tests = tcase_create("batch_ground");
    tcase_set_timeout(tests, 60);
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, one_stride_is_that_of_the_scalar_map);
    tcase_add_test(tests, level_walkers_do_not_notice_others_on_slopes);
    tcase_add_test(tests, a_law_on_uneven_ground_walks_as_it_does_on_the_scalar_map);
    tcase_add_test(tests, bad_ground_is_refused);
    return run_suite(suite);
}
