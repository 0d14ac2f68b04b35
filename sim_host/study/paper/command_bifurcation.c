/* afo study bifurcation: long runs over r0; periods, chaos, loss of walking, Lyapunov exponents. */
#include <stdio.h>
#include <stdlib.h>

#include "sim_host/study/paper/command.h"
#include "sim_host/study/paper/long_runs.h"
#include "sim_host/study/pool.h"

enum { KEEP_MAX = 10000, POINTS_MAX = 1000000 };
#define GROUP 64 /* runs side by side on the batch engine: a job of the pool */

struct options {
    struct common common;
    double from, to, kp;
    int points, transient, keep, lyapunov;
};

static const struct argp_option table[] = {
    {"from", 'f', "M", 0, "first r0 (0.05)", 0},
    {"to", 't', "M", 0, "last r0 (0.3)", 0},
    {"points", 'n', "N", 0, "so many r0 (500)", 0},
    {"transient", 'T', "N", 0, "steps walked before looking (1000)", 0},
    {"keep", 'k' + 1000, "N", 0, "steps kept of each walk (100)", 0},
    {"lyapunov", 'L', "N", 0, "largest Lyapunov exponent over N steps (0: none)", 0},
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
    default:
        return command_law(key, argument, NULL, &options->kp, state);
    }
}

struct study {
    struct options options;
    struct long_run *runs;
    struct report report;
    int first; /* run that a resumed file does not have whole */
    int skip;  /* its rows that the file has already */
};

static int group_end(const struct study *study, int group)
{
    const int end = (group + 1) * GROUP;
    return end < study->options.points ? end : study->options.points;
}

static void compute(void *context, int group)
{
    const struct study *study = context;
    const struct options *options = &study->options;
    const struct long_run_settings settings = {
        options->common.params, options->kp, options->transient, options->keep, options->lyapunov};
    const int from = group * GROUP > study->first ? group * GROUP : study->first;
    struct long_run *runs = &study->runs[from];
    if (long_runs(&settings, runs, (size_t)(group_end(study, group) - from)) != 0) {
        runs->samples = NULL; /* report_group() says it */
    }
}

/* One row per kept stride; as many where the walker fell, so that a file can be resumed by counting. */
static void print_run(struct study *study, const struct long_run *run)
{
    const double none = NO_NUMBER;
    for (int k = study->skip; k < study->options.keep; k++) {
        const struct long_run_sample *s = &run->samples[k];
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
}

static int report_group(void *context, int group)
{
    struct study *study = context;
    const int end = group_end(study, group);
    for (; study->first < end; study->first++) {
        if (study->runs[study->first].samples == NULL) {
            fprintf(stderr, "afo study: out of memory\n");
            return 0;
        }
        print_run(study, &study->runs[study->first]);
    }
    report_progress(&study->report, end, study->options.points);
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
        struct long_run *run = &study->runs[i];
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
    study->first = study->report.rows_resumed / options->keep;
    const struct pool_jobs jobs = {study->first / GROUP,
                                   (options->points + GROUP - 1) / GROUP,
                                   options->common.threads,
                                   study,
                                   compute,
                                   report_group};
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
                "afo study: r0 must rise from --from to --to between 0 and the leg length\n");
        return EXIT_USAGE;
    }
    const size_t samples = (size_t)options->points * (size_t)options->keep;
    struct long_run_sample *all = calloc(samples, sizeof *all);
    study.runs = calloc((size_t)options->points, sizeof *study.runs);
    int status = EXIT_NOT_FOUND;
    if (all == NULL || study.runs == NULL) {
        fprintf(stderr, "afo study: out of memory for %zu samples; take fewer --points\n", samples);
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
