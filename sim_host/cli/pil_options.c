#include "sim_host/cli/pil_options.h"

enum { KEY_RECORDING = 0x200, KEY_FAULT, KEY_FAULT_STEP, KEY_LOG, KEY_COSTS, KEY_BLACK_BOX };

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The run:", 3},
    {"recording", KEY_RECORDING, "FILE.csv", 0,
     "recorded walking in the walker's place, to its end", 0},
    {"fault", KEY_FAULT, "NAME", 0,
     "emergency-stop, lost-sensor, lost-drive, hang, stalled-supervisor, hard-fault, "
     "execute-ram, write-program, "
     "stack-overflow, assertion or bad-parameters",
     0},
    {"fault-step", KEY_FAULT_STEP, "N", 0, "the fault comes after N steps (5)", 0},
    {"log", KEY_LOG, "FILE", 0, "every frame, as candump -L writes it", 4},
    {"costs", KEY_COSTS, "FILE", 0, "instructions of every tick", 4},
    {"black-box", KEY_BLACK_BOX, "FILE", 0,
     "fetch the image's black box over SDO at the end, as a log for afo replay", 4},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct pil_options *options = state->input;

    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->emulator;
        state->child_inputs[2] = &options->sensing;
        state->child_inputs[3] = &options->sensor;
        return 0;
    case KEY_RECORDING:
        options->recording_path = text;
        return 0;
    case KEY_FAULT:
        options->fault = (enum pil_fault)option_choice(state, "--fault", text, pil_faults,
                                                       PIL_FAULT_COUNT, sizeof pil_faults[0]);
        return 0;
    case KEY_FAULT_STEP:
        options->fault_step = (uint32_t)option_whole(state, "--fault-step", text, 0, 100000);
        return 0;
    case KEY_LOG:
        options->log_path = text;
        return 0;
    case KEY_COSTS:
        options->costs_path = text;
        return 0;
    case KEY_BLACK_BOX:
        options->black_box_path = text;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&walk_options_parser, 0, "", 1},
                                             {&emulator_options_parser, 0, "", 2},
                                             {&sensing_options_parser, 0, 0, 3},
                                             {&sensor_options_parser, 0, "", 5},
                                             {0}};
static const struct argp parser = {
    option_list,
    take,
    NULL,
    "Walks with the flashed object code on an emulated Cortex-M4F and compares every frame it "
    "sends with the host's build.\vExit status: 0 walked (or reached the safe state after --fault) "
    "and no frame differed, 1 not, 2 usage.",
    children,
    NULL,
    NULL};

void pil_options_parse(struct pil_options *options, int argc, char **argv)
{
    *options = (struct pil_options){.fault_step = 5};
    walk_options_init(&options->walk);
    emulator_options_init(&options->emulator, 200, 100000);
    sensing_options_init(&options->sensing);
    sensor_options_init(&options->sensor);
    option_parse(&parser, argc, argv, options);
}
