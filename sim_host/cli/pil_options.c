#include "sim_host/cli/pil_options.h"

#include <argp.h>
#include <string.h>

#include "sim_host/emulator/pil_bridge.h"

const struct pil_fault_kind pil_faults[PIL_FAULT_COUNT] = {
    [PIL_FAULT_NONE] = {"none", 0, SUPERVISOR_FAULT_NONE, CRASH_NONE},
    [PIL_FAULT_EMERGENCY_STOP] = {"emergency-stop", PIL_EMERGENCY_STOP,
                                  SUPERVISOR_FAULT_EMERGENCY_STOP, CRASH_NONE},
    [PIL_FAULT_LOST_SENSOR] = {"lost-sensor", 0, SUPERVISOR_FAULT_SENSOR_STALE, CRASH_NONE},
    [PIL_FAULT_LOST_DRIVE] = {"lost-drive", 0, SUPERVISOR_FAULT_DRIVE_STALE, CRASH_NONE},
    [PIL_FAULT_HANG] = {"hang", PIL_DO_HANG, SUPERVISOR_FAULT_RESTARTED, CRASH_WATCHDOG},
    [PIL_FAULT_SUPERVISOR] = {"stalled-supervisor", PIL_DO_STALL_SUPERVISOR,
                              SUPERVISOR_FAULT_RESTARTED, CRASH_WATCHDOG},
    [PIL_FAULT_HARD_FAULT] = {"hard-fault", PIL_DO_HARD_FAULT, SUPERVISOR_FAULT_RESTARTED,
                              CRASH_BUS_FAULT},
    [PIL_FAULT_STACK] = {"stack-overflow", PIL_DO_OVERFLOW_STACK, SUPERVISOR_FAULT_RESTARTED,
                         CRASH_MEMORY_FAULT},
    [PIL_FAULT_ASSERTION] = {"assertion", PIL_DO_ASSERT, SUPERVISOR_FAULT_RESTARTED,
                             CRASH_ASSERTION},
    [PIL_FAULT_PARAMETERS] = {"bad-parameters", 0, SUPERVISOR_FAULT_PARAMETERS, CRASH_NONE},
};

enum {
    KEY_IMAGE = 0x200,
    KEY_STEPS,
    KEY_SENSORS,
    KEY_RECORDING,
    KEY_SEED,
    KEY_FAULT,
    KEY_FAULT_STEP,
    KEY_CORRUPT,
    KEY_LOG,
    KEY_COSTS,
    KEY_BLACK_BOX
};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The run:", 2},
    {"image", KEY_IMAGE, "ELF", 0, "what the emulator runs (build/arm/afo-mps2-an386.elf)", 0},
    {"steps", KEY_STEPS, "N", 0, "walk this many steps (200)", 0},
    {"sensors", KEY_SENSORS, "PRESET", 0, "ideal, 17bit (default), 14bit or 12bit", 0},
    {"recording", KEY_RECORDING, "FILE.csv", 0,
     "recorded walking in the walker's place, to its end", 0},
    {"seed", KEY_SEED, "N", 0, "seed of all noise (1)", 0},
    {"fault", KEY_FAULT, "NAME", 0,
     "emergency-stop, lost-sensor, lost-drive, hang, stalled-supervisor, hard-fault, "
     "stack-overflow, assertion or bad-parameters",
     0},
    {"fault-step", KEY_FAULT_STEP, "N", 0, "the fault comes after N steps (5)", 0},
    {"corrupt", KEY_CORRUPT, "N", 0, "flip a bit of the image's N-th frame: must be noticed", 0},
    {0, 0, 0, 0, "What comes out:", 3},
    {"log", KEY_LOG, "FILE", 0, "every frame, as candump -L writes it", 0},
    {"costs", KEY_COSTS, "FILE", 0, "instructions of every tick", 0},
    {"black-box", KEY_BLACK_BOX, "FILE", 0,
     "fetch the image's black box over SDO at the end, as a log for afo-replay", 0},
    {"json", 'j', 0, 0, "one JSON object on standard output", 0},
    {"quiet", 'q', 0, 0, "no report", 0},
    {0}};

static void take_fault(struct pil_options *options, const char *name, struct argp_state *state)
{
    for (int i = 0; i < PIL_FAULT_COUNT; i++) {
        if (strcmp(name, pil_faults[i].name) == 0) {
            options->fault = (enum pil_fault)i;
            return;
        }
    }
    argp_error(state, "--fault: \"%s\" is unknown", name);
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct pil_options *options = state->input;

    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->sensor;
        return 0;
    case KEY_RECORDING:
        options->recording_path = text;
        return 0;
    case KEY_IMAGE:
        options->image = text;
        return 0;
    case KEY_STEPS:
        options->steps = (uint32_t)option_whole(state, "--steps", text, 1, 100000);
        return 0;
    case KEY_SENSORS:
        if (!sensor_preset_from_name(text, &options->sensors)) {
            argp_error(state, "--sensors: \"%s\" is unknown", text);
        }
        return 0;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        return 0;
    case KEY_FAULT:
        take_fault(options, text, state);
        return 0;
    case KEY_FAULT_STEP:
        options->fault_step = (uint32_t)option_whole(state, "--fault-step", text, 0, 100000);
        return 0;
    case KEY_CORRUPT:
        options->corrupt_frame = option_whole(state, "--corrupt", text, 1, UINT64_MAX);
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
    case 'j':
        options->json = true;
        return 0;
    case 'q':
        options->quiet = true;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "unexpected argument \"%s\"", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {
    {&walk_options_parser, 0, "", 1}, {&sensor_options_parser, 0, "", 3}, {0}};
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

int pil_options_parse(struct pil_options *options, int argc, char **argv)
{
    *options = (struct pil_options){.image = "build/arm/afo-mps2-an386.elf",
                                    .steps = 200,
                                    .sensors = SENSORS_17BIT,
                                    .seed = 1,
                                    .fault_step = 5};
    option_identity("afo-pil");
    walk_options_init(&options->walk);
    sensor_options_init(&options->sensor);
    return argp_parse(&parser, argc, argv, 0, NULL, options) == 0 ? 0 : -1;
}
