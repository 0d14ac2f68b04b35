#include "sim_host/study/paper/long_runs.h"

#include <stdlib.h>
#include <string.h>

#include "sim_host/study/batch_adapter.h"
#include "sim_host/study/paper/periodic.h"
#include "sim_host/study/report.h"

/* A group of runs on the engine. */
struct group {
    const struct long_run_settings *settings;
    struct long_run *runs;
    size_t count;
    struct batch_walker walker;
    struct problem *problems;
    struct batch_item *items;
    struct batch_slopes *slopes;
    double (*direction)[3]; /* of the exponent: the difference that is carried along */
    double *growth;         /* sum of logarithms */
};

static struct batch_job job_of(struct group *group, int64_t strides, batch_stride_done_fn *done)
{
    const struct batch_job job = {.walkers = &group->walker,
                                  .walker_count = 1,
                                  .items = group->items,
                                  .count = group->count,
                                  .strides = strides,
                                  .stride_done = done,
                                  .context = group};
    return job;
}

static int keep_sample(void *context, size_t index, struct batch_item *item,
                       const struct batch_slopes *slopes)
{
    struct group *group = context;
    struct long_run_sample *samples = group->runs[index].samples;
    const int64_t kept = item->strides - group->settings->transient;
    (void)slopes;
    if (item->fault != 0) {
        return 1;
    }
    if (kept >= 1) {
        samples[kept - 1].inter_leg_rad = item->inter_leg_rad;
    }
    if (kept >= 0) {
        double *x = kept < group->settings->keep ? samples[kept].x : group->runs[index].last;
        memcpy(x, item->apex, sizeof item->apex);
    }
    batch_adapter_push(&group->problems[index], item);
    return 0;
}

static int period_of(const struct long_run_sample *samples, int keep)
{
    for (int period = 1; period <= LONG_RUN_PERIODS && 2 * period <= keep; period++) {
        int same = 1;
        for (int i = 0; i + period < keep && same; i++) {
            for (int k = 0; k < 3; k++) {
                same = same && real_abs(samples[i].x[k] - samples[i + period].x[k]) < LONG_RUN_SAME;
            }
        }
        if (same) {
            return period;
        }
    }
    return 0;
}

/* ln(x) for x > 0 by repeated square roots: ln x = 2^n ln x^(1/2^n), then a series. Own, so that
 * results do not depend on the C library. */
static double natural_log(double x)
{
    double factor = 1.0;
    while (x > 1.01 || x < 0.99) {
        x = real_sqrt(x);
        factor *= 2.0;
    }
    const double t = (x - 1.0) / (x + 1.0), s = t * t;
    return factor * 2.0 * t * (1.0 + s * (1.0 / 3.0 + s * (1.0 / 5.0 + s / 7.0)));
}

/* Carries the difference through the stride, and adds up by how much it grew. */
static int carry(void *context, size_t index, struct batch_item *item,
                 const struct batch_slopes *slopes)
{
    struct group *group = context;
    double *w = group->direction[index], by_x[3][3], moved[3], before = 0.0, after = 0.0;
    if (item->fault != 0) {
        return 1;
    }
    batch_adapter_by_apex(&group->problems[index], slopes, by_x);
    for (int k = 0; k < 3; k++) {
        moved[k] = by_x[k][0] * w[0] + by_x[k][1] * w[1] + by_x[k][2] * w[2];
        before += w[k] * w[k];
        after += moved[k] * moved[k];
    }
    const double growth = real_sqrt(after / before);
    if (!(growth > 0.0)) {
        item->fault = STRIDE_NOT_FINITE;
        return 1;
    }
    group->growth[index] += natural_log(growth);
    for (int k = 0; k < 3; k++) {
        w[k] = moved[k] / real_sqrt(after);
    }
    batch_adapter_push(&group->problems[index], item);
    return 0;
}

/* Which runs can start at all, and their laws. */
static void prepare(struct group *group)
{
    for (size_t i = 0; i < group->count; i++) {
        struct long_run *run = &group->runs[i];
        struct problem *problem = &group->problems[i];
        struct orbit scratch;
        *problem = (struct problem){.params = group->settings->params,
                                    .r0_m = run->r0,
                                    .kp = group->settings->kp,
                                    .period = 1};
        memcpy(problem->reference_x, run->gait, sizeof problem->reference_x);
        run->period = -1;
        run->lyapunov = NO_NUMBER;
        run->fault = STRIDE_BAD_INPUT;
        run->has_gait = run->has_gait && problem_prepare(problem, &scratch) == ORBIT_OK;
    }
}

/* The runs that no start has walked on yet, from beside their gaits by `side`. */
static enum batch_error walk(struct group *group, double side)
{
    const struct long_run_settings *settings = group->settings;
    const struct batch_settings accurate = {.accuracy = BATCH_ADAPTER_ACCURACY};
    for (size_t i = 0; i < group->count; i++) {
        struct long_run *run = &group->runs[i];
        struct batch_item *item = &group->items[i];
        *item = (struct batch_item){.fault = BATCH_ADAPTER_SKIP};
        if (!run->has_gait || run->fault == STRIDE_OK) {
            continue;
        }
        memcpy(item->apex, run->gait, sizeof item->apex);
        periodic_push_off_gait(&group->problems[i], side, item->apex);
        item->fault = 0;
        batch_adapter_push(&group->problems[i], item);
        if (settings->transient == 0) {
            memcpy(run->samples[0].x, item->apex, sizeof run->samples[0].x);
        }
    }
    const struct batch_job job =
        job_of(group, (int64_t)settings->transient + settings->keep, keep_sample);
    const enum batch_error error = batch_run(&accurate, &job);
    for (size_t i = 0; i < group->count; i++) {
        if (group->items[i].fault != BATCH_ADAPTER_SKIP) {
            group->runs[i].fault = (enum stride_fault)group->items[i].fault;
        }
    }
    return error;
}

/* The exponents of the runs that walk, from where they are. */
static enum batch_error measure_growth(struct group *group)
{
    const struct batch_settings accurate = {.accuracy = BATCH_ADAPTER_ACCURACY};
    struct batch_job job = job_of(group, group->settings->lyapunov, carry);
    job.slopes = group->slopes;
    for (size_t i = 0; i < group->count; i++) {
        static const double start[3] = {1.0, 0.3, 0.2};
        const struct long_run *run = &group->runs[i];
        struct batch_item *item = &group->items[i];
        *item = (struct batch_item){.fault = BATCH_ADAPTER_SKIP};
        if (run->fault == STRIDE_OK) {
            memcpy(item->apex, run->last, sizeof item->apex);
            memcpy(group->direction[i], start, sizeof start);
            group->growth[i] = 0.0;
            item->fault = 0;
            batch_adapter_push(&group->problems[i], item);
        }
    }
    const enum batch_error error = batch_run(&accurate, &job);
    for (size_t i = 0; i < group->count; i++) {
        if (group->items[i].fault == 0) {
            group->runs[i].lyapunov = group->growth[i] / group->settings->lyapunov;
        }
    }
    return error;
}

static enum batch_error run_group(struct group *group)
{
    static const double sides[] = {1e-3, -1e-3, 1e-2, -1e-2, 3e-2, -3e-2};
    enum batch_error error = BATCH_OK;
    prepare(group);
    for (unsigned s = 0; s < sizeof sides / sizeof sides[0] && error == BATCH_OK; s++) {
        error = walk(group, sides[s]);
    }
    for (size_t i = 0; i < group->count; i++) {
        if (group->runs[i].fault == STRIDE_OK) {
            group->runs[i].period = period_of(group->runs[i].samples, group->settings->keep);
        }
    }
    if (group->settings->lyapunov > 0 && error == BATCH_OK) {
        error = measure_growth(group);
    }
    return error;
}

int long_runs(const struct long_run_settings *settings, struct long_run *runs, size_t count)
{
    struct group group = {.settings = settings,
                          .runs = runs,
                          .count = count,
                          .walker = batch_adapter_walker(&settings->params),
                          .problems = calloc(count, sizeof *group.problems),
                          .items = calloc(count, sizeof *group.items),
                          .slopes = calloc(count, sizeof *group.slopes),
                          .direction = calloc(count, sizeof *group.direction),
                          .growth = calloc(count, sizeof *group.growth)};
    const int has_room = group.problems != NULL && group.items != NULL && group.slopes != NULL &&
                         group.direction != NULL && group.growth != NULL;
    const int is_good = has_room && run_group(&group) == BATCH_OK;
    free(group.problems);
    free(group.items);
    free(group.slopes);
    free(group.direction);
    free(group.growth);
    return is_good ? 0 : -1;
}
