/* The studies that walk on the batch engine against the scalar map, stride by stride: another integrator, events
 * located another way, one walker at a time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/gait/branch.h"
#include "sim_host/random/rng.h"
#include "sim_host/study/noisy_map.h"
#include "sim_host/study/paper/basin_walks.h"
#include "sim_host/study/paper/long_runs.h"
#include "sim_host/study/paper/periodic.h"
#include "tests/support/assert_close.h"

static const struct walker_params adult = {65.0, 2.5, 0.93, 7000.0, 9.80665};

static struct problem problem_at(const struct walker_params *params, double r0, double kp,
                                 double x[3])
{
    struct problem problem = {.params = *params, .r0_m = r0, .kp = kp, .period = 1};
    struct orbit scratch;
    ck_assert_int_eq(branch_find(BRANCH_LONG, params, r0, x, NULL), 1);
    memcpy(problem.reference_x, x, sizeof problem.reference_x);
    ck_assert_int_eq(problem_prepare(&problem, &scratch), ORBIT_OK);
    return problem;
}

static struct basin_end scalar_walk(const struct basin_start *start, int strides)
{
    struct basin_end end = {BASIN_WALKS_ON, 0, STRIDE_OK};
    double x[3] = {start->x[0], start->x[1], start->x[2]};
    for (; end.strides < strides; end.strides++) {
        double next[3], r0;
        struct stride_result result;
        int near = 1;
        for (int k = 0; k < 3; k++) {
            near = near && fabs(x[k] - start->gait[k]) < BASIN_NEAR;
        }
        if (near) {
            end.outcome = BASIN_CONVERGES;
            return end;
        }
        end.fault = problem_stride(start->problem, x, next, &r0, &result);
        if (end.fault != STRIDE_OK) {
            end.outcome = BASIN_FALLS;
            return end;
        }
        memcpy(x, next, sizeof x);
    }
    return end;
}

/* A grid around the gait; returns how many starts found it. */
static int compare_basins(const struct walker_params *params, double r0, double kp)
{
    enum { SIDE = 9, COUNT = SIDE * SIDE * SIDE, STRIDES = 60 };
    static struct basin_start starts[COUNT];
    static struct basin_end ends[COUNT];
    double gait[3];
    const struct problem problem = problem_at(params, r0, kp, gait);
    int converged = 0, fell = 0;
    for (int i = 0; i < COUNT; i++) {
        const int place[3] = {i / (SIDE * SIDE), i / SIDE % SIDE, i % SIDE};
        static const double range[3] = {0.15, 0.1, 0.6};
        starts[i] = (struct basin_start){&problem, gait, {0.0, 0.0, 0.0}};
        for (int k = 0; k < 3; k++) {
            starts[i].x[k] = gait[k] + range[k] * (2.0 * place[k] / (SIDE - 1) - 1.0);
        }
    }
    ck_assert_int_eq(basin_walks(starts, COUNT, STRIDES, ends), 0);
    for (int i = 0; i < COUNT; i++) {
        const struct basin_end want = scalar_walk(&starts[i], STRIDES);
        ck_assert_int_eq((int)ends[i].outcome, (int)want.outcome);
        ck_assert_int_eq(ends[i].strides, want.strides);
        /* A law that asks for less than nothing is told at once, by the scalar map when it gets there. */
        ck_assert(ends[i].fault == want.fault || ends[i].fault == STRIDE_BAD_INPUT);
        converged += want.outcome == BASIN_CONVERGES;
        fell += want.outcome == BASIN_FALLS;
    }
    ck_assert_int_gt(fell, COUNT / 10);
    return converged;
}

START_TEST(basins_are_those_of_the_scalar_map)
{
    const struct walker_params paper = walker_paper_params();
    ck_assert_int_gt(compare_basins(&paper, 0.05, 0.0), 20);
    ck_assert_int_gt(compare_basins(&paper, 0.15, 0.042), 0);
    ck_assert_int_gt(compare_basins(&adult, 0.045, 0.0), 20);
}
END_TEST

/* Walks the samples again one by one, and carries a difference along for the exponent. */
static void check_long_run(const struct long_run_settings *settings, const struct long_run *run)
{
    double gait[3];
    const struct problem problem = problem_at(&settings->params, run->r0, settings->kp, gait);
    struct orbit orbit = {.residual = 0.0};
    double w[3] = {1.0, 0.3, 0.2}, sum = 0.0;
    for (int i = 0; i < settings->keep; i++) {
        double next[3], r0;
        struct stride_result result;
        const double *want = i + 1 < settings->keep ? run->samples[i + 1].x : run->last;
        ck_assert_int_eq(problem_stride(&problem, run->samples[i].x, next, &r0, &result),
                         STRIDE_OK);
        for (int k = 0; k < 3; k++) {
            assert_close(want[k], next[k], 1e-10, 0.0);
        }
        assert_close(run->samples[i].inter_leg_rad, result.inter_leg_rad, 1e-10, 0.0);
    }
    memcpy(orbit.x, run->last, sizeof orbit.x);
    for (int i = 0; i < settings->lyapunov; i++) {
        double moved[3], size = 0.0, before = 0.0;
        ck_assert_int_eq(orbit_evaluate(&problem, 1, &orbit), ORBIT_OK);
        for (int k = 0; k < 3; k++) {
            moved[k] = orbit.by_x[k][0] * w[0] + orbit.by_x[k][1] * w[1] + orbit.by_x[k][2] * w[2];
            size += moved[k] * moved[k];
            before += w[k] * w[k];
        }
        sum += 0.5 * log(size / before);
        for (int k = 0; k < 3; k++) {
            w[k] = moved[k] / sqrt(size);
            orbit.x[k] = orbit.next[k];
        }
    }
    /* Fifteen strides of chaos (0.45 a stride) let 1e-11 grow to 1e-8. */
    assert_close(run->lyapunov, sum / settings->lyapunov, 1e-7, 0.0);
}

START_TEST(long_runs_are_those_of_the_scalar_map)
{
    enum { RUNS = 8, KEEP = 40 };
    static const double r0[RUNS] = {0.05, 0.08, 0.087, 0.096, 0.12, 0.23, 0.25, 0.28};
    static const int period[RUNS] = {1, 2, 4, 0, -1, 0, 2, 1};
    static struct long_run_sample samples[RUNS][KEEP];
    static struct long_run runs[RUNS];
    const struct long_run_settings settings = {walker_paper_params(), 0.0, 600, KEEP, 15};
    for (int i = 0; i < RUNS; i++) {
        runs[i] = (struct long_run){.r0 = r0[i], .has_gait = 1, .samples = samples[i]};
        ck_assert_int_eq(branch_find(BRANCH_LONG, &settings.params, r0[i], runs[i].gait, NULL), 1);
    }
    ck_assert_int_eq(long_runs(&settings, runs, RUNS), 0);
    for (int i = 0; i < RUNS; i++) {
        ck_assert_int_eq(runs[i].period, period[i]);
        if (period[i] >= 0) {
            check_long_run(&settings, &runs[i]);
        } else {
            ck_assert(isnan(runs[i].lyapunov));
            ck_assert_int_ne((int)runs[i].fault, STRIDE_OK);
        }
    }
}
END_TEST

START_TEST(a_law_moves_a_long_run_to_its_gait)
{
    static struct long_run_sample samples[8];
    struct long_run run = {.r0 = 0.2, .has_gait = 1, .samples = samples};
    const struct long_run_settings settings = {walker_paper_params(), 0.042, 400, 8, 20};
    ck_assert_int_eq(branch_find(BRANCH_LONG, &settings.params, run.r0, run.gait, NULL), 1);
    ck_assert_int_eq(long_runs(&settings, &run, 1), 0);
    ck_assert_int_eq(run.period, 1);
    ck_assert_double_lt(run.lyapunov, -0.1);
    check_long_run(&settings, &run);
}
END_TEST

START_TEST(noisy_walks_are_those_of_the_scalar_map_and_of_any_number_of_threads)
{
    enum { WALKS = 40, STRIDES = 25 };
    static struct noisy_walk walks[WALKS], again[WALKS];
    const struct walker_params p = walker_paper_params();
    double gait[3];
    const struct problem problem = problem_at(&p, 0.15, 0.042, gait);
    const struct noisy_law law = {p.hip_mass_kg,  p.leg_mass_kg,
                                  p.leg_length_m, p.ankle_stiffness_N_m,
                                  p.gravity_m_s2, {gait[0], gait[1], gait[2]},
                                  problem.r0_m,   problem.kp};
    int fell = 0;
    ck_assert_int_eq(noisy_map_walks(&law, 0.01, STRIDES, 7, 1, walks, WALKS), 0);
    ck_assert_int_eq(noisy_map_walks(&law, 0.01, STRIDES, 7, 3, again, WALKS), 0);
    ck_assert_mem_eq(walks, again, sizeof walks);
    for (int i = 0; i < WALKS; i++) {
        struct rng rng;
        struct apex apex = {gait[0], gait[1], gait[2]};
        int walked = 0;
        rng_init(&rng, 7, (uint64_t)i);
        for (; walked < STRIDES; walked++) {
            struct stride_result result;
            const double told = -apex.stance_rate_rad_s * (1.0 + 0.01 * rng_normal(&rng));
            const double push = fmax(0.15 + 0.042 * (told + gait[0]), 0.002);
            if (stride(&problem.walker, &problem.settings, &apex, push, &result) != STRIDE_OK) {
                break;
            }
            apex = result.next;
        }
        ck_assert_int_eq(walks[i].walked, walked);
        ck_assert_int_eq(walks[i].fell, walked < STRIDES);
        fell += walks[i].fell;
    }
    ck_assert_int_gt(fell, WALKS / 4);
    ck_assert_int_lt(fell, WALKS);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("walks");
    TCase *tests = tcase_create("walks");
    tcase_set_timeout(tests, 60);
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, basins_are_those_of_the_scalar_map);
    tcase_add_test(tests, long_runs_are_those_of_the_scalar_map);
    tcase_add_test(tests, a_law_moves_a_long_run_to_its_gait);
    tcase_add_test(tests, noisy_walks_are_those_of_the_scalar_map_and_of_any_number_of_threads);
    return run_suite(suite);
}
