/* afo study map: iterates the return map from a state; with --samples, the motion in between, too. */
#include <stdio.h>

#include "sim_host/study/paper/command.h"
#include "sim_host/study/paper/motion.h"

struct options {
    struct common common;
    double r0, kp, state[3];
    int steps, samples, has_state;
    enum branch branch;
};

static const struct argp_option table[] = {
    {"r0", 'r', "M", 0, "push-off (0.05); with --kp the law's set point", 0},
    {"state", 'x', "A,B,C", 0,
     "start: stance rate, swing angle, swing rate (the gait of the branch)", 0},
    {"branch", 'b', "long|short", 0, "gait to start from without --state (long)", 0},
    {"kp", 'K', "GAIN", 0, "gain of the step law (0)", 0},
    {"steps", 'n', "N", 0, "so many steps (20)", 0},
    {"samples", 's', "N", 0, "print the motion, N points a phase, not the apexes", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'x':
        command_numbers(argument, "state", 3, options->state, state);
        options->has_state = 1;
        return 0;
    case 'b':
        options->branch = command_branch(argument, state);
        return 0;
    case 'n':
        options->steps = command_integer(argument, "steps", 1, 100000000, state);
        return 0;
    case 's':
        options->samples = command_integer(argument, "samples", 2, 100000, state);
        return 0;
    default:
        return command_law(key, argument, &options->r0, &options->kp, state);
    }
}

static const char *const apex_columns[] = {"stride",
                                           "stance_rate_rad_s",
                                           "swing_angle_rad",
                                           "swing_rate_rad_s",
                                           "r0_m",
                                           "inter_leg_rad",
                                           "step_length_m",
                                           "apex_to_strike_s",
                                           "double_support_s",
                                           "lift_off_to_apex_s",
                                           "ankle_rate_m_s",
                                           "clamped",
                                           "fault",
                                           NULL};

static void print_apex(struct report *report, int stride_number, const double x[3], double r0,
                       const struct stride_result *r)
{
    const struct cell row[] = {cell_integer(stride_number),
                               cell_number(x[0]),
                               cell_number(x[1]),
                               cell_number(x[2]),
                               cell_number(r0),
                               cell_number(r->inter_leg_rad),
                               cell_number(r->step_length_m),
                               cell_number(r->apex_to_strike_s),
                               cell_number(r->double_support_s),
                               cell_number(r->lift_off_to_apex_s),
                               cell_number(r->ankle_rate_m_s),
                               cell_truth(r->clamped),
                               cell_text(stride_fault_name(r->fault))};
    report_row(report, row);
}

static const char *const motion_columns[] = {
    "time_s",           "stride",          "phase",
    "stance_angle_rad", "swing_angle_rad", "stance_rate_rad_s",
    "swing_rate_rad_s", "ankle_m",         NULL};

static void print_motion(void *context, double time, int stride_number, const char *phase,
                         const double s[4], double ankle)
{
    struct report *report = context;
    const struct cell row[] = {cell_number(time), cell_integer(stride_number), cell_text(phase),
                               cell_number(s[0]), cell_number(s[1]),           cell_number(s[2]),
                               cell_number(s[3]), cell_number(ankle)};
    report_row(report, row);
    if (report->plot != NULL) {
        motion_plot(report->plot, time, stride_number, phase, s, ankle);
    }
}

int command_map(int argc, char **argv)
{
    struct options options = {.common = command_defaults(), .r0 = 0.05, .steps = 20};
    struct report report;
    struct problem problem;
    double x[3], time = 0.0;
    int status;
    command_parse(table, parse, "Iterates the return map and prints each apex and fault.", argc,
                  argv, &options);
    if (options.has_state && options.kp == 0.0) {
        /* Needs no gait of its own: any state may be given, also where there is none. */
        struct orbit scratch;
        if (!command_check_walker(&options.common)) {
            return EXIT_USAGE;
        }
        problem =
            (struct problem){.params = options.common.params, .r0_m = options.r0, .period = 1};
        (void)problem_prepare(&problem, &scratch);
    } else if (!command_gait(&options.common, options.branch, options.r0, options.kp, &problem, x,
                             &status)) {
        return status;
    }
    for (int i = 0; i < 3 && options.has_state; i++) {
        x[i] = options.state[i];
    }
    if (!report_open(&report, &options.common, "map", "",
                     options.samples > 0 ? motion_columns : apex_columns)) {
        return EXIT_USAGE;
    }
    if (options.samples > 0) {
        report_plot_own(&report, "map-motion", MOTION_PLOT_COLUMNS);
    }
    enum stride_fault fault = STRIDE_OK;
    for (int i = 0; i < options.steps && fault == STRIDE_OK; i++) {
        double next[3], r0;
        struct stride_result r;
        fault = problem_stride(&problem, x, next, &r0, &r);
        if (options.samples == 0) {
            print_apex(&report, i, x, r0, &r);
        } else if (fault == STRIDE_OK) {
            const struct motion_stride stride = {&problem, x, r0, &r, i};
            motion_walk(&stride, options.samples, &time, print_motion, &report);
        }
        for (int k = 0; k < 3 && fault == STRIDE_OK; k++) {
            x[k] = next[k];
        }
        report_progress(&report, i + 1, options.steps);
    }
    report_value(&report, "fault", cell_text(stride_fault_name(fault)));
    if (fault == STRIDE_OK) {
        report_list(&report, "last", x, 3);
    }
    return !report_close(&report) ? EXIT_USAGE : fault == STRIDE_OK ? EXIT_FOUND : EXIT_NOT_FOUND;
}
