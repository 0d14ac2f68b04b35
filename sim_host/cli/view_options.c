#include "sim_host/cli/view_options.h"

#include <string.h>

enum {
    KEY_REPLAY = 0x700,
    KEY_CONTROL,
    KEY_PORT,
    KEY_LISTEN,
    KEY_NAMES,
    KEY_TRIALS,
    KEY_STEPS,
    KEY_LOG,
    KEY_FAULT,
    KEY_FAULT_STEP,
    KEY_ENGAGE,
    KEY_STAND
};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "What is seen (default: the walker in this process):", 2},
    {"can", 'c', "INTERFACE", 0, "a bus, such as can0: host, board or others on it", 0},
    {"replay", KEY_REPLAY, "FILE", 0, "a candump log, or the folder of a trial, with a time slider",
     0},
    {0, 0, 0, 0, "The page:", 3},
    {"control", KEY_CONTROL, 0, 0,
     "the page may change settings, walk, stop and reset (default: it only reads)", 0},
    {"port", KEY_PORT, "N", 0, "TCP port (default 8021; 0: any free one)", 0},
    {"listen", KEY_LISTEN, "ADDRESS", 0,
     "listen there instead of 127.0.0.1: anybody in that network can try the token", 0},
    {"names", KEY_NAMES, "NAME,..", 0,
     "further host names or addresses by which browsers may call the page", 0},
    {"trials", KEY_TRIALS, "FOLDER", 0, "where trials are kept (default trials)", 0},
    {0, 0, 0, 0, "The walk in this process:", 4},
    {"stand", KEY_STAND, 0, 0,
     "keep it in a stand, for the steps of commissioning: it does not walk", 0},
    {"steps", KEY_STEPS, "N", 0, "end after N steps (default: at Ctrl-C)", 0},
    {"log", KEY_LOG, "FILE", 0, "every frame, as candump -L writes it", 0},
    {"fault", KEY_FAULT, "NAME", 0, "none, cut-drives, never-armed or swapped", 0},
    {"fault-step", KEY_FAULT_STEP, "N", 0, "the fault begins after N steps (default 10)", 0},
    {"engage", KEY_ENGAGE, "STEPS", 0,
     "the walker has a push-off of its own; the device takes over after so many steady steps", 0},
    {0}};

static void check_together(struct argp_state *state, const struct view_options *options)
{
    const bool recorded = recording_options_person(&options->sim.recording);
    if ((options->interface != NULL) + (options->replay_path != NULL) + recorded > 1) {
        argp_error(state, "--can, --replay and --recording exclude each other");
    }
    if (options->replay_path != NULL && options->control) {
        argp_error(state, "--control: nothing can be changed in a log");
    }
    if (recorded && walk_options_speed_given(&options->sim.walk)) {
        argp_error(state,
                   "--speed and --recording exclude each other: a person chooses their speed");
    }
    if (options->sim.recording.path != NULL && ground_options_given(&options->sim.ground)) {
        argp_error(state,
                   "--slope-deg, --terrain-mm and --push act on a body that answers; the person "
                   "of --recording walks as they did");
    }
    if (options->in_stand &&
        (options->interface != NULL || options->replay_path != NULL || recorded)) {
        argp_error(state, "--stand is for the walker in this process");
    }
    if ((options->interface != NULL || options->replay_path != NULL) &&
        options->sim.log_path != NULL) {
        argp_error(state, "--log is for the walk in this process");
    }
}

static enum loop_fault fault_of(struct argp_state *state, const char *name)
{
    const char *names[LOOP_FAULT_COUNT];
    for (int i = 0; i < LOOP_FAULT_COUNT; i++) {
        names[i] = loop_fault_name((enum loop_fault)i);
    }
    return (enum loop_fault)option_choice(state, "--fault", name, names, LOOP_FAULT_COUNT,
                                          sizeof names[0]);
}

static bool take_page(int key, char *text, struct argp_state *state)
{
    struct view_options *options = (struct view_options *)state->input;
    switch (key) {
    case KEY_CONTROL:
        options->control = true;
        return true;
    case KEY_PORT:
        options->port = (unsigned)option_whole(state, "--port", text, 0, UINT16_MAX);
        return true;
    case KEY_LISTEN:
        options->listen = text;
        return true;
    case KEY_NAMES:
        options->host_names = text;
        return true;
    case KEY_TRIALS:
        options->trials_path = text;
        return true;
    case KEY_STAND:
        options->in_stand = true;
        return true;
    default:
        return false;
    }
}

static bool take_walk(int key, char *text, struct argp_state *state)
{
    struct sim_options *sim = &((struct view_options *)state->input)->sim;
    switch (key) {
    case KEY_STEPS:
        sim->steps = (uint32_t)option_whole(state, "--steps", text, 1, 10000000);
        return true;
    case KEY_LOG:
        sim->log_path = text;
        return true;
    case KEY_FAULT:
        sim->fault = fault_of(state, text);
        return true;
    case KEY_FAULT_STEP:
        sim->fault_step = (uint32_t)option_whole(state, "--fault-step", text, 0, 10000000);
        return true;
    case KEY_ENGAGE:
        sim->engage_steps = (uint32_t)option_whole(state, "--engage", text, 1, 50);
        return true;
    default:
        return false;
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct view_options *options = (struct view_options *)state->input;
    if (take_page(key, text, state) || take_walk(key, text, state)) {
        return 0;
    }
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->sim.walk;
        state->child_inputs[1] = &options->sim.sensor;
        state->child_inputs[2] = &options->sim.ground;
        state->child_inputs[3] = &options->sim.sensing;
        state->child_inputs[4] = &options->sim.recording;
        return 0;
    case 'c':
        options->interface = text;
        return 0;
    case KEY_REPLAY:
        options->replay_path = text;
        return 0;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        return 0;
    case ARGP_KEY_END:
        options->sim.walk.person = recording_options_person(&options->sim.recording);
        check_together(state, options);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

void view_options_parse(struct view_options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {
        {&walk_options_parser, 0, "", 1},     {&sensor_options_parser, 0, "", 5},
        {&ground_options_parser, 0, "", 6},   {&sensing_options_parser, 0, 0, 4},
        {&recording_options_parser, 0, 0, 4}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Shows a walk in a browser, while it goes on or from a log: figure, signals, state, faults. "
        "With --control the page also changes settings.\v"
        "The address that is printed has a token; who knows it may see, and with --control change. "
        "scripts/setup view installs the Python packages that the page's server needs.\n"
        "Exit status: 0 ended by Ctrl-C or --steps, 2 wrong usage or input.",
        children,
        0,
        0};
    *options = (struct view_options){.port = 8021, .listen = "127.0.0.1", .trials_path = "trials"};
    options->sim.fault_step = 10;
    options->sim.real_time = options->sim.quiet = true;
    options->sim.steps = UINT32_MAX;
    options->sim.argc = argc;
    options->sim.argv = argv;
    walk_options_init(&options->sim.walk);
    sensor_options_init(&options->sim.sensor);
    sensing_options_init(&options->sim.sensing);
    recording_options_init(&options->sim.recording);
    option_parse(&parser, argc, argv, options);
}
