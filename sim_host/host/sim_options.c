#include "sim_host/host/sim_options.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/version.h"

enum {
    KEY_SPEED = 0x100,
    KEY_STEPS,
    KEY_OPEN_LOOP,
    KEY_R0,
    KEY_START_R0,
    KEY_KP,
    KEY_SENSORS,
    KEY_SUBJECT,
    KEY_SEED,
    KEY_CSV,
    KEY_TICKS,
    KEY_LOG,
    KEY_WEARER,
    KEY_FAULT,
    KEY_FAULT_STEP,
    KEY_REAL_TIME
};

static const char *const fault_names[LOOP_FAULT_COUNT] = {"none", "cut-drives", "never-armed",
                                                          "swapped"};

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The walk:", 1},
    {"speed", KEY_SPEED, "RAD_S", 0, "forward apex speed to walk at (default: that of the start gait)", 0},
    {"steps", KEY_STEPS, "N", 0, "walk this many steps (default 200)", 0},
    {"kp", KEY_KP, "GAIN", 0, "gain of the law in m per rad/s (default: 0.042 scaled to the subject)", 0},
    {"open-loop", KEY_OPEN_LOOP, 0, 0, "no law: constant precompression --r0, reached by a slow ramp", 0},
    {"r0", KEY_R0, "M", 0, "precompression of --open-loop, metres", 0},
    {"start-r0", KEY_START_R0, "M", 0, "start from the steady gait of this precompression, metres", 0},
    {0, 0, 0, 0, "Who walks, and with what:", 2},
    {"subject", KEY_SUBJECT, "FILE", 0, "subject file (INI; default: the paper's walker)", 0},
    {"sensors", KEY_SENSORS, "PRESET", 0, "ideal, 17bit (default), 14bit or 12bit", 0},
    {"wearer", KEY_WEARER, "FILE.csv", 0, "recorded walking in the walker's place", 0},
    {"seed", KEY_SEED, "N", 0, "seed of all noise (default 1)", 0},
    {"fault", KEY_FAULT, "NAME", 0, "none, cut-drives, never-armed or swapped", 0},
    {"fault-step", KEY_FAULT_STEP, "N", 0, "the fault begins after N steps (default 10)", 0},
    {"real-time", KEY_REAL_TIME, 0, 0, "one tick a millisecond, with a report of the jitter", 0},
    {0, 0, 0, 0, "What comes out:", 3},
    {"csv", KEY_CSV, "FILE", 0, "one line per step", 0},
    {"ticks", KEY_TICKS, 0, 0, "one line per tick in --csv instead", 0},
    {"log", KEY_LOG, "FILE", 0, "every frame, as candump -L writes it", 0},
    {"json", 'j', 0, 0, "one JSON object on standard output instead of the report", 0},
    {"quiet", 'q', 0, 0, "no report and no progress line", 0},
    {0}};

static double number(struct argp_state *state, const char *option, const char *text, double low,
                     double high)
{
    char *end = NULL;
    errno = 0;
    const double value = strtod(text, &end);
    if (end == text || *end != '\0' || errno == ERANGE || !isfinite(value)) {
        argp_error(state, "%s: \"%s\" is not a number", option, text);
    }
    if (value < low || value > high) {
        argp_error(state, "%s: %s is out of range, allowed is %g to %g", option, text, low, high);
    }
    return value;
}

static uint64_t whole(struct argp_state *state, const char *option, const char *text, uint64_t low,
                      uint64_t high)
{
    char *end = NULL;
    errno = 0;
    const unsigned long long value = strtoull(text, &end, 10);
    if (end == text || *end != '\0' || errno == ERANGE || text[0] == '-' || value < low ||
        value > high) {
        argp_error(state, "%s: \"%s\" is not a whole number from %llu to %llu", option, text,
                   (unsigned long long)low, (unsigned long long)high);
    }
    return value;
}

static void take_fault(struct argp_state *state, struct sim_options *options, const char *name)
{
    for (int i = 0; i < LOOP_FAULT_COUNT; i++) {
        if (strcmp(name, fault_names[i]) == 0) {
            options->fault = (enum loop_fault)i;
            return;
        }
    }
    argp_error(state, "--fault: \"%s\" is unknown, allowed is none, cut-drives, never-armed, swapped",
               name);
}

static void check_together(struct argp_state *state, const struct sim_options *options)
{
    if (options->open_loop && options->r0_m <= 0.0) {
        argp_error(state, "--open-loop needs --r0 M");
    }
    if (options->r0_m > 0.0 && !options->open_loop) {
        argp_error(state, "--r0 is the constant of --open-loop; with the law use --speed");
    }
    if (options->open_loop && options->speed_rad_s > 0.0) {
        argp_error(state, "--speed and --open-loop exclude each other");
    }
    if (options->open_loop && options->kp >= 0.0) {
        argp_error(state, "--kp and --open-loop exclude each other");
    }
    if (options->ticks && options->csv_path == NULL) {
        argp_error(state, "--ticks needs --csv FILE");
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct sim_options *options = (struct sim_options *)state->input;
    switch (key) {
    case KEY_SPEED:
        options->speed_rad_s = number(state, "--speed", text, 1e-3, 20.0);
        break;
    case KEY_STEPS:
        options->steps = (uint32_t)whole(state, "--steps", text, 1, 10000000);
        break;
    case KEY_OPEN_LOOP:
        options->open_loop = true;
        break;
    case KEY_R0:
        options->r0_m = number(state, "--r0", text, 1e-4, 0.6);
        break;
    case KEY_START_R0:
        options->start_r0_m = number(state, "--start-r0", text, 1e-4, 0.6);
        break;
    case KEY_KP:
        options->kp = number(state, "--kp", text, 0.0, 1.0);
        break;
    case KEY_SENSORS:
        if (!sensor_preset_from_name(text, &options->sensors)) {
            argp_error(state, "--sensors: \"%s\" is unknown, allowed is ideal, 17bit, 14bit, 12bit",
                       text);
        }
        options->sensors_name = text;
        break;
    case KEY_SUBJECT:
        options->subject_path = text;
        break;
    case KEY_SEED:
        options->seed = whole(state, "--seed", text, 0, UINT64_MAX);
        break;
    case KEY_CSV:
        options->csv_path = text;
        break;
    case KEY_TICKS:
        options->ticks = true;
        break;
    case KEY_LOG:
        options->log_path = text;
        break;
    case KEY_WEARER:
        options->wearer_path = text;
        break;
    case KEY_FAULT:
        take_fault(state, options, text);
        break;
    case KEY_FAULT_STEP:
        options->fault_step = (uint32_t)whole(state, "--fault-step", text, 0, 10000000);
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
        argp_error(state, "unexpected argument \"%s\"", text);
        break;
    case ARGP_KEY_END:
        check_together(state, options);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void print_version(FILE *stream, struct argp_state *state)
{
    (void)state;
    fprintf(stream, "afo-sim %s (build %08x)\n", version_text(), (unsigned)version_build_id());
}

void sim_options_parse(struct sim_options *options, int argc, char **argv)
{
    static const struct argp parser = {
        option_list, take, 0,
        "Walks the simulated walker in closed loop over an in-process CAN bus.\v"
        "Exit status: 0 walked, 1 fell or stopped by a fault, 2 wrong usage or input.",
        0, 0, 0};
    *options = (struct sim_options){.steps = 200,
                                    .kp = -1.0,
                                    .sensors = SENSORS_17BIT,
                                    .sensors_name = "17bit",
                                    .seed = 1,
                                    .fault_step = 10};
    argp_err_exit_status = 2;
    argp_program_version_hook = print_version;
    if (argp_parse(&parser, argc, argv, 0, NULL, options) != 0) {
        exit(2);
    }
}
