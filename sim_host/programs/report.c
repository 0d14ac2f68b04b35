/* afo report: a trial, or two beside each other, as one HTML file; or its signals for the tools of others. */
#include <stdio.h>
#include <stdlib.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/programs/commands.h"
#include "sim_host/programs/python_tool.h"
#include "sim_host/programs/view_subject.h"

enum { KEY_OUT = 0x800, KEY_EXPORT, TRIALS_MAX = 2, ARGUMENTS_MAX = 16 };

struct options {
    struct walk_options walk;
    const char *trial[TRIALS_MAX];
    int trials;
    const char *out;
    const char *kind; /* NULL: a report */
    bool is_log;      /* a log instead of a trial: --person and --device say whose */
};

static const struct argp_option option_list[] = {
    {"out", KEY_OUT, "FILE", 0,
     "write there, - is standard output (default: report.html in the trial)", 2},
    {"export", KEY_EXPORT, "KIND", 0,
     "all signals by tick instead: csv, parquet or mcap (needs --out)", 2},
    {"log", 'l', 0, 0, "TRIAL is a candump log; --person and --device say whose", 2},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    static const char *const kinds[] = {"csv", "parquet", "mcap"};
    struct options *options = (struct options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        return 0;
    case KEY_OUT:
        options->out = text;
        return 0;
    case KEY_EXPORT:
        options->kind = kinds[option_choice(state, "--export", text, kinds, 3, sizeof kinds[0])];
        return 0;
    case 'l':
        options->is_log = true;
        return 0;
    case ARGP_KEY_ARG:
        if (options->trials == TRIALS_MAX) {
            argp_error(state, "one trial, or two to compare, found also \"%s\"", text);
        }
        options->trial[options->trials++] = text;
        return 0;
    case ARGP_KEY_END:
        if (options->trials == 0) {
            argp_error(state, "which trial? afo report TRIAL");
        }
        if ((options->kind != NULL || options->is_log) && options->out == NULL) {
            argp_error(state, "--export and --log need --out FILE");
        }
        if (options->kind != NULL && options->trials > 1) {
            argp_error(state, "--export takes one trial");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static char *subject_of(const struct options *options)
{
    struct subject subject;
    struct control_params params;
    struct view_options view = {.sim.walk = options->walk};
    double speed_rad_s = 0.0;
    char message[SUBJECT_MESSAGE_MAX] = "";
    if (walk_options_resolve(&options->walk, &subject, &params, &speed_rad_s, message) != 0) {
        program_complain("%s", message);
        return NULL;
    }
    return view_subject_json(&subject, &params, speed_rad_s, &view);
}

static void become(const struct options *options, const struct python_tool *tool, const char *who)
{
    const char *arguments[ARGUMENTS_MAX] = {NULL};
    const char *given[][2] = {{"--afo", tool->program},
                              {"--subject", who},
                              {"--out", options->out},
                              {"--kind", options->kind}};
    int count = 2;
    for (size_t i = 0; i < sizeof given / sizeof given[0]; i++) {
        if (given[i][1] != NULL) {
            arguments[count++] = given[i][0];
            arguments[count++] = given[i][1];
        }
    }
    for (int i = 0; i < options->trials; i++) {
        arguments[count++] = options->trial[i];
    }
    python_tool_become(tool, arguments);
}

int afo_report(int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 3}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        "TRIAL [TRIAL]",
        "Makes one self-contained HTML file of a trial that afo view recorded, or of two to compare.\v"
        "Exit status: 0 written, 2 wrong usage, or a trial that cannot be read.",
        children,
        0,
        0};
    static struct python_tool tool;
    struct options options = {0};
    walk_options_init(&options.walk);
    option_parse(&parser, argc, argv, &options);
    char *who = options.is_log ? subject_of(&options) : NULL;
    if ((!options.is_log || who != NULL) &&
        python_tool_find(&tool, "view", options.kind != NULL ? "export.py" : "report.py") == 0) {
        become(&options, &tool, who);
    }
    free(who);
    return EXIT_USAGE;
}
