/* afo ctl: one node's objects over SDO, by name. */
#include <stdio.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/programs/bus_wait.h"
#include "sim_host/programs/commands.h"

enum { WORDS_MAX = 256, HELP_MAX = 4096 };

struct options {
    const char *interface;
    struct ctl ctl;
    char *words[WORDS_MAX];
    int word_count;
    struct socketcan_bus socket;
};

static const struct argp_option option_list[] = {
    {"can", 'c', "INTERFACE", 0, "CAN interface, such as can0 or vcan0 (must be given)", 0},
    {"node", 'n', "N", 0, "the node that is asked (16, the controller)", 0},
    {"json", 'j', 0, 0, "JSON on standard output; watch prints an object a line", 0},
    {"all", 'a', 0, 0, "dump what is only shown, too", 0},
    {"period", 'p', "MS", 0, "watch: look so often (200 ms)", 0},
    {"looks", 'l', "N", 0, "watch: end after N looks (default: at Ctrl-C)", 0},
    {"timeout", 't', "S", 0, "walk, stop, reset, zero: wait so long for it (10 s)", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    struct ctl *ctl = &options->ctl;
    switch (key) {
    case 'c':
        options->interface = text;
        break;
    case 'n':
        ctl->link.node = (uint8_t)option_whole(state, "--node", text, 1, CO_NODE_MAX);
        break;
    case 'j':
        ctl->json = true;
        break;
    case 'a':
        ctl->all = true;
        break;
    case 'p':
        ctl->period_ms = (unsigned)option_whole(state, "--period", text, 1, 3600000);
        break;
    case 'l':
        ctl->looks = (unsigned)option_whole(state, "--looks", text, 1, 1000000000);
        break;
    case 't':
        ctl->patience_ms =
            (unsigned)(1000.0 * option_number(state, "--timeout", text, 0.0, 3600.0));
        break;
    case ARGP_KEY_ARG:
        if (options->word_count == WORDS_MAX) {
            argp_error(state, "more than %d words", (int)WORDS_MAX);
        }
        options->words[options->word_count++] = text;
        break;
    case ARGP_KEY_END:
        if (options->word_count == 0) {
            argp_error(state, "what shall be done? The verbs are listed by --help");
        }
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* ---- the command ----------------------------------------------------------------------- */

/* The list of verbs for --help, from their table. */
static const char *help_text(void)
{
    static char text[HELP_MAX];
    size_t used = (size_t)snprintf(
        text, sizeof text, "Reads and writes a node's objects over SDO, by name.\vVerbs:\n");
    for (size_t i = 0; i < ctl_verb_count; i++) {
        char head[64];
        (void)snprintf(head, sizeof head, "%s %s", ctl_verbs[i].name, ctl_verbs[i].words);
        used += (size_t)snprintf(text + used, sizeof text - used, "  %-19s %s\n", head,
                                 ctl_verbs[i].summary);
    }
    (void)snprintf(
        text + used, sizeof text - used,
        "\nA NAME is a whole name (commands.walk_requested), the part behind its point, a "
        "group (commands), or an address (0x2000:02). To read, the beginning of one name "
        "is enough. Values are in SI units.\n"
        "\nExit status: 0 done, equal; 1 refused, silent, different, or not in time; 2 "
        "wrong usage or interface.");
    return text;
}

int afo_ctl(int argc, char **argv)
{
    const struct argp parser = {option_list, take, "VERB [WORD..]", help_text(), 0, 0, 0};
    static struct options options;
    struct ctl *ctl = &options.ctl;
    ctl->link.node = NODE_CONTROLLER;
    ctl->period_ms = 200;
    ctl->patience_ms = 10000;
    ctl->out = stdout;
    ctl->complaints = stderr;
    option_parse(&parser, argc, argv, &options);
    const bool asks_no_node = strcmp(options.words[0], "names") == 0;
    if (options.interface == NULL && asks_no_node) {
        object_list_make(&ctl->objects, ctl_kind_of_node(ctl->link.node));
        return (int)ctl_run(ctl, options.word_count, options.words);
    }
    if (options.interface == NULL) {
        program_complain("--can INTERFACE must be given");
        return EXIT_USAGE;
    }
    const struct socketcan_filter filters[] = {
        {(uint32_t)CO_COB_SDO_ANSWER + ctl->link.node, CAN_ID_STANDARD_MAX},
        {FRAME_SDO_ANSWER_CONTROLLER, CAN_ID_STANDARD_MAX}};
    bus_program_catch_signals();
    const int opened = socketcan_bus_open(&options.socket, options.interface, filters, 2, false);
    if (opened != 0) {
        bus_program_no_interface(options.interface, opened);
        return EXIT_USAGE;
    }
    ctl->link.bus = socketcan_bus_interface(&options.socket);
    ctl->link.wait = bus_wait;
    ctl->link.pause = bus_wait_pause;
    ctl->link.context = &options.socket;
    ctl_open(ctl);
    const enum exit_status status = ctl_run(ctl, options.word_count, options.words);
    socketcan_bus_close(&options.socket);
    return program_output_done() != 0 ? EXIT_USAGE : (int)status;
}
