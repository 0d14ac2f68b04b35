/* afo export: a table that afo wrote, in a format of other tools. It is written in Python (sim_host/formats). */
#include <stdio.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/programs/commands.h"
#include "sim_host/programs/python_tool.h"

struct options {
    const char *table;
    const char *out;
};

static const struct argp_option option_list[] = {
    {"out", 'o', "FILE", 0,
     "write there; its ending says in what format: .parquet, OpenSim's .mot or .sto, or .svg, a moving picture",
     0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case 'o':
        options->out = text;
        return 0;
    case ARGP_KEY_ARG:
        if (options->table != NULL) {
            argp_error(state, "one table, found also \"%s\"", text);
        }
        options->table = text;
        return 0;
    case ARGP_KEY_END:
        if (options->table == NULL || options->out == NULL) {
            argp_error(state, "which table, and where to? afo export TABLE.csv --out FILE.parquet");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int afo_export(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        "TABLE.csv",
        "Turns a table that afo wrote into Parquet, or a table of ticks into an OpenSim motion or a moving picture. What TABLE.csv.json tells "
        "(parameters, versions, the recording) goes along.\v"
        "  afo sim --speed 0.8 --csv steps.csv --ticks=ticks.csv\n"
        "  afo export steps.csv --out steps.parquet\n"
        "  afo export ticks.csv --out walk.mot\n"
        "  afo export ticks.csv --out walk.svg\n\n"
        "A motion has Rajagopal's coordinates (2016): the pelvis at the hip, and hip, knee and ankle in degrees, flexion positive. A compass has straight knees. "
        "walk.mot has walk_grf.mot beside it, the ground's forces at a compass' toes or a person's centres of pressure. "
        "Trials of afo view are exported by afo report --export.\n\n"
        "Exit status: 0 written, 2 wrong usage, or a table that cannot be read.",
        0,
        0,
        0};
    static struct python_tool tool;
    struct options options = {0};
    option_parse(&parser, argc, argv, &options);
    if (python_tool_find(&tool, "formats", "walk_export.py") == 0) {
        const char *words[] = {NULL, NULL, "--out", options.out, "--", options.table, NULL};
        python_tool_become(&tool, words);
    }
    return EXIT_USAGE;
}
