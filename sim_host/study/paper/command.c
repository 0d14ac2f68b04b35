#include "sim_host/study/paper/command.h"

#include <stdlib.h>
#include <string.h>

#include "sim_host/study/plot.h"
#include "sim_host/study/pool.h"

enum { KEY_JSON = 1000, KEY_CSV, KEY_THREADS, KEY_OUT, KEY_RESUME, KEY_QUIET };

static const struct argp_option common_table[] = {
    {0, 0, 0, 0, "Walker (default: the paper's):", 100},
    {"M", 'M', "KG", 0, "hip mass (1)", 100},
    {"m", 'm', "KG", 0, "mass of one leg (0.01)", 100},
    {"l", 'l', "M", 0, "leg length (1)", 100},
    {"k", 'k', "N/M", 0, "ankle stiffness (100)", 100},
    {"g", 'g', "M/S2", 0, "gravity (9.80665)", 100},
    {0, 0, 0, 0, "Output:", 101},
    {"json", KEY_JSON, 0, 0, "one JSON object", 101},
    {"csv", KEY_CSV, 0, 0, "comma-separated values", 101},
    {"out", KEY_OUT, "FILE", 0, "write there, not to standard output", 101},
    {"resume", KEY_RESUME, 0, 0, "go on where the CSV file of --out ends", 101},
    {"quiet", KEY_QUIET, 0, 0, "no progress line", 101},
    {"threads", KEY_THREADS, "N", 0,
     "use so many threads (all processors); no result depends on it", 101},
    {0},
};

struct common command_defaults(void)
{
    const struct common common = {
        .params = walker_paper_params(), .format = FORMAT_TEXT, .threads = pool_processors()};
    return common;
}

double command_number(const char *text, const char *option, const struct argp_state *state)
{
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end != '\0' || !real_is_finite(value)) {
        argp_error(state, "--%s: \"%s\" is not a number", option, text);
    }
    return value;
}

void command_numbers(const char *text, const char *option, int count, double *values,
                     const struct argp_state *state)
{
    const char *at = text;
    for (int i = 0; i < count; i++) {
        char *end;
        values[i] = strtod(at, &end);
        if (end == at || !real_is_finite(values[i]) || *end != (i + 1 < count ? ',' : '\0')) {
            argp_error(state, "--%s: \"%s\" is not a list of %d numbers separated by commas",
                       option, text, count);
            return;
        }
        at = end + 1;
    }
}

error_t command_law(int key, const char *argument, double *r0, double *kp,
                    const struct argp_state *state)
{
    if (key == 'r' && r0 != NULL) {
        *r0 = command_number(argument, "r0", state);
    } else if (key == 'K') {
        *kp = command_number(argument, "kp", state);
    } else {
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

int command_list(const char *text, const char *option, int most, double *values,
                 const struct argp_state *state)
{
    int count = 1;
    for (const char *at = text; *at != '\0'; at++) {
        count += *at == ',';
    }
    if (count > most) {
        argp_error(state, "--%s: at most %d numbers", option, most);
        return 0;
    }
    command_numbers(text, option, count, values, state);
    return count;
}

int command_integer(const char *text, const char *option, int low, int high,
                    const struct argp_state *state)
{
    char *end;
    const long value = strtol(text, &end, 10);
    if (end == text || *end != '\0' || value < low || value > high) {
        argp_error(state, "--%s: \"%s\" is not a whole number from %d to %d", option, text, low,
                   high);
    }
    return (int)value;
}

enum branch command_branch(const char *text, const struct argp_state *state)
{
    if (strcmp(text, "long") != 0 && strcmp(text, "short") != 0) {
        argp_error(state, "--branch: \"%s\" is neither long nor short", text);
    }
    return strcmp(text, "short") == 0 ? BRANCH_SHORT : BRANCH_LONG;
}

static error_t parse_common(int key, char *argument, struct argp_state *state)
{
    struct common *common = state->input;
    switch (key) {
    case 'M':
        common->params.hip_mass_kg = command_number(argument, "M", state);
        return 0;
    case 'm':
        common->params.leg_mass_kg = command_number(argument, "m", state);
        return 0;
    case 'l':
        common->params.leg_length_m = command_number(argument, "l", state);
        return 0;
    case 'k':
        common->params.ankle_stiffness_N_m = command_number(argument, "k", state);
        return 0;
    case 'g':
        common->params.gravity_m_s2 = command_number(argument, "g", state);
        return 0;
    case KEY_JSON:
        common->format = FORMAT_JSON;
        return 0;
    case KEY_CSV:
        common->format = FORMAT_CSV;
        return 0;
    case KEY_OUT:
        common->out_path = argument;
        return 0;
    case KEY_RESUME:
        common->resume = 1;
        return 0;
    case KEY_QUIET:
        common->quiet = 1;
        return 0;
    case KEY_THREADS:
        common->threads = command_integer(argument, "threads", 1, 256, state);
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "unexpected argument \"%s\"", argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static argp_parser_t own_parser;

static error_t parse_both(int key, char *argument, struct argp_state *state)
{
    if (key == ARGP_KEY_INIT) {
        state->child_inputs[0] = state->input; /* the struct common it begins with */
        return 0;
    }
    return own_parser(key, argument, state);
}

void command_parse(const struct argp_option *table, argp_parser_t parser, const char *doc, int argc,
                   char **argv, void *options)
{
    const struct argp common = {common_table, parse_common, 0, 0, 0, 0, 0};
    const struct argp_child children[] = {{&common, 0, 0, 0}, {0}};
    const struct argp whole = {table, parse_both, 0, doc, children, 0, 0};
    own_parser = parser;
    plot_option_parse(&whole, argc, argv, options);
}

int command_check_walker(const struct common *common)
{
    struct walker walker;
    const enum walker_error error = walker_init(&walker, &common->params);
    if (error != WALKER_OK) {
        fprintf(stderr, "afo study: %s\n", walker_error_name(error));
    }
    return error == WALKER_OK;
}

void command_explain(const char *what, enum orbit_status status, const struct orbit *orbit)
{
    fprintf(stderr, "afo study: %s: %s", what, orbit_status_name(status));
    if (status == ORBIT_FAULT) {
        fprintf(
            stderr,
            " (%s, in step %d from stance rate %g rad/s, swing angle %g rad, swing rate %g rad/s)",
            stride_fault_name(orbit->fault), orbit->fault_step + 1, orbit->x[0], orbit->x[1],
            orbit->x[2]);
    }
    fprintf(stderr, "\n");
}

int command_gait(const struct common *common, enum branch branch, double r0, double kp,
                 struct problem *problem, double x[3], int *status)
{
    double lost_at;
    struct orbit scratch;
    *status = EXIT_USAGE;
    if (!command_check_walker(common)) {
        return 0;
    }
    if (!(r0 > 0.0 && r0 < common->params.leg_length_m)) {
        fprintf(stderr, "afo study: r0 = %g m must be above 0 and below the leg length of %g m\n",
                r0, common->params.leg_length_m);
        return 0;
    }
    *status = EXIT_NOT_FOUND;
    *problem = (struct problem){.params = common->params, .r0_m = r0, .kp = kp, .period = 1};
    if (!branch_find(branch, &common->params, r0, x, &lost_at)) {
        fprintf(
            stderr,
            "afo study: no period-1 gait of the %s branch found at r0 = %g m: followed from the "
            "paper's walker, the branch is lost near r0 = %g m; try an r0 on this side of it, or "
            "a walker nearer to the paper's\n",
            branch == BRANCH_LONG ? "long" : "short", r0, lost_at);
        return 0;
    }
    if (kp != 0.0 &&
        !branch_find(BRANCH_LONG, &common->params, r0, problem->reference_x, &lost_at)) {
        fprintf(
            stderr,
            "afo study: the law has no reference speed: the long branch is lost near r0 = %g m\n",
            lost_at);
        return 0;
    }
    const enum orbit_status prepared = problem_prepare(problem, &scratch);
    if (prepared != ORBIT_OK) {
        command_explain("cannot start", prepared, &scratch);
        return 0;
    }
    *status = EXIT_FOUND;
    return 1;
}
