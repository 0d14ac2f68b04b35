#include "sim_host/faults/fault_options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/faults/fault_kinds.h"
#include "sim_host/text/nearest.h"

enum {
    KEY_RUNS = 0x500,
    KEY_JOBS,
    KEY_SEED,
    KEY_OUT,
    KEY_RUN,
    KEY_LOG,
    KEY_TICKS,
    KEY_MARKDOWN,
    KEY_ONLY,
    KEY_PEOPLE,
    KEY_PLANT,
    KEY_DATA,
    KEY_PERSON,
    KEY_DEVICE
};

static const struct argp_option option_list[] = {
    {"runs", KEY_RUNS, "N", 0, "how many runs (default 500)", 0},
    {"jobs", KEY_JOBS, "N", 0, "processes (default 1)", 0},
    {"seed", KEY_SEED, "N", 0, "which campaign (default 1)", 0},
    {"out", KEY_OUT, "DIR", 0, "keep results there; runs that are there are not made again", 0},
    {"only", KEY_ONLY, "TEXT", 0,
     "of those N only the runs whose first fault's name contains TEXT, such as \"foreign\"", 0},
    {"people", KEY_PEOPLE, 0, 0,
     "recorded and made people in the walker's place, and changed copies of them; to be called at the top of "
     "the source tree, where the persons and devices are",
     0},
    {"plant", KEY_PLANT, "KIND", 0,
     "reflex: a person who walks by reflexes, that of --person or an adult, with --device or two devices of this "
     "tree. Each fall is compared with the same walk without the device",
     0},
    {"data", KEY_DATA, "DIR", 0,
     "with --people: a folder of recordings, such as DIR/NAME.csv and DIR/people/NAME.csv (default: AFO_DATA)",
     0},
    {"person", KEY_PERSON, "FILE", 0, "who walks: a person file (default: the paper's walker)", 0},
    {"device", KEY_DEVICE, "FILE", 0, "with what: a device file (default: the virtual device)", 0},
    {"markdown", KEY_MARKDOWN, 0, 0, "the table as Markdown", 0},
    {"run", KEY_RUN, "I", 0, "run number I alone, and tell", 1},
    {"log", KEY_LOG, "FILE", 0, "with --run: every frame, as candump -L writes it", 1},
    {"csv", KEY_TICKS, "FILE", 0, "with --run: one line per tick (scripts/plot-fault draws it)", 1},
    {0}};

bool fault_options_want(const struct fault_options *options, uint32_t kind)
{
    return options->only == NULL || strstr(fault_kinds[kind].name, options->only) != NULL;
}

/* A text that no fault has would leave an empty table, which looks as if all were well. */
static void check_only(const struct fault_options *options)
{
    const uint32_t kinds = options->people ? (uint32_t)FAULT_ALL_KINDS : (uint32_t)FAULT_KINDS;
    for (uint32_t kind = 0; kind < kinds; kind++) {
        if (fault_options_want(options, kind) && kind < options->runs) {
            return;
        }
    }
    const char *best = nearest_name(options->only, fault_kinds, kinds, sizeof fault_kinds[0]);
    program_complain(
        "--only: no fault of these %u runs has \"%s\" in its name%s%s; there are:", options->runs,
        options->only, best != NULL ? "; nearest: " : "", best != NULL ? best : "");
    for (uint32_t kind = 0; kind < kinds; kind++) {
        fprintf(stderr, "  %s%s\n", fault_kinds[kind].name,
                kind < options->runs ? "" : " (with more --runs)");
    }
    exit(EXIT_USAGE);
}

/* Who walks by reflexes is one of --person's and --device's choice. */
static void take_reflex_person(struct fault_options *options)
{
    options->person =
        options->walker.person_path != NULL ? options->walker.person_path : options->person;
    for (int i = 0; i < 2 && options->walker.device_path != NULL; i++) {
        options->device[i] = options->walker.device_path;
    }
}

static void check_together(struct argp_state *state, struct fault_options *options)
{
    const bool chosen = options->walker.person_path != NULL || options->walker.device_path != NULL;
    if (!options->single && (options->log != NULL || options->ticks != NULL)) {
        argp_error(state, "--log and --csv need --run I");
    }
    if (options->data != NULL && !options->people) {
        argp_error(state, "--data needs --people");
    }
    if (options->people && options->by_reflexes) {
        argp_error(state, "--people and --plant reflex are two campaigns: choose one");
    }
    if (options->people && options->data == NULL) {
        options->data = getenv("AFO_DATA");
    }
    if (options->people && chosen) {
        argp_error(state, "--people walks people of its own: leave out --person and --device");
    }
    if (options->out != NULL && chosen) {
        argp_error(
            state,
            "--out keeps runs of the paper's walker or of this tree's adult: leave out --person and --device");
    }
    if (options->by_reflexes) {
        take_reflex_person(options);
        options->people = true;
    }
    if (!options->single && options->only != NULL) {
        check_only(options);
    }
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    static const char *const plants[] = {"reflex"};
    struct fault_options *options = (struct fault_options *)state->input;
    switch (key) {
    case KEY_RUNS:
        options->runs = (uint32_t)option_whole(state, "--runs", text, 1, FAULT_RUNS_MAX);
        break;
    case KEY_JOBS:
        options->jobs = (uint32_t)option_whole(state, "--jobs", text, 1, FAULT_JOBS_MAX);
        break;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        break;
    case KEY_OUT:
        options->out = text;
        break;
    case KEY_ONLY:
        options->only = text;
        break;
    case KEY_PEOPLE:
        options->people = true;
        break;
    case KEY_PLANT:
        (void)option_choice(state, "--plant", text, plants, 1, sizeof plants[0]);
        options->by_reflexes = true;
        break;
    case KEY_DATA:
        options->data = text;
        break;
    case KEY_PERSON:
        options->walker.person_path = text;
        break;
    case KEY_DEVICE:
        options->walker.device_path = text;
        break;
    case KEY_MARKDOWN:
        options->markdown = true;
        break;
    case KEY_RUN:
        options->run = (uint32_t)option_whole(state, "--run", text, 0, FAULT_RUNS_MAX - 1);
        options->single = true;
        break;
    case KEY_LOG:
        options->log = text;
        break;
    case KEY_TICKS:
        options->ticks = text;
        break;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        break;
    case ARGP_KEY_END:
        check_together(state, options);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

void fault_options_parse(struct fault_options *options, int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        parse_option,
        0,
        "Injects faults into steady walks of the simulated walker and judges by the plant what "
        "came of them.\v"
        "Exit status: 0 nothing unsafe or unnoticed, 1 something, 2 wrong usage.",
        0,
        0,
        0};
    *options = (struct fault_options){
        .runs = 500,
        .jobs = 1,
        .seed = 1,
        .person = "sim_host/persons/adult70.ini",
        .device = {"sim_host/devices/virtual-adult.ini", "sim_host/devices/exo50.ini"},
        .argc = argc,
        .argv = argv};
    option_parse(&parser, argc, argv, options);
}
