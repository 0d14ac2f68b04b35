/* afo study noise: Monte Carlo of the step law that is told its apex speeds with errors. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/study/noisy_map.h"
#include "sim_host/study/paper/command.h"

enum { ERRORS_MAX = 16, WALKERS_MAX = 10000000 };

struct options {
    struct common common;
    double r0, kp, errors[ERRORS_MAX];
    int error_count, walkers, strides, seed;
};

static const struct argp_option table[] = {
    {"r0", 'r', "M", 0, "set point of the law (0.15 leg lengths)", 0},
    {"kp", 'K', "GAIN", 0, "gain of the step law (0.042 of the paper's walker, scaled)", 0},
    {"error", 'e', "SHARE,...", 0,
     "errors of the measured speed, RMS, shares of it (0.0003,0.001,0.003,0.01)", 0},
    {"walkers", 'n', "N", 0, "so many walkers for each (1000)", 0},
    {"strides", 's', "N", 0, "at most so many steps of each (300)", 0},
    {"seed", 'S', "N", 0, "of the random numbers (1)", 0},
    {0},
};

static void parse_errors(struct options *options, const char *text, const struct argp_state *state)
{
    const int count = command_list(text, "error", ERRORS_MAX, options->errors, state);
    options->error_count = count;
    for (int i = 0; i < count; i++) {
        if (!(options->errors[i] >= 0.0 && options->errors[i] <= 1.0)) {
            argp_error(state, "--error: shares from 0 to 1");
        }
    }
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'e':
        parse_errors(options, argument, state);
        return 0;
    case 'n':
        options->walkers = command_integer(argument, "walkers", 1, WALKERS_MAX, state);
        return 0;
    case 's':
        options->strides = command_integer(argument, "strides", 1, 1000000, state);
        return 0;
    case 'S':
        options->seed = command_integer(argument, "seed", 0, 2000000000, state);
        return 0;
    default:
        return command_law(key, argument, &options->r0, &options->kp, state);
    }
}

/* Falls, mean strides walked, and the spread of those that walked on. */
static void print(struct report *report, double error, const struct noisy_walk *walks, int count)
{
    int fell = 0, walked_on = 0;
    double strides = 0.0, squares = 0.0;
    for (int i = 0; i < count; i++) {
        fell += walks[i].fell;
        strides += walks[i].walked;
        if (!walks[i].fell) {
            squares += walks[i].spread * walks[i].spread;
            walked_on++;
        }
    }
    const struct cell row[] = {cell_number(error),
                               cell_integer(count),
                               cell_integer(fell),
                               cell_number(strides / count),
                               cell_number(fell > 0 ? (strides + fell) / fell : NO_NUMBER),
                               cell_number(walked_on > 0 ? sqrt(squares / walked_on) : NO_NUMBER)};
    report_row(report, row);
}

static int run(const struct options *options, const struct problem *problem, const double x[3],
               struct noisy_walk *walks)
{
    static const char *const columns[] = {"error",           "walkers",      "fell", "strides_each",
                                          "strides_to_fall", "speed_spread", NULL};
    const struct walker_params *p = &options->common.params;
    const struct noisy_law law = {.hip_mass_kg = p->hip_mass_kg,
                                  .leg_mass_kg = p->leg_mass_kg,
                                  .leg_length_m = p->leg_length_m,
                                  .ankle_stiffness_N_m = p->ankle_stiffness_N_m,
                                  .gravity_m_s2 = p->gravity_m_s2,
                                  .gait = {x[0], x[1], x[2]},
                                  .r0_m = problem->r0_m,
                                  .kp_m_s_rad = problem->kp};
    struct report report;
    int is_complete = 1;
    if (!report_open(&report, &options->common, "noise", "", columns)) {
        return EXIT_USAGE;
    }
    for (int i = 0; i < options->error_count && is_complete; i++) {
        is_complete =
            noisy_map_walks(&law, options->errors[i], options->strides, (uint64_t)options->seed,
                            options->common.threads, walks, (size_t)options->walkers) == 0;
        if (is_complete) {
            print(&report, options->errors[i], walks, options->walkers);
        }
        report_progress(&report, i + 1, options->error_count);
    }
    report_value(&report, "speed_rad_s", cell_number(-x[0]));
    return report_close(&report) && is_complete ? EXIT_FOUND : EXIT_NOT_FOUND;
}

int command_noise(int argc, char **argv)
{
    static const double errors[] = {0.0003, 0.001, 0.003, 0.01};
    struct options options = {.common = command_defaults(),
                              .r0 = NO_NUMBER,
                              .kp = NO_NUMBER,
                              .error_count = 4,
                              .walkers = 1000,
                              .strides = 300,
                              .seed = 1};
    struct problem problem;
    double x[3];
    int status;
    memcpy(options.errors, errors, sizeof errors);
    command_parse(table, parse,
                  "Many walkers under the step law, each measured apex speed with an error: how "
                  "many fall, after how many steps, and how far the speed spreads.",
                  argc, argv, &options);
    const double l = options.common.params.leg_length_m;
    if (isnan(options.r0)) {
        options.r0 = 0.15 * l;
    }
    if (isnan(options.kp)) {
        options.kp = 0.042 * l * sqrt(l * 9.80665 / options.common.params.gravity_m_s2);
    }
    if (!command_gait(&options.common, BRANCH_LONG, options.r0, options.kp, &problem, x, &status)) {
        return status;
    }
    struct noisy_walk *walks = calloc((size_t)options.walkers, sizeof *walks);
    if (walks == NULL) {
        fprintf(stderr, "afo study: out of memory; take fewer --walkers\n");
        return EXIT_NOT_FOUND;
    }
    status = run(&options, &problem, x, walks);
    free(walks);
    return status;
}
