#include "sim_host/cli/sim_options.h"

#include <argp.h>
#include <string.h>

#include "sim_host/cli/recording_options.h"

enum {
    KEY_STEPS = 0x100,
    KEY_CSV,
    KEY_PUSHES,
    KEY_TICKS,
    KEY_LOG,
    KEY_FAULT,
    KEY_FAULT_STEP,
    KEY_FAULT_MS,
    KEY_RELEASE_LATE,
    KEY_REAL_TIME,
    KEY_ENGAGE
};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The walk:", 2},
    {"steps", KEY_STEPS, "N", 0, "walk this many steps (default 200; a recording: all)", 0},
    {"fault", KEY_FAULT, "NAME", 0, "none, cut-drives, never-armed, swapped or crossed", 0},
    {"fault-step", KEY_FAULT_STEP, "N", 0, "the fault begins after N steps (default 10)", 0},
    {"fault-ms", KEY_FAULT_MS, "MS", 0,
     "and MS milliseconds later, so at any phase of the step (default 0)", 0},
    {"release-late-ms", KEY_RELEASE_LATE, "MS", 0,
     "both latches open so late, 0 to 49 ms; the device does not know it. They open no earlier: they wait for the "
     "other foot",
     0},
    {"engage", KEY_ENGAGE, "STEPS", 0,
     "the walker has a push-off of its own; the device takes over after so many steady steps "
     "(a recorded person's has: 4)",
     0},
    {"real-time", KEY_REAL_TIME, 0, 0, "one tick a millisecond, with a report of the jitter", 0},
    {0, 0, 0, 0, "What comes out:", 3},
    {"csv", KEY_CSV, "FILE", 0, "one line per step; FILE.json says what the experiment was", 0},
    {"pushes", KEY_PUSHES, "FILE", 0, "one line per leg: torque, work, timing, motor, as CSV", 0},
    {"ticks", KEY_TICKS, "FILE", OPTION_ARG_OPTIONAL,
     "one line per tick there; without FILE, in --csv in place of the steps", 0},
    {"log", KEY_LOG, "FILE", 0, "every frame, as candump -L writes it", 0},
    {"json", 'j', 0, 0, "one JSON object on standard output instead of the report", 0},
    {"quiet", 'q', 0, 0, "no report and no progress line", 0},
    {0}};

static enum loop_fault fault_of(struct argp_state *state, const char *name)
{
    const char *names[LOOP_FAULT_COUNT];
    for (int i = 0; i < LOOP_FAULT_COUNT; i++) {
        names[i] = loop_fault_name((enum loop_fault)i);
    }
    return (enum loop_fault)option_choice(state, "--fault", name, names, LOOP_FAULT_COUNT,
                                          sizeof names[0]);
}

static const double RELEASE_LATE_MAX_MS = 49.0; /* 50 ms, with what a latch takes itself */

enum { DEFAULT_STEPS = 200, DEFAULT_FAULT_STEP = 10 };

/* An option that would do nothing is a mistake of the caller's, not a wish. */
static void check_used(struct argp_state *state, const struct sim_options *options)
{
    if (options->recording.path != NULL && ground_options_given(&options->ground)) {
        argp_error(state,
                   "--slope-deg, --terrain-mm and --push act on a body that answers; the person "
                   "of --recording walks as they did: use --plant reflex or the walker");
    }
    if (recording_options_person(&options->recording) && options->walk.law_given &&
        options->walk.law != LAW_PERSON) {
        argp_error(
            state,
            "--law is the walker's, and --recording or --plant reflex a person, whose law is \"person\"");
    }
    if (options->fault == LOOP_FAULT_NONE && options->fault_step != UINT32_MAX) {
        argp_error(state, "--fault-step needs --fault NAME");
    }
    if (options->fault == LOOP_FAULT_NONE && options->fault_delay_ms > 0) {
        argp_error(state, "--fault-ms needs --fault NAME");
    }
}

static void check_together(struct argp_state *state, struct sim_options *options)
{
    options->walk.person = recording_options_person(&options->recording);
    if (recording_options_person(&options->recording) && walk_options_speed_given(&options->walk)) {
        argp_error(
            state,
            "--speed is the walker's: the person of --recording or --plant reflex chooses their own");
    }
    if (options->ticks && options->csv_path == NULL) {
        argp_error(state, "--ticks needs --csv FILE, or a file of its own: --ticks=FILE");
    }
    if (options->csv_path != NULL && options->ticks_path != NULL &&
        strcmp(options->csv_path, options->ticks_path) == 0) {
        argp_error(state, "--csv and --ticks name the same file, %s", options->csv_path);
    }
    if (options->csv_path != NULL && options->log_path != NULL &&
        strcmp(options->csv_path, options->log_path) == 0) {
        argp_error(state, "--csv and --log name the same file, %s", options->csv_path);
    }
    check_used(state, options);
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct sim_options *options = (struct sim_options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->sensor;
        state->child_inputs[2] = &options->ground;
        state->child_inputs[3] = &options->sensing;
        state->child_inputs[4] = &options->recording;
        break;
    case KEY_STEPS:
        options->steps = (uint32_t)option_whole(state, "--steps", text, 1, 10000000);
        break;
    case KEY_CSV:
        options->csv_path = text;
        break;
    case KEY_PUSHES:
        options->pushes_path = text;
        break;
    case KEY_TICKS:
        options->ticks = text == NULL;
        options->ticks_path = text;
        break;
    case KEY_LOG:
        options->log_path = text;
        break;
    case KEY_FAULT:
        options->fault = fault_of(state, text);
        break;
    case KEY_FAULT_STEP:
        options->fault_step = (uint32_t)option_whole(state, "--fault-step", text, 0, 10000000);
        break;
    case KEY_FAULT_MS:
        options->fault_delay_ms = (uint32_t)option_whole(state, "--fault-ms", text, 0, 10000);
        break;
    case KEY_RELEASE_LATE:
        options->release_late_s =
            0.001 * option_number(state, "--release-late-ms", text, 0.0, RELEASE_LATE_MAX_MS);
        break;
    case KEY_ENGAGE:
        options->engage_steps = (uint32_t)option_whole(state, "--engage", text, 1, 50);
        break;
    case KEY_REAL_TIME:
        options->real_time = true;
        break;
    case 'q':
        options->quiet = true;
        break;
    case 'j':
        options->json = true;
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

void sim_options_parse(struct sim_options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {
        {&walk_options_parser, 0, "", 1},     {&sensor_options_parser, 0, "", 3},
        {&ground_options_parser, 0, "", 4},   {&sensing_options_parser, 0, 0, 2},
        {&recording_options_parser, 0, 0, 2}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Walks the simulated walker in closed loop over an in-process CAN bus.\v"
        "Exit status: 0 walked, 1 fell or stopped by a fault, 2 wrong usage or input.",
        children,
        0,
        0};
    *options = (struct sim_options){.fault_step = UINT32_MAX, .argc = argc, .argv = argv};
    walk_options_init(&options->walk);
    sensor_options_init(&options->sensor);
    sensing_options_init(&options->sensing);
    recording_options_init(&options->recording);
    option_parse(&parser, argc, argv, options);
    if (options->steps == 0) {
        options->steps = options->recording.path != NULL ? UINT32_MAX : DEFAULT_STEPS;
    }
    if (options->fault_step == UINT32_MAX) {
        options->fault_step = DEFAULT_FAULT_STEP;
    }
}
