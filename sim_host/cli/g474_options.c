#include "sim_host/cli/g474_options.h"

#include "sim_host/cli/option.h"

enum {
    KEY_CORE = 0x200,
    KEY_SECONDS,
    KEY_FAULT,
    KEY_FAULT_STEP,
    KEY_CUT,
    KEY_EVERY,
    KEY_ALIKE,
    KEY_LOSE,
    KEY_LOG,
    KEY_COSTS,
    KEY_BOARD,
    KEY_TRACE,
    KEY_PROFILE,
    KEY_RECORDING,
    KEY_GDB
};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The run:", 3},
    {"core", KEY_CORE, "FILE", 0, "the Unicorn engine's shared library (that in build/venv)", 0},
    {"seconds", KEY_SECONDS, "T", 0, "walk at least this long (0)", 0},
    {"recording", KEY_RECORDING, "FILE.csv", 0,
     "recorded walking in the walker's place, to its end", 0},
    {"fault", KEY_FAULT, "NAME", 0,
     "emergency-stop, lost-sensor, lost-drive, drive-hangs, destroyed-frames, hang, crystal-stops, no-crystal, "
     "torn-settings, ecc-error, save-cut, load-cut, lost-write, half-written, "
     "damaged-program, stuck-ram, first-start, options-cut, supply-low, brown-out, ram-slice, "
     "ram-parity, core-register, float-register, slow-oscillator, fast-oscillator, deep-stack, "
     "flash-corrected, early-feed, run-ram, write-program, first-store, dirty-ram, mark, update, update-older, update-other-board, update-walking or update-cut",
     0},
    {"fault-step", KEY_FAULT_STEP, "N", 0, "the fault comes after N steps (5)", 0},
    {"cut", KEY_CUT, "N", 0, "save-cut, load-cut: power fails in flash operation N, from 0 (0)", 0},
    {"every", KEY_EVERY, "N", 0, "likewise: in each N-th operation, one after the other", 0},
    {"alike", KEY_ALIKE, 0, 0,
     "with --every: each start that reads the same flash as one before is not run again", 0},
    {"lose", KEY_LOSE, "ADDRESS", 0, "lost-write: of this register, decimal (TIM2's prescaler)", 0},
    {"log", KEY_LOG, "FILE", 0, "every frame, as candump -L writes it", 4},
    {"trace", KEY_TRACE, "FILE", 0, "what a debugger records of an image built with TRACE=swo", 4},
    {"gdb", KEY_GDB, "PORT", 0,
     "wait at 127.0.0.1:PORT until gdb attaches (target remote); 0: a free port", 4},
    {"board", KEY_BOARD, 0, 0, "then ask the image what `afo ctl board' asks a board", 4},
    {"costs", KEY_COSTS, "FILE", 0, "instructions of every tick", 4},
    {"profile", KEY_PROFILE, "FILE", 0,
     "instructions of the worst tick by place; scripts/tick-profile names the functions", 4},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct g474_options *options = state->input;

    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->emulator;
        state->child_inputs[2] = &options->sensing;
        state->child_inputs[3] = &options->sensor;
        return 0;
    case KEY_CORE:
        options->core = text;
        return 0;
    case KEY_SECONDS:
        options->seconds = (double)option_whole(state, "--seconds", text, 0, 100000);
        return 0;
    case KEY_FAULT:
        options->fault = (enum chip_fault)option_choice(state, "--fault", text, chip_faults,
                                                        CHIP_FAULT_COUNT, sizeof chip_faults[0]);
        return 0;
    case KEY_FAULT_STEP:
        options->fault_step = (uint32_t)option_whole(state, "--fault-step", text, 0, 100000);
        return 0;
    case KEY_CUT:
        options->cut = (uint32_t)option_whole(state, "--cut", text, 0, 100000);
        return 0;
    case KEY_EVERY:
        options->every = (uint32_t)option_whole(state, "--every", text, 1, 100000);
        return 0;
    case KEY_ALIKE:
        options->alike = true;
        return 0;
    case KEY_LOSE:
        options->lose = (uint32_t)option_whole(state, "--lose", text, 0, UINT32_MAX);
        return 0;
    case KEY_LOG:
        options->log_path = text;
        return 0;
    case KEY_PROFILE:
        options->profile_path = text;
        return 0;
    case KEY_RECORDING:
        options->recording_path = text;
        return 0;
    case KEY_TRACE:
        options->trace_path = text;
        return 0;
    case KEY_GDB:
        options->gdb = true;
        options->gdb_port = (unsigned)option_whole(state, "--gdb", text, 0, 65535);
        return 0;
    case KEY_BOARD:
        options->board = true;
        return 0;
    case KEY_COSTS:
        options->costs_path = text;
        return 0;
    case ARGP_KEY_END:
        if (options->gdb && options->every > 0) {
            argp_error(state,
                       "--gdb and --every: copies of the run cannot share a debugger; use --cut");
        }
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
    "Walks with the very image that is flashed, in an emulated STM32G474, and compares every "
    "frame it sends with the host's build.\vExit status: 0 walked (or reached the safe state after "
    "--fault), no frame differed and the image misused no peripheral, 1 not, 2 usage.",
    children,
    NULL,
    NULL};

void g474_options_parse(struct g474_options *options, int argc, char **argv)
{
    *options = (struct g474_options){.fault_step = 5, .lose = 0x40000028u};
    walk_options_init(&options->walk);
    emulator_options_init(&options->emulator, 200, 100000);
    options->emulator.image = "build/arm/afo-nucleo-g474re.bin";
    sensing_options_init(&options->sensing);
    sensor_options_init(&options->sensor);
    option_parse(&parser, argc, argv, options);
}
