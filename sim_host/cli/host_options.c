#include "sim_host/cli/host_options.h"

enum { KEY_AUTO_RESET = 0x100, KEY_ANSWER_TIMEOUT, KEY_STANDBY };

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "Time:", 3},
    {"real-time", 'r', 0, 0,
     "SYNC every millisecond by the clock (default: lock-step, as fast as the nodes answer)", 0},
    {"answer-timeout", KEY_ANSWER_TIMEOUT, "MS", 0,
     "lock-step: an answer that takes longer is lost, and the walk goes on without it "
     "(default 1000)",
     0},
    {"auto-reset", KEY_AUTO_RESET, 0, 0,
     "clear a latched fault once all nodes are back and still, and walk again (on a bench only: "
     "never with a person in it)",
     0},
    {"standby", KEY_STANDBY, 0, 0,
     "ask for no walk at the start: afo ctl walk does, or afo commission moves", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct host_options *options = (struct host_options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->bus;
        break;
    case 'r':
        options->real_time = true;
        break;
    case KEY_ANSWER_TIMEOUT:
        options->answer_timeout_ns =
            option_whole(state, "--answer-timeout", text, 1, 600000) * 1000000u;
        break;
    case KEY_STANDBY:
        options->standby = true;
        break;
    case KEY_AUTO_RESET:
        options->auto_reset = true;
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

void host_options_parse(struct host_options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {
        {&walk_options_parser, 0, "", 1}, {&bus_options_parser, 0, "", 2}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Runs the control task on a CAN interface. An interrupt (Ctrl-C), SIGTERM, a hangup or a "
        "reader of the output that went away unloads the springs, switches the drives off and "
        "ends. So do, with --steps, a latched fault and a node that is refused because it is not as "
        "the files say; without --steps an operator may clear the fault over the bus, and a "
        "refused node may be exchanged or switched off and on, which sets it up anew: --auto-reset "
        "waits for that, with --steps as well. A node that is not there is always waited for.\v"
        "Exit status: 0 walked, 1 stopped by a fault or a node is refused, 2 wrong usage, input or "
        "interface, or the output could not be written.",
        children,
        0,
        0};
    *options = (struct host_options){.answer_timeout_ns = UINT64_C(1000000000)};
    walk_options_init(&options->walk);
    option_parse(&parser, argc, argv, options);
}
