#include "sim_host/cli/bus_program.h"

#include <errno.h>
#include <string.h>

#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The bus:", 2},
    {"can", 'c', "INTERFACE", 0, "CAN interface, such as can0 or vcan0 (must be given)", 0},
    {"steps", 'n', "N", 0, "end after N steps (default: at SIGINT, SIGTERM or SIGHUP)", 0},
    {0, 0, 0, 0, "What comes out:", 4},
    {"json", 'j', 0, 0, "one JSON object on standard output at the end, nothing else", 0},
    {"quiet", 'q', 0, 0, "only errors", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct bus_options *options = (struct bus_options *)state->input;
    switch (key) {
    case 'c':
        options->interface = text;
        break;
    case 'n':
        options->steps = (uint32_t)option_whole(state, "--steps", text, 1, BUS_PROGRAM_STEPS_MAX);
        break;
    case 'j':
        options->json = true;
        break;
    case 'q':
        options->quiet = true;
        break;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        break;
    case ARGP_KEY_END:
        if (options->interface == NULL) {
            argp_error(state, "--can INTERFACE must be given");
        }
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp bus_options_parser = {option_list, take, 0, 0, 0, 0, 0};

static volatile sig_atomic_t asked_to_end;

static void on_signal(int number)
{
    (void)number;
    asked_to_end = 1;
}

void bus_program_catch_signals(void)
{
    const struct sigaction action = {.sa_handler = on_signal}; /* without SA_RESTART */
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    struct sigaction inherited;
    if (sigaction(SIGHUP, NULL, &inherited) == 0 && inherited.sa_handler != SIG_IGN) {
        sigaction(SIGHUP, &action, NULL); /* under nohup(1) it stays without effect */
    }
    signal(SIGPIPE, SIG_IGN); /* a reader that went away is a write error like others */
}

bool bus_program_is_to_end(void)
{
    return asked_to_end != 0;
}

void bus_program_no_interface(const char *interface, int error)
{
    program_complain("CAN interface %s: %s%s", interface, strerror(-error),
                     error == -EAFNOSUPPORT
                         ? " (this kernel has no CAN; scripts/vcan-guest brings one)"
                     : error == -ENODEV ? " (ip link shows the interfaces)"
                     : error == -EINVAL ? " (a name has at most 15 characters)"
                                        : "");
}
