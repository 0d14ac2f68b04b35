/* afo study doublings: the cascade of period doublings over r0. */
#include <stdio.h>

#include "sim_host/study/paper/cascade.h"
#include "sim_host/study/paper/command.h"

struct options {
    struct common common;
    double from, to, kp;
    int count, has_range;
};

static const struct argp_option table[] = {
    {"from", 'f', "M", 0, "r0 with a stable period-1 gait", 0},
    {"to", 't', "M", 0, "r0 towards which the periods double", 0},
    {"kp", 'K', "GAIN", 0, "gain of the step law (0)", 0},
    {"count", 'n', "N", 0, "so many doublings (6: up to period 64)", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'f':
        options->from = command_number(argument, "from", state);
        options->has_range |= 1;
        return 0;
    case 't':
        options->to = command_number(argument, "to", state);
        options->has_range |= 2;
        return 0;
    case 'n':
        options->count = command_integer(argument, "count", 1, CASCADE_MAX, state);
        return 0;
    case ARGP_KEY_END:
        if (options->has_range != 3 || options->from == options->to) {
            argp_error(state, "--from and --to must both be given, and differ");
        }
        return 0;
    default:
        return command_law(key, argument, NULL, &options->kp, state);
    }
}

struct output {
    struct report report;
    int count, wanted;
};

static void print_doubling(void *context, const struct doubling *d)
{
    struct output *output = context;
    const struct cell row[] = {
        cell_integer(++output->count), cell_integer(d->new_period),
        cell_number(d->parameter),     cell_number(d->ratio > 0.0 ? d->ratio : NO_NUMBER),
        cell_number(d->x[0]),          cell_number(d->x[1]),
        cell_number(d->x[2]),          cell_number(d->residual)};
    report_row(&output->report, row);
    report_progress(&output->report, output->count, output->wanted);
}

int command_doublings(int argc, char **argv)
{
    static const char *const columns[] = {"n",
                                          "new_period",
                                          "r0_m",
                                          "ratio",
                                          "stance_rate_rad_s",
                                          "swing_angle_rad",
                                          "swing_rate_rad_s",
                                          "residual",
                                          NULL};
    struct options options = {.common = command_defaults(), .count = 6};
    struct output output = {.count = 0};
    struct doubling doublings[CASCADE_MAX];
    struct continuation_report end;
    struct problem problem;
    double x[3];
    int status;
    command_parse(
        table, parse,
        "Follows the period-1 gait over r0 to its period doubling, the doubled gait to its "
        "own, and so on; ratio: of successive intervals, towards Feigenbaum's 4.669.",
        argc, argv, &options);
    if (!command_gait(&options.common, BRANCH_LONG, options.from, options.kp, &problem, x,
                      &status)) {
        return status;
    }
    if (!report_open(&output.report, &options.common, "doublings", "", columns)) {
        return EXIT_USAGE;
    }
    output.wanted = options.count;
    const int found = cascade_find(&problem, PARAMETER_R0, options.from, options.to, x,
                                   options.count, doublings, &end, print_doubling, &output);
    if (!report_close(&output.report)) {
        return EXIT_USAGE;
    }
    if (found < options.count) {
        fprintf(stderr, "afo study: %d of %d doublings found; then: %s, at r0 = %.10g m\n", found,
                options.count, continuation_end_name(end.end), end.parameter);
    }
    return found > 0 ? EXIT_FOUND : EXIT_NOT_FOUND;
}
