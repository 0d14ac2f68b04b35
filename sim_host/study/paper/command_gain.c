/* afo study gain: eigenvalues of the long branch's gaits under the step law, and the best gain. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/gait/loop_gain.h"
#include "sim_host/study/paper/command.h"

enum { GAINS_MAX = 16, POINTS_MAX = 100000 };

struct options {
    struct common common;
    double from, to, gains[GAINS_MAX];
    int points, gain_count, best;
};

static const struct argp_option table[] = {
    {"from", 'f', "M", 0, "first r0 (0.05 leg lengths)", 0},
    {"to", 't', "M", 0, "last r0 (0.27 leg lengths)", 0},
    {"points", 'n', "N", 0, "so many r0 (100)", 0},
    {"kp", 'K', "GAIN,...", 0,
     "gains, m per rad/s (0, 0.02 and 0.042 times l sqrt(l/g) over the paper's)", 0},
    {"best", 'b', 0, 0, "find the gain that makes the largest eigenvalue over the range smallest",
     0},
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
    case 'K':
        options->gain_count = command_list(argument, "kp", GAINS_MAX, options->gains, state);
        return 0;
    case 'b':
        options->best = 1;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Follows the branch over the range. Returns how many points were reached. */
static int gather(const struct options *options, struct loop_point *points)
{
    const struct walker_params *p = &options->common.params;
    const double l = p->leg_length_m, unit_s = real_sqrt(l / p->gravity_m_s2);
    const double ratio = p->leg_mass_kg / p->hip_mass_kg;
    const double stiffness = p->ankle_stiffness_N_m * l / (p->hip_mass_kg * p->gravity_m_s2);
    struct branch_gait gait = branch_start(BRANCH_LONG);
    if (!branch_follow(&gait, ratio, stiffness, gait.r0)) {
        return 0;
    }
    for (int i = 0; i < options->points; i++) {
        struct loop_point *point = &points[i];
        point->r0_m = options->from + (options->to - options->from) * i / (options->points - 1);
        struct problem problem = {.params = *p, .r0_m = point->r0_m, .period = 1};
        struct orbit orbit;
        if (!branch_follow(&gait, ratio, stiffness, point->r0_m / l) ||
            problem_prepare(&problem, &orbit) != ORBIT_OK) {
            return i;
        }
        for (int k = 0; k < 3; k++) {
            orbit.x[k] = gait.x[k] / (k == 1 ? 1.0 : unit_s);
        }
        if (orbit_find(&problem, &orbit) != ORBIT_OK) {
            return i;
        }
        point->speed_rad_s = -orbit.x[0];
        for (int k = 0; k < 3; k++) {
            point->by_r0[k] = orbit.by_parameter[k][PARAMETER_R0];
            for (int j = 0; j < 3; j++) {
                point->by_apex[k][j] = orbit.by_x[k][j];
            }
        }
    }
    return options->points;
}

static void print(const struct options *options, const struct loop_point *points, int count,
                  struct report *report)
{
    for (int k = 0; k < options->gain_count; k++) {
        for (int i = 0; i < count; i++) {
            struct eigenvalue v[3];
            loop_gain_eigenvalues(&points[i], options->gains[k], v);
            const struct cell row[] = {cell_number(options->gains[k]),
                                       cell_number(points[i].r0_m),
                                       cell_number(points[i].speed_rad_s),
                                       cell_number(v[0].re),
                                       cell_number(v[0].im),
                                       cell_number(v[1].re),
                                       cell_number(v[1].im),
                                       cell_number(v[2].re),
                                       cell_number(v[2].im),
                                       cell_number(linear_magnitude(v[0]))};
            report_row(report, row);
        }
    }
}

/* Where the gain leaves the largest eigenvalue. */
static const struct loop_point *least_stable(const struct loop_point *points, int count, double kp)
{
    const struct loop_point *worst = points;
    for (int i = 1; i < count; i++) {
        worst = loop_gain_largest(&points[i], 1, kp) > loop_gain_largest(worst, 1, kp) ? &points[i]
                                                                                       : worst;
    }
    return worst;
}

/* 0, or -1 with words where no gain makes all the gaits stable. */
static int print_best(const struct loop_point *points, int count, double unit,
                      struct report *report)
{
    const double best = loop_gain_best(points, count, unit);
    const double largest = loop_gain_largest(points, count, best);
    report_value(report, "best_kp", cell_number(best));
    report_value(report, "largest_with_best_kp", cell_number(largest));
    report_value(report, "largest_without_law", cell_number(loop_gain_largest(points, count, 0.0)));
    report_value(report, "stable_with_best_kp", cell_truth(largest < 1.0));
    if (largest < 1.0) {
        return 0;
    }
    fprintf(
        stderr,
        "afo study: no gain of eq. (16) stabilises this walker from r0 = %g to %g m: looked for up to %.3g m per "
        "rad/s, the best, %.4g, leaves an eigenvalue of %.3g at r0 = %g m (without the law %.3g). Narrow the range "
        "with --from and --to, or take a law on the whole state: --law dlqr, deadbeat or predictive of afo sim\n",
        points[0].r0_m, points[count - 1].r0_m, LOOP_GAIN_MOST * unit, best, largest,
        least_stable(points, count, best)->r0_m, loop_gain_largest(points, count, 0.0));
    return -1;
}

int command_gain(int argc, char **argv)
{
    static const char *const columns[] = {"kp",  "r0_m", "speed_rad_s", "re1",     "im1", "re2",
                                          "im2", "re3",  "im3",         "largest", NULL};
    struct options options = {
        .common = command_defaults(), .from = NO_NUMBER, .to = NO_NUMBER, .points = 100};
    struct report report;
    command_parse(table, parse,
                  "Eigenvalues of the long branch's period-1 gaits over r0 under the step law "
                  "r0[k] = finv(v*) - kp (v* - v[k]).",
                  argc, argv, &options);
    if (!command_check_walker(&options.common)) {
        return EXIT_USAGE;
    }
    const struct walker_params paper = walker_paper_params();
    const struct walker_params *p = &options.common.params;
    const double l = p->leg_length_m;
    const double unit = l * real_sqrt(l / p->gravity_m_s2) /
                        (paper.leg_length_m * real_sqrt(paper.leg_length_m / paper.gravity_m_s2));
    const double paper_gains[3] = {0.0, 0.02, 0.042};
    options.from = options.from != options.from ? 0.05 * l : options.from;
    options.to = options.to != options.to ? 0.27 * l : options.to;
    for (int i = 0; i < 3 && options.gain_count == i; i++) {
        options.gains[options.gain_count++] = paper_gains[i] * unit;
    }
    if (!(options.from > 0.0 && options.to > options.from && options.to < l)) {
        fprintf(stderr,
                "afo study: r0 must rise from --from to --to between 0 and the leg length\n");
        return EXIT_USAGE;
    }
    struct loop_point *points = malloc((size_t)options.points * sizeof *points);
    if (points == NULL) {
        fprintf(stderr, "afo study: out of memory\n");
        return EXIT_NOT_FOUND;
    }
    const int count = gather(&options, points);
    if (count < options.points) {
        fprintf(stderr,
                "afo study: the long branch is lost before r0 = %g m; try a --to below it\n",
                options.from + (options.to - options.from) * count / (options.points - 1));
    }
    int status = EXIT_USAGE;
    if (count == 0) {
        status = EXIT_NOT_FOUND;
    } else if (report_open(&report, &options.common, "gain", "", columns)) {
        print(&options, points, count, &report);
        const int is_stable = !options.best || print_best(points, count, unit, &report) == 0;
        status = !report_close(&report)                 ? EXIT_USAGE
                 : is_stable && count == options.points ? EXIT_FOUND
                                                        : EXIT_NOT_FOUND;
    }
    free(points);
    return status;
}
