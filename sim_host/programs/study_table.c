/* afo study table: prints the controller's table of the gait curve (r0 -> apex speed) as C source.
 *
 * The other commands compute this table for each subject themselves; printed it serves a board
 * without a host. The first line of the output is the command that made it.
 */
#include <stdio.h>
#include <stdlib.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/gait/gait_curve.h"
#include "sim_host/programs/commands.h"
#include "sim_host/study/plot.h"

enum { POINTS_MAX = 64 };

struct options {
    struct gait_walker walker;
    double from_share, to_share; /* of the leg length */
    const char *name;
};

static const struct argp_option option_table[] = {
    {"M", 'M', "KG", 0, "hip mass (1)", 0},
    {"m", 'm', "KG", 0, "mass of one leg (0.01)", 0},
    {"l", 'l', "M", 0, "leg length (1)", 0},
    {"k", 'k', "N/M", 0, "ankle stiffness (100)", 0},
    {"g", 'g', "M/S2", 0, "gravity (9.80665)", 0},
    {"from", 'f', "SHARE", 0, "first r0 in leg lengths (0.005)", 0},
    {"to", 't', "SHARE", 0, "last r0 in leg lengths, about (0.3)", 0},
    {"name", 'n', "NAME", 0, "name of the C object (speed_table_paper)", 0},
    {0},
};

static double number(const char *text, const char *what, const struct argp_state *state)
{
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end != '\0') {
        argp_error(state, "%s: \"%s\" is not a number", what, text);
    }
    return value;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'M':
        options->walker.hip_mass_kg = number(argument, "--M", state);
        return 0;
    case 'm':
        options->walker.leg_mass_kg = number(argument, "--m", state);
        return 0;
    case 'l':
        options->walker.leg_length_m = number(argument, "--l", state);
        return 0;
    case 'k':
        options->walker.ankle_stiffness_N_m = number(argument, "--k", state);
        return 0;
    case 'g':
        options->walker.gravity_m_s2 = number(argument, "--g", state);
        return 0;
    case 'f':
        options->from_share = number(argument, "--from", state);
        return 0;
    case 't':
        options->to_share = number(argument, "--to", state);
        return 0;
    case 'n':
        options->name = argument;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Where the ankle begins to start from rest (a kink of the curve), by bisection; 0 if not between. */
static double knee_m(const struct gait_walker *walker, double low_m, double high_m)
{
    struct gait_point point;
    if (gait_curve(walker, high_m, 0.0, 1, &point, NULL) != GAIT_CURVE_OK || !point.clamped) {
        return 0.0;
    }
    for (int i = 0; i < 30; i++) {
        const double middle = 0.5 * (low_m + high_m);
        if (gait_curve(walker, middle, 0.0, 1, &point, NULL) != GAIT_CURVE_OK) {
            return 0.0;
        }
        *(point.clamped ? &high_m : &low_m) = middle;
    }
    return high_m;
}

static void print_table(const struct options *options, double step_m, int knee, char **argv)
{
    static struct gait_point points[POINTS_MAX];
    const double first_m = options->from_share * options->walker.leg_length_m;
    int count;
    const enum gait_curve_error error =
        gait_curve(&options->walker, first_m, step_m, POINTS_MAX, points, &count);
    if (error == GAIT_CURVE_BAD_WALKER || error == GAIT_CURVE_BAD_GRID || count < 4) {
        program_complain("%s", gait_curve_error_name(error));
        exit(EXIT_USAGE);
    }
    if (count < POINTS_MAX) {
        program_complain("the curve ends behind r0 = %g m; table cut there",
                         points[count - 1].r0_m);
    }
    printf("/* Generated, do not edit: build/afo study table");
    for (char **argument = argv + 1; *argument != NULL; argument++) {
        printf(" %s", *argument);
    }
    printf("\n *\n * Walker: M %g kg, m %g kg, l %g m, k %g N/m, g %g m/s^2.\n",
           options->walker.hip_mass_kg, options->walker.leg_mass_kg, options->walker.leg_length_m,
           options->walker.ankle_stiffness_N_m, options->walker.gravity_m_s2);
    printf(
        " * Interpolate the SQUARE of the speed (it is smooth down to r0 = 0, the speed is not)\n"
        " * by a cubic through four neighbours.");
    if (knee > 0) {
        printf(" Entry %d lies on the curve's kink,\n"
               " * where the ankle begins to start from rest.",
               knee);
    }
    printf("\n */\n#include \"controller/laws/speed_table.h\"\n\n");
    printf("const struct speed_table %s = {\n    .count = %d,\n    .r0_min_m = REAL(%.17g),\n"
           "    .r0_step_m = REAL(%.17g),\n    .speed_rad_s =\n        {\n",
           options->name, count, first_m, step_m);
    for (int i = 0; i < count; i++) {
        printf("%s%s", i % 3 == 0 ? "            " : " ", "");
        printf("REAL(%.15f),%s", points[i].speed_rad_s, i % 3 == 2 || i == count - 1 ? "\n" : "");
    }
    printf("        },\n};\n");
    FILE *picture = plot_table("table");
    if (picture != NULL) {
        fputs("r0_m,speed_rad_s\n", picture);
    }
    for (int i = 0; i < count && picture != NULL; i++) {
        fprintf(picture, "%.9g,%.9g\n", points[i].r0_m, points[i].speed_rad_s);
    }
}

int afo_study_table(int argc, char **argv)
{
    struct options options = {gait_walker_of_paper(), 0.005, 0.3, "speed_table_paper"};
    const struct argp parser = {option_table,
                                parse,
                                NULL,
                                "Prints the gait curve of a walker as the C table the controller "
                                "reads its push-off from.\v"
                                "Exit status: 0 printed, 2 wrong usage or output not writable.",
                                NULL,
                                NULL,
                                NULL};
    plot_option_parse(&parser, argc, argv, &options);
    const double l = options.walker.leg_length_m;
    const double first_m = options.from_share * l, last_m = options.to_share * l;
    const double knee = knee_m(&options.walker, first_m, last_m);
    double step_m = (last_m - first_m) / (POINTS_MAX - 1);
    int knee_entry = 0;
    if (knee > first_m + 4.0 * step_m) {
        knee_entry = (int)((knee - first_m) / step_m + 0.5);
        step_m = (knee - first_m) / knee_entry;
    }
    print_table(&options, step_m, knee_entry, argv);
    return program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE;
}
