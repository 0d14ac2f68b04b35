#include "sim_host/cli/walker_options.h"

enum { KEY_SILENCE = 0x100, KEY_STAND };

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The walker:", 3},
    {"silence", KEY_SILENCE, "MS", 0,
     "go on by the clock after so long without SYNC (default 1500: a host in lock-step waits 1000 "
     "for a lost frame; 20 suits real time)",
     0},
    {"stand", KEY_STAND, 0, 0, "keep it in a stand, for afo commission: it does not walk", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct walker_options *options = (struct walker_options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->bus;
        state->child_inputs[2] = &options->sensing;
        return 0;
    case KEY_SILENCE:
        options->silence_ms = option_whole(state, "--silence", text, 2, 60000);
        return 0;
    case KEY_STAND:
        options->in_stand = true;
        return 0;
    case ARGP_KEY_END:
        if (options->bus.steps > WALKER_APEXES_MAX) {
            argp_error(state, "--steps: the walker remembers %d at most", WALKER_APEXES_MAX);
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

void walker_options_parse(struct walker_options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 1},
                                                 {&bus_options_parser, 0, "", 2},
                                                 {&sensing_options_parser, 0, 0, 3},
                                                 {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "The simulated walker with its two SEA drives and two leg sensors as CANopen nodes "
        "1 to 4 on a CAN interface.\v"
        "Exit status: 0 ended without a fall, 1 fell, 2 wrong usage or no such interface.",
        children,
        0,
        0};
    *options = (struct walker_options){.silence_ms = 1500};
    walk_options_init(&options->walk);
    sensing_options_init(&options->sensing);
    option_parse(&parser, argc, argv, options);
}
