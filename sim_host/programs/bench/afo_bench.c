/* Time against error of the project's own return maps: model/'s scalar map and the batch engine.
 * Usage: afo-bench REFERENCE.csv [SECONDS [cores|engine]]; scripts/bench-strides runs it beside the others.
 * cores: all cores against one, and nothing else; engine: one core's strides per second, for scripts/bench_python.py. */
#define REAL_IS_DOUBLE 1 /* the map in double */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "model/stride.h"
#include "sim_host/batch/benchmark.h"
#include "sim_host/batch/parallel_for.h"

#define REPEATS 20

struct scalar {
    ode_method *method;
    struct walker walker[BENCHMARK_MAX_ROWS];
};

/* setting: parts of the accurate settings' step. */
static int scalar_strides(void *context, const struct benchmark_rows *rows, double setting,
                          double (*next)[3])
{
    const struct scalar *scalar = context;
    for (int i = 0; i < rows->count; i++) {
        const struct reference_stride *row = &rows->row[i];
        struct stride_settings settings = stride_settings_accurate(&scalar->walker[i]);
        const struct apex apex = {row->apex[0], row->apex[1], row->apex[2]};
        struct stride_result result;
        settings.method = scalar->method;
        settings.single_step_s /= setting;
        settings.double_step_s /= setting;
        if (stride(&scalar->walker[i], &settings, &apex, row->push_m, &result) != STRIDE_OK) {
            return 0;
        }
        next[i][0] = result.next.stance_rate_rad_s;
        next[i][1] = result.next.swing_angle_rad;
        next[i][2] = result.next.swing_rate_rad_s;
    }
    return 1;
}

static void measure_scalar(const struct benchmark_rows *rows)
{
    static struct scalar scalar;
    for (int i = 0; i < rows->count; i++) {
        const struct batch_walker *w = &rows->row[i].walker;
        const struct walker_params params = {w->hip_mass_kg, w->leg_mass_kg, w->leg_length_m,
                                             w->ankle_stiffness_N_m, w->gravity_m_s2};
        walker_init(&scalar.walker[i], &params);
    }
    scalar.method = ODE_RK8;
    double parts = 0.25;
    for (int rung = 0; rung < 15; rung++) {
        benchmark_measure("scalar map RK8", rows, scalar_strides, &scalar, parts, 1);
        parts *= 1.19;
    }
    scalar.method = ODE_RK4;
    parts = 1.0;
    for (int rung = 0; rung < 8; rung++) {
        benchmark_measure("scalar map RK4", rows, scalar_strides, &scalar, parts, 1);
        parts *= 2.0;
    }
}

struct many {
    struct batch_walker walker[BENCHMARK_MAX_ROWS];
    struct batch_item *items; /* REPEATS times the rows */
    struct batch_slopes *slopes;
    int want_times;
};

/* setting 0: the method that is in use; else the accuracy. */
static int batch_strides(void *context, const struct benchmark_rows *rows, double setting,
                         double (*next)[3])
{
    struct many *many = context;
    const struct batch_settings settings = {.accuracy = setting, .want_times = many->want_times};
    const struct batch_job job = {.walkers = many->walker,
                                  .walker_count = (uint32_t)rows->count,
                                  .items = many->items,
                                  .slopes = many->slopes,
                                  .count = (size_t)rows->count * REPEATS,
                                  .strides = 1};
    for (size_t i = 0; i < job.count; i++) {
        const size_t r = i % (size_t)rows->count;
        many->items[i] = (struct batch_item){.push_m = rows->row[r].push_m, .walker = (uint32_t)r};
        memcpy(many->items[i].apex, rows->row[r].apex, sizeof many->items[i].apex);
    }
    if (batch_run(&settings, &job) != BATCH_OK) {
        return 0;
    }
    for (int i = 0; i < rows->count; i++) {
        memcpy(next[i], many->items[i].apex, sizeof next[i]);
        if (many->items[i].fault != 0) {
            return 0;
        }
    }
    return 1;
}

/* Orders and tolerances side by side: what batch.c's table is chosen from. */
static void measure_methods(const struct benchmark_rows *rows, struct many *many)
{
    for (int order = 8; order <= 28; order += 2) {
        char name[80];
        snprintf(name, sizeof name, "series of order %d: %s", order, batch_lanes_name());
        for (int bits = 12; bits <= 54; bits += 2) {
            batch_use_method(order, -(double)bits);
            benchmark_measure(name, rows, batch_strides, many, 0.0, REPEATS);
        }
    }
    batch_use_method(0, 0.0);
}

/* Lines that begin with # are remarks for the reader. */
static void report_peak(const struct benchmark_rows *rows, struct many *many)
{
    static double next[BENCHMARK_MAX_ROWS][3];
    const struct batch_settings settings = {0};
    double best = 1e30, series = 0.0;
    for (int i = 0; i < 10; i++) {
        const double start = benchmark_now_s();
        batch_strides(many, rows, 0.0, next);
        const double took = benchmark_now_s() - start;
        best = took < best ? took : best;
    }
    for (int i = 0; i < rows->count; i++) {
        series += many->items[i].series;
    }
    const double rate = series * REPEATS * batch_series_flops(&settings) / best,
                 peak = batch_peak_flops();
    printf(
        "# %s at %g: %.1f power series a stride, %.1f Gflop/s in them, %.0f %% of the %.1f Gflop/s measured "
        "without fused operations\n",
        batch_lanes_name(), BATCH_ACCURACY_DEFAULT, series / rows->count, 1e-9 * rate,
        100.0 * rate / peak, 1e-9 * peak);
}

/* Wall time of one pass; *processor_s: processor time of all its threads. */
static double pass_s(const struct batch_job *job, int threads, double *processor_s)
{
    const struct batch_settings settings = {0};
    struct timespec before, after;
    for (size_t i = 0; i < job->count; i++) {
        job->items[i].strides = 0;
        job->items[i].fault = 0;
    }
    const clock_t ticks = clock();
    clock_gettime(CLOCK_MONOTONIC, &before);
    batch_run_threads(&settings, job, threads);
    clock_gettime(CLOCK_MONOTONIC, &after);
    *processor_s = (double)(clock() - ticks) / CLOCKS_PER_SEC;
    return (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec);
}

/* The paper's stable gait, many times over: what all cores do together against one. Short passes by turns, the
 * fastest of each: on a busy machine some find all cores free. */
static void report_cores(const struct benchmark_rows *rows)
{
    enum { PASSES = 1000, STRIDES = 2 };
    const int cores = parallel_for_threads(0);
    static struct batch_item items[BENCHMARK_MAX_ROWS * REPEATS];
    const struct batch_job job = {.walkers = &rows->row[0].walker,
                                  .walker_count = 1,
                                  .items = items,
                                  .count = (size_t)rows->count * REPEATS,
                                  .strides = STRIDES};
    double wall[2] = {1e30, 1e30}, processor[2] = {1e30, 1e30};
    for (size_t i = 0; i < job.count; i++) {
        items[i] = (struct batch_item){.apex = {-0.40696, -0.05957, 1.75677}, .push_m = 0.05};
    }
    for (int pass = 0; pass < 2 * PASSES; pass++) {
        double took_processor;
        const int all = pass % 2;
        const double took = pass_s(&job, all ? cores : 1, &took_processor);
        wall[all] = took < wall[all] ? took : wall[all];
        processor[all] = took_processor < processor[all] ? took_processor : processor[all];
    }
    const double strides = (double)job.strides * (double)job.count;
    printf(
        "# the paper's gait at 1e-9: %.0f strides per second on one core, %.0f on %d, fastest of %d passes each by "
        "turns (%.0f %% efficiency by the wall clock, %.0f %% by processor time)\n",
        strides / wall[0], strides / wall[1], cores, PASSES, 100.0 * wall[0] / wall[1] / cores,
        100.0 * processor[0] / processor[1]);
}

/* The same gait and number of walkers that bench_python.py takes, one core, by processor time. */
static void report_engine(const struct benchmark_rows *rows)
{
    enum { WALKERS = BENCHMARK_MAX_ROWS * REPEATS, STRIDES = 2 };
    static struct batch_item items[WALKERS];
    const struct batch_job job = {.walkers = &rows->row[0].walker,
                                  .walker_count = 1,
                                  .items = items,
                                  .count = WALKERS,
                                  .strides = STRIDES};
    double best = 1e30, spent = 0.0;
    while (spent < rows->least_time_s) {
        double processor_s;
        for (size_t i = 0; i < WALKERS; i++) {
            items[i] = (struct batch_item){.apex = {-0.40696, -0.05957, 1.75677}, .push_m = 0.05};
        }
        (void)pass_s(&job, 1, &processor_s);
        best = processor_s < best ? processor_s : best;
        spent += processor_s;
    }
    printf("%d,%d,%.6g\n", WALKERS, STRIDES, WALKERS * STRIDES / best);
}

static void measure_lanes(const struct benchmark_rows *rows, struct many *many)
{
    static const double accuracies[] = {1e-4, 1e-6, 1e-9, 1e-11, 1e-12};
    static struct batch_slopes slopes[BENCHMARK_MAX_ROWS * REPEATS];
    char name[80];
    snprintf(name, sizeof name, "batch %s", batch_lanes_name());
    for (size_t i = 0; i < sizeof accuracies / sizeof accuracies[0]; i++) {
        benchmark_measure(name, rows, batch_strides, many, accuracies[i], REPEATS);
    }
    many->want_times = 1;
    snprintf(name, sizeof name, "batch %s with times", batch_lanes_name());
    benchmark_measure(name, rows, batch_strides, many, 1e-9, REPEATS);
    many->want_times = 0;
    many->slopes = slopes;
    snprintf(name, sizeof name, "batch %s with derivatives", batch_lanes_name());
    benchmark_measure(name, rows, batch_strides, many, 1e-9, REPEATS);
    many->slopes = NULL;
}

static void measure_batch(const struct benchmark_rows *rows)
{
    static struct batch_item items[BENCHMARK_MAX_ROWS * REPEATS];
    static struct many many = {.items = items};
    for (int i = 0; i < rows->count; i++) {
        many.walker[i] = rows->row[i].walker;
    }
    for (int lanes = 2; lanes <= 8; lanes *= 2) {
        if (batch_use_lanes(lanes) == BATCH_OK) {
            measure_lanes(rows, &many);
            measure_methods(rows, &many);
        }
    }
    batch_use_lanes(0);
    report_peak(rows, &many);
}

int main(int argc, char **argv)
{
    static struct benchmark_rows rows;
    if (!benchmark_open(&rows, argc, argv)) {
        return EXIT_FAILURE;
    }
    if (argc > 3) {
        (strcmp(argv[3], "engine") == 0 ? report_engine : report_cores)(&rows);
        return EXIT_SUCCESS;
    }
    measure_batch(&rows);
    measure_scalar(&rows);
    return EXIT_SUCCESS;
}
