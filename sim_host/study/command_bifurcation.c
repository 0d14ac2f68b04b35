/* afo-study bifurcation: long runs over r0; periods, chaos, loss of walking, Lyapunov exponents. */
#include <stdio.h>
#include <stdlib.h>

#include "sim_host/study/command.h"
#include "sim_host/study/periodic.h"
#include "sim_host/study/pool.h"

enum { KEEP_MAX = 10000, POINTS_MAX = 1000000, LONGEST_PERIOD = 64 };
#define SAME 1e-6 /* states nearer than this (rad, rad/s) are one state of a periodic walk */

struct options {
    struct common common;
    double from, to, kp;
    int points, transient, keep, lyapunov;
};

static const struct argp_option table[] = {
    {"from", 'f', "M", 0, "first r0 (0.05)", 0},
    {"to", 't', "M", 0, "last r0 (0.3)", 0},
    {"points", 'n', "N", 0, "so many r0 (500)", 0},
    {"transient", 'T', "N", 0, "strides walked before looking (1000)", 0},
    {"keep", 'k' + 1000, "N", 0, "strides kept of each walk (100)", 0},
    {"lyapunov", 'L', "N", 0, "largest Lyapunov exponent over N strides (0: none)", 0},
    {"kp", 'K', "GAIN", 0, "gain of the step law (0)", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'f':
        options->from = command_number(argument, "from", state);
        return 0;
    case 't':
        options->to = command_number(argument, "to", state);
        return 0;
    case 'n':
        options->points = command_integer(argument, "points", 2, POINTS_MAX, state);
        return 0;
    case 'T':
        options->transient = command_integer(argument, "transient", 0, 100000000, state);
        return 0;
    case 'k' + 1000:
        options->keep = command_integer(argument, "keep", 1, KEEP_MAX, state);
        return 0;
    case 'L':
        options->lyapunov = command_integer(argument, "lyapunov", 0, 100000000, state);
        return 0;
    case 'K':
        options->kp = command_number(argument, "kp", state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

struct sample {
    double x[3], inter_leg_rad;
};

struct run {
    double r0, gait[3]; /* the period-1 gait it starts beside */
    int has_gait;
    struct sample *samples;
    enum stride_fault fault;
    int period; /* 0: none up to LONGEST_PERIOD; -1: fell */
    double lyapunov;
};

struct study {
    struct options options;
    struct run *runs;
    struct report report;
    int skip; /* rows of the first run that a resumed file has already */
};

/* Walks, keeps samples. Returns the fault. */
static enum stride_fault keep_samples(const struct problem *problem, int keep, double x[3],
                                      struct sample *samples)
{
    for (int i = 0; i < keep; i++) {
        double next[3], r0;
        struct stride_result result;
        const enum stride_fault fault = problem_stride(problem, x, next, &r0, &result);
        if (fault != STRIDE_OK) {
            return fault;
        }
        for (int k = 0; k < 3; k++) {
            samples[i].x[k] = x[k];
            x[k] = next[k];
        }
        samples[i].inter_leg_rad = result.inter_leg_rad;
    }
    return STRIDE_OK;
}

static int period_of(const struct sample *samples, int keep)
{
    for (int period = 1; period <= LONGEST_PERIOD && 2 * period <= keep; period++) {
        int same = 1;
        for (int i = 0; i + period < keep && same; i++) {
            for (int k = 0; k < 3; k++) {
                same = same && real_abs(samples[i].x[k] - samples[i + period].x[k]) < SAME;
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

/* Mean growth of a small difference per stride (natural logarithm), by the map's derivative. */
static double lyapunov(const struct problem *problem, int strides, double x[3])
{
    struct problem single = *problem;
    struct orbit orbit;
    double w[3] = {1.0, 0.3, 0.2}, sum = 0.0;
    single.period = 1;
    for (int i = 0; i < strides; i++) {
        double moved[3], before = 0.0, after = 0.0;
        for (int k = 0; k < 3; k++) {
            orbit.x[k] = x[k];
        }
        if (orbit_evaluate(&single, 1, &orbit) != ORBIT_OK) {
            return NO_NUMBER;
        }
        for (int k = 0; k < 3; k++) {
            moved[k] = orbit.by_x[k][0] * w[0] + orbit.by_x[k][1] * w[1] + orbit.by_x[k][2] * w[2];
            before += w[k] * w[k];
            after += moved[k] * moved[k];
            x[k] = orbit.next[k];
        }
        const double growth = real_sqrt(after / before);
        if (!(growth > 0.0)) {
            return NO_NUMBER;
        }
        sum += natural_log(growth);
        for (int k = 0; k < 3; k++) {
            w[k] = moved[k] / real_sqrt(after);
        }
    }
    return sum / strides;
}

static void compute(void *context, int i)
{
    static const double sides[] = {1e-3, -1e-3, 1e-2, -1e-2, 3e-2, -3e-2};
    const struct study *study = context;
    struct run *run = &study->runs[i];
    struct problem problem = {.params = study->options.common.params,
                              .r0_m = run->r0,
                              .kp = study->options.kp,
                              .period = 1};
    struct orbit scratch;
    run->period = -1;
    run->lyapunov = NO_NUMBER;
    run->fault = STRIDE_BAD_INPUT;
    for (int k = 0; k < 3; k++) {
        problem.reference_x[k] = run->gait[k];
    }
    if (!run->has_gait || problem_prepare(&problem, &scratch) != ORBIT_OK) {
        return;
    }
    for (unsigned s = 0; s < sizeof sides / sizeof sides[0]; s++) {
        double x[3] = {run->gait[0], run->gait[1], run->gait[2]};
        periodic_push_off_gait(&problem, sides[s], x);
        if (!periodic_walk(&problem, study->options.transient, x)) {
            run->fault = STRIDE_FALLEN;
            continue;
        }
        run->fault = keep_samples(&problem, study->options.keep, x, run->samples);
        if (run->fault == STRIDE_OK) {
            run->period = period_of(run->samples, study->options.keep);
            if (study->options.lyapunov > 0) {
                run->lyapunov = lyapunov(&problem, study->options.lyapunov, x);
            }
            return;
        }
    }
}

/* One row per kept stride; as many where the walker fell, so that a file can be resumed by counting. */
static int take(void *context, int i)
{
    struct study *study = context;
    const struct run *run = &study->runs[i];
    const double none = NO_NUMBER;
    for (int k = study->skip; k < study->options.keep; k++) {
        const struct sample *s = &run->samples[k];
        const int good = run->period >= 0;
        const struct cell row[] = {cell_number(run->r0),
                                   cell_integer(run->period),
                                   cell_number(run->lyapunov),
                                   cell_integer(k),
                                   cell_number(good ? s->x[0] : none),
                                   cell_number(good ? s->x[1] : none),
                                   cell_number(good ? s->x[2] : none),
                                   cell_number(good ? s->inter_leg_rad : none)};
        report_row(&study->report, row);
    }
    study->skip = 0;
    report_progress(&study->report, i + 1, study->options.points);
    return !ferror(study->report.file);
}

/* The period-1 gaits to start beside, followed over the range. */
static void find_gaits(struct study *study)
{
    const struct walker_params *p = &study->options.common.params;
    const double l = p->leg_length_m, unit_s = real_sqrt(l / p->gravity_m_s2);
    const double ratio = p->leg_mass_kg / p->hip_mass_kg;
    const double stiffness = p->ankle_stiffness_N_m * l / (p->hip_mass_kg * p->gravity_m_s2);
    struct branch_gait gait = branch_start(BRANCH_LONG);
    int good = branch_follow(&gait, ratio, stiffness, gait.r0);
    for (int i = 0; i < study->options.points; i++) {
        struct run *run = &study->runs[i];
        run->r0 = study->options.from +
                  (study->options.to - study->options.from) * i / (study->options.points - 1);
        good = good && branch_follow(&gait, ratio, stiffness, run->r0 / l);
        run->has_gait = good;
        for (int k = 0; k < 3; k++) {
            run->gait[k] = gait.x[k] / (k == 1 ? 1.0 : unit_s);
        }
    }
}

static int run_study(struct study *study)
{
    static const char *const columns[] = {"r0_m",
                                          "period",
                                          "lyapunov",
                                          "sample",
                                          "stance_rate_rad_s",
                                          "swing_angle_rad",
                                          "swing_rate_rad_s",
                                          "inter_leg_rad",
                                          NULL};
    const struct options *options = &study->options;
    char settings[256];
    snprintf(settings, sizeof settings,
             "from=%.17g to=%.17g points=%d transient=%d keep=%d lyapunov=%d kp=%.17g",
             options->from, options->to, options->points, options->transient, options->keep,
             options->lyapunov, options->kp);
    if (!report_open(&study->report, &options->common, "bifurcation", settings, columns)) {
        return EXIT_USAGE;
    }
    find_gaits(study);
    study->skip = study->report.rows_resumed % options->keep;
    const struct pool_jobs jobs = {study->report.rows_resumed / options->keep,
                                   options->points,
                                   options->common.threads,
                                   study,
                                   compute,
                                   take};
    const int complete = pool_run(&jobs);
    return report_close(&study->report) && complete ? EXIT_FOUND : EXIT_USAGE;
}

int command_bifurcation(int argc, char **argv)
{
    struct study study = {.options = {.common = command_defaults(),
                                      .from = 0.05,
                                      .to = 0.3,
                                      .points = 500,
                                      .transient = 1000,
                                      .keep = 100}};
    struct options *options = &study.options;
    command_parse(
        table, parse,
        "Walks long beside the period-1 gait at each r0 and keeps the last apexes; period 0: "
        "none up to 64 (chaos), -1: the walker falls.",
        argc, argv, options);
    if (!command_check_walker(&options->common)) {
        return EXIT_USAGE;
    }
    if (!(options->from > 0.0 && options->to > options->from &&
          options->to < options->common.params.leg_length_m)) {
        fprintf(stderr,
                "afo-study: r0 must rise from --from to --to between 0 and the leg length\n");
        return EXIT_USAGE;
    }
    const size_t samples = (size_t)options->points * (size_t)options->keep;
    struct sample *all = calloc(samples, sizeof *all);
    study.runs = calloc((size_t)options->points, sizeof *study.runs);
    int status = EXIT_NOT_FOUND;
    if (all == NULL || study.runs == NULL) {
        fprintf(stderr, "afo-study: out of memory for %zu samples; take fewer --points\n", samples);
    } else {
        for (int i = 0; i < options->points; i++) {
            study.runs[i].samples = all + (size_t)i * (size_t)options->keep;
        }
        status = run_study(&study);
    }
    free(all);
    free(study.runs);
    return status;
}
