/* afo study fixed-point: a periodic gait, by Newton, with its eigenvalues and measures. */
#include <stdio.h>

#include "sim_host/plant/walking_units.h"
#include "sim_host/study/paper/command.h"
#include "sim_host/study/paper/motion.h"
#include "sim_host/study/paper/periodic.h"

enum { PICTURE_SAMPLES = 100 };

struct options {
    struct common common;
    double r0, kp, guess[3];
    enum branch branch;
    int period, has_guess;
};

static const struct argp_option table[] = {
    {"r0", 'r', "M", 0, "push-off: the spring's rest length (0.05)", 0},
    {"branch", 'b', "long|short", 0, "which of the two period-1 gaits (long)", 0},
    {"period", 'p', "N", 0, "steps until the gait repeats (1)", 0},
    {"kp", 'K', "GAIN", 0, "gain of the step law, m per rad/s (0: no law)", 0},
    {"guess", 'x', "A,B,C", 0, "Newton starts from this stance rate, swing angle, swing rate", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'b':
        options->branch = command_branch(argument, state);
        return 0;
    case 'p':
        options->period = command_integer(argument, "period", 1, ORBIT_MAX_PERIOD, state);
        return 0;
    case 'x':
        command_numbers(argument, "guess", 3, options->guess, state);
        options->has_guess = 1;
        return 0;
    default:
        return command_law(key, argument, &options->r0, &options->kp, state);
    }
}

static int find(const struct options *options, struct problem *problem, struct orbit *orbit)
{
    double x[3];
    int status;
    if (!command_gait(&options->common, options->branch, options->r0, options->kp, problem, x,
                      &status)) {
        return status;
    }
    if (options->has_guess) {
        problem->period = options->period;
        for (int i = 0; i < 3; i++) {
            orbit->x[i] = options->guess[i];
        }
        const enum orbit_status found = orbit_find(problem, orbit);
        if (found != ORBIT_OK) {
            command_explain("no fixed point from this guess", found, orbit);
            return EXIT_NOT_FOUND;
        }
        return EXIT_FOUND;
    }
    if (options->period == 1 && options->branch == BRANCH_SHORT && options->kp != 0.0) {
        fprintf(stderr, "afo study: under the law the short branch's gaits are not where they are "
                        "without it; give --guess\n");
        return EXIT_USAGE;
    }
    if (!periodic_find(problem, x, options->period, orbit)) {
        fprintf(stderr,
                "afo study: no walk of period %d found at r0 = %g m; `afo study bifurcation` shows "
                "which periods there are, --guess gives Newton another start\n",
                options->period, options->r0);
        return EXIT_NOT_FOUND;
    }
    return EXIT_FOUND;
}

/* The same gait as a laboratory reports it; margin and double support are the first step's. */
static void in_walking_units(const struct problem *problem, const struct orbit *orbit,
                             struct report *report)
{
    const struct walker_params *p = &problem->params;
    const double step_s = orbit->duration_s / problem->period;
    const double work_J = orbit->spring_energy_J / problem->period;
    const struct walking_pose pose = {
        .hip_mass_kg = p->hip_mass_kg,
        .leg_mass_kg = p->leg_mass_kg,
        .leg_length_m = p->leg_length_m,
        .gravity_m_s2 = p->gravity_m_s2,
        .stance_rad = orbit->first.strike[0],
        .swing_rad = orbit->first.strike[1],
        .stance_rad_s = orbit->first.strike[2],
        .swing_rad_s = orbit->first.strike[3],
    };
    report_value(report, "cadence_per_min", cell_number(walking_cadence_per_min(step_s)));
    report_value(report, "stance_percent",
                 cell_number(50.0 * (1.0 + orbit->first.double_support_s / step_s)));
    report_value(report, "double_support_percent",
                 cell_number(100.0 * orbit->first.double_support_s / step_s));
    report_value(report, "push_off_J", cell_number(work_J));
    report_value(report, "push_off_J_per_kg",
                 cell_number(work_J / (p->hip_mass_kg + 2.0 * p->leg_mass_kg)));
    report_value(report, "margin_of_stability_m", cell_number(walking_margin_m(&pose)));
}

static void print(const struct options *options, const struct problem *problem,
                  const struct orbit *orbit, struct report *report)
{
    struct eigenvalue values[3];
    const struct walker_params *p = &problem->params;
    const double weight = (p->hip_mass_kg + 2.0 * p->leg_mass_kg) * p->gravity_m_s2;
    linear_eigenvalues3((const double(*)[3])orbit->by_x, values);
    const double pairs[6] = {values[0].re, values[0].im, values[1].re,
                             values[1].im, values[2].re, values[2].im};
    const double times[3] = {orbit->first.apex_to_strike_s, orbit->first.double_support_s,
                             orbit->first.lift_off_to_apex_s};
    report_value(report, "r0_m", cell_number(options->r0));
    report_value(report, "kp", cell_number(options->kp));
    report_value(report, "branch", cell_text(options->branch == BRANCH_LONG ? "long" : "short"));
    report_list(report, "x", orbit->x, 3);
    report_pairs(report, "eigenvalues", pairs, 3);
    if (values[2].im == 0.0) {
        double direction[3];
        linear_eigenvector3((const double(*)[3])orbit->by_x, values[2].re, direction);
        report_list(report, "smallest_eigenvector", direction, 3);
    }
    report_value(report, "inter_leg_rad", cell_number(orbit->first.inter_leg_rad));
    report_value(report, "step_length_m", cell_number(orbit->first.step_length_m));
    report_list(report, "times_s", times, 3);
    report_value(report, "speed_m_s", cell_number(orbit->distance_m / orbit->duration_s));
    report_value(report, "cost_of_transport",
                 cell_number(orbit->spring_energy_J / (weight * orbit->distance_m)));
    in_walking_units(problem, orbit, report);
    report_value(report, "residual", cell_number(orbit->residual));
    report_value(report, "period", cell_integer(problem->period));
    report_value(report, "stable", cell_truth(linear_magnitude(values[0]) < 1.0));
    report_value(report, "clamped_strides", cell_integer(orbit->clamped_strides));
}

static void print_strides(const struct problem *problem, const struct orbit *orbit,
                          struct report *report)
{
    double x[3] = {orbit->x[0], orbit->x[1], orbit->x[2]}, time_s = 0.0;
    for (int i = 0; i < problem->period; i++) {
        double next[3], r0;
        struct stride_result result;
        if (problem_stride(problem, x, next, &r0, &result) != STRIDE_OK) {
            return;
        }
        const struct cell row[] = {cell_integer(i),
                                   cell_number(x[0]),
                                   cell_number(x[1]),
                                   cell_number(x[2]),
                                   cell_number(r0),
                                   cell_number(result.inter_leg_rad),
                                   cell_number(result.step_length_m),
                                   cell_number(result.ankle_rate_m_s)};
        report_row(report, row);
        if (report->plot != NULL) {
            const struct motion_stride stride = {problem, x, r0, &result, i};
            motion_walk(&stride, PICTURE_SAMPLES, &time_s, motion_plot, report->plot);
        }
        for (int k = 0; k < 3; k++) {
            x[k] = next[k];
        }
    }
}

int command_fixed_point(int argc, char **argv)
{
    static const char *const columns[] = {
        "stride", "stance_rate_rad_s", "swing_angle_rad", "swing_rate_rad_s",
        "r0_m",   "inter_leg_rad",     "step_length_m",   "ankle_rate_m_s",
        NULL};
    struct options options = {.common = command_defaults(), .r0 = 0.05, .period = 1};
    struct problem problem = {.period = 1};
    struct orbit orbit = {.residual = 0.0};
    struct report report;
    command_parse(
        table, parse,
        "Finds a periodic gait and tells its eigenvalues and measures.\v"
        "x: at the apex the stance rate (rad/s), swing angle (rad) and swing rate (rad/s). times_s: apex to "
        "heel strike, double support, lift-off to apex. eigenvalues: [real, imaginary] each.",
        argc, argv, &options);
    const int status = find(&options, &problem, &orbit);
    if (status != EXIT_FOUND) {
        return status;
    }
    if (!report_open(&report, &options.common, "fixed-point", "", columns)) {
        return EXIT_USAGE;
    }
    report_plot_own(&report, "fixed-point", MOTION_PLOT_COLUMNS);
    print(&options, &problem, &orbit, &report);
    print_strides(&problem, &orbit, &report);
    return report_close(&report) ? EXIT_FOUND : EXIT_USAGE;
}
