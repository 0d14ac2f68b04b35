/* afo study continue: a branch of gaits followed in one parameter. */
#include <stdio.h>
#include <string.h>

#include "sim_host/study/paper/command.h"
#include "sim_host/study/paper/continuation.h"
#include "sim_host/study/paper/periodic.h"
#include "sim_host/study/plot.h"

struct options {
    struct common common;
    enum parameter over;
    double from, to, r0, kp, step;
    enum branch branch;
    int period, has_range, points;
};

static const struct argp_option table[] = {
    {"over", 'o', "PARAMETER", 0, "r0, k, m, l, M, g or kp (r0)", 0},
    {"from", 'f', "VALUE", 0, "where to start", 0},
    {"to", 't', "VALUE", 0, "where to end", 0},
    {"branch", 'b', "long|short", 0, "period-1 gaits to start from (long)", 0},
    {"period", 'p', "N", 0, "steps until the gait repeats (1)", 0},
    {"r0", 'r', "M", 0, "push-off, when another parameter is followed (0.05)", 0},
    {"kp", 'K', "GAIN", 0, "gain of the step law (0)", 0},
    {"step", 's', "LENGTH", 0, "longest step along the branch; the range is 1 (0.02)", 0},
    {"points", 'n', "N", 0, "at most so many points (5000)", 0},
    {0},
};

static enum parameter parameter_of(const char *name, const struct argp_state *state)
{
    for (int i = 0; i < PARAMETER_COUNT; i++) {
        if (strcmp(name, parameter_name((enum parameter)i)) == 0) {
            return (enum parameter)i;
        }
    }
    argp_error(state, "--over: \"%s\" is none of r0, k, m, l, M, g, kp", name);
    return PARAMETER_R0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'o':
        options->over = parameter_of(argument, state);
        return 0;
    case 'f':
        options->from = command_number(argument, "from", state);
        options->has_range |= 1;
        return 0;
    case 't':
        options->to = command_number(argument, "to", state);
        options->has_range |= 2;
        return 0;
    case 'b':
        options->branch = command_branch(argument, state);
        return 0;
    case 'p':
        options->period = command_integer(argument, "period", 1, ORBIT_MAX_PERIOD, state);
        return 0;
    case 's':
        options->step = command_number(argument, "step", state);
        return 0;
    case 'n':
        options->points = command_integer(argument, "points", 2, 1000000, state);
        return 0;
    case ARGP_KEY_END:
        if (options->has_range != 3 || options->from == options->to) {
            argp_error(state, "--from and --to must both be given, and differ");
        }
        if (!(options->step > 0.0 && options->step <= 1.0)) {
            argp_error(state, "--step must be above 0 and at most 1");
        }
        return 0;
    default:
        return command_law(key, argument, &options->r0, &options->kp, state);
    }
}

struct output {
    struct report report;
    const struct options *options;
};

static int print_point(void *context, const struct branch_point *point)
{
    static const char *const events[] = {"", "fold", "doubling"};
    struct output *output = context;
    const struct eigenvalue *v = point->values;
    const double speed = point->orbit.distance_m / point->orbit.duration_s;
    const struct cell row[] = {cell_number(point->parameter),
                               cell_number(point->orbit.x[0]),
                               cell_number(point->orbit.x[1]),
                               cell_number(point->orbit.x[2]),
                               cell_number(v[0].re),
                               cell_number(v[0].im),
                               cell_number(v[1].re),
                               cell_number(v[1].im),
                               cell_number(v[2].re),
                               cell_number(v[2].im),
                               cell_truth(linear_magnitude(v[0]) < 1.0),
                               cell_number(point->orbit.first.inter_leg_rad),
                               cell_number(point->orbit.first.step_length_m),
                               cell_number(point->orbit.duration_s),
                               cell_number(speed),
                               cell_integer(point->orbit.clamped_strides),
                               cell_text(events[point->event])};
    const double share =
        (point->parameter - output->options->from) / (output->options->to - output->options->from);
    report_row(&output->report, row);
    report_progress(&output->report, (int)(1000.0 * real_clamp(share, 0.0, 1.0)), 1000);
    return 1;
}

static int tell_end(const struct options *options, const struct continuation_report *end)
{
    if (end->end == END_REACHED || end->end == END_RETURNED) {
        return EXIT_FOUND;
    }
    fprintf(stderr, "afo study: %s, at %s = %.10g", continuation_end_name(end->end),
            parameter_name(options->over), end->parameter);
    if (end->end == END_LOST) {
        fprintf(stderr, ": %s", orbit_status_name(end->last_status));
        if (end->last_status == ORBIT_FAULT) {
            fprintf(stderr, " (%s)", stride_fault_name(end->last_fault));
        }
        fprintf(stderr, "; a smaller --step may carry it further, unless the gait ends here");
    } else {
        fprintf(stderr, "; give more with --points");
    }
    fprintf(stderr, "\n");
    return EXIT_NOT_FOUND;
}

int command_continue(int argc, char **argv)
{
    static const char *const columns[] = {"parameter",
                                          "stance_rate_rad_s",
                                          "swing_angle_rad",
                                          "swing_rate_rad_s",
                                          "re1",
                                          "im1",
                                          "re2",
                                          "im2",
                                          "re3",
                                          "im3",
                                          "stable",
                                          "inter_leg_rad",
                                          "step_length_m",
                                          "duration_s",
                                          "speed_m_s",
                                          "clamped_strides",
                                          "event",
                                          NULL};
    struct options options = {.common = command_defaults(),
                              .over = PARAMETER_R0,
                              .r0 = 0.05,
                              .step = 0.02,
                              .period = 1,
                              .points = 5000};
    struct output output = {.options = &options};
    struct problem problem;
    struct orbit orbit;
    double x[3];
    int status;
    command_parse(
        table, parse,
        "Follows a periodic gait in a parameter, through folds; prints each point, and the "
        "folds and period doublings between them.",
        argc, argv, &options);
    struct problem start = {.params = options.common.params, .r0_m = options.r0, .kp = options.kp};
    problem_set(&start, options.over, options.from);
    struct common common = options.common;
    common.params = start.params;
    if (!command_gait(&common, options.branch, start.r0_m, start.kp, &problem, x, &status)) {
        return status;
    }
    if (!periodic_find(&problem, x, options.period, &orbit)) {
        fprintf(stderr, "afo study: no walk of period %d found at %s = %g to start from\n",
                options.period, parameter_name(options.over), options.from);
        return EXIT_NOT_FOUND;
    }
    if (options.over == PARAMETER_KP && problem.kp == 0.0 &&
        !branch_find(BRANCH_LONG, &problem.params, problem.r0_m, problem.reference_x, NULL)) {
        fprintf(stderr, "afo study: the law has no reference speed at this r0\n");
        return EXIT_NOT_FOUND;
    }
    if (!report_open(&output.report, &options.common, "continue", "", columns)) {
        return EXIT_USAGE;
    }
    plot_name("parameter", parameter_name(options.over));
    const struct continuation continuation = {.problem = problem,
                                              .over = options.over,
                                              .from = options.from,
                                              .to = options.to,
                                              .first_step = 0.25 * options.step,
                                              .longest_step = options.step,
                                              .most_points = options.points,
                                              .locate_events = 1};
    report_value(&output.report, "over", cell_text(parameter_name(options.over)));
    report_value(&output.report, "period", cell_integer(options.period));
    const struct continuation_report end =
        continuation_follow(&continuation, orbit.x, NULL, print_point, &output);
    report_value(&output.report, "end", cell_text(continuation_end_name(end.end)));
    if (!report_close(&output.report)) {
        return EXIT_USAGE;
    }
    return tell_end(&options, &end);
}
