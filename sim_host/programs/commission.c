/* afo commission: from a box of parts to a device file and a page to sign. */
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/program.h"
#include "sim_host/commission/commission.h"
#include "sim_host/programs/bus_wait.h"
#include "sim_host/programs/commands.h"
#include "sim_host/programs/frame_socket.h"

enum { HELP_MAX = 4096, PATH_ROOM = OUTPUT_PATH_MAX + 256 };
/* Answers of all nodes, and their heartbeats: seven bits are the node. */
enum { ANY_NODE_MASK = 0x780, ANSWER_POLL_MS = 50, KEY_FRAMES = 0x600, KEY_LIST, FD_MAX = 1 << 20 };

struct options {
    const char *interface, *device_path, *out_path, *page_path, *record_path;
    const char *eds[SIDE_COUNT];
    const char *reason[COMMISSION_STEPS]; /* to skip; NULL = is not */
    bool chosen[COMMISSION_STEPS];
    bool any_chosen, only_list;
    int fd; /* --frames; -1: none */
    struct commission commission;
    struct socketcan_bus socket;
    struct frame_socket frames;
};

static const struct argp_option option_list[] = {
    {"can", 'c', "INTERFACE", 0, "CAN interface of the device (must be given)", 0},
    {"frames", KEY_FRAMES, "FD", 0,
     "instead of --can, an inherited socket with a frame in each packet: how afo view runs it", 0},
    {"device", 'd', "FILE", 0, "the device as it is declared (must be given)", 0},
    {"out", 'o', "FILE", 0, "the device file with what was found (commissioned.ini)", 0},
    {"page", 'p', "FILE", 0, "the page to sign (commissioning.html)", 0},
    {"record", 'r', "FILE", 0, "results, which a later run goes on from (commissioning.ini)", 0},
    {"step", 's', "NAME", 0, "do this step only, also again; may be given several times", 0},
    {"skip", 'k', "NAME=REASON", 0, "skip this step, and write the reason down", 0},
    {"list", KEY_LIST, 0, 0,
     "only print the steps and what is recorded of them, as JSON; no bus is needed", 0},
    {"eds-left", 'l', "FILE", 0, "data sheet of the left drive: is it this one?", 0},
    {"eds-right", 'R', "FILE", 0, "of the right drive", 0},
    {0}};

static int step_or_error(struct argp_state *state, const char *option, const char *name)
{
    char message[OBJECT_MESSAGE_MAX];
    const int step = commission_step_named(name, message);
    if (step < 0) {
        argp_error(state, "%s: %s", option, message);
    }
    return step;
}

static void take_skip(struct options *options, struct argp_state *state, char *text)
{
    char *sign = strchr(text, '=');
    if (sign == NULL || sign[1] == '\0') {
        argp_error(state, "--skip: write NAME=REASON");
        return;
    }
    *sign = '\0';
    const int step = step_or_error(state, "--skip", text);
    if (step >= 0) {
        options->reason[step] = sign + 1;
    }
}

/* What is written must not take the place of what is read, nor of each other. */
static void check_files(const struct options *options, struct argp_state *state)
{
    const char *files[] = {options->device_path, options->out_path, options->page_path,
                           options->record_path};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        for (size_t k = 0; k < i; k++) {
            if (files[i] != NULL && files[k] != NULL && strcmp(files[i], files[k]) == 0) {
                argp_error(
                    state,
                    "%s is named twice: device file, --out, --page and --record are four files",
                    files[i]);
            }
        }
    }
}

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    int step;
    switch (key) {
    case 'c':
        options->interface = text;
        break;
    case KEY_LIST:
        options->only_list = true;
        break;
    case KEY_FRAMES:
        options->fd = (int)option_whole(state, "--frames", text, 0, FD_MAX);
        break;
    case 'd':
        options->device_path = text;
        break;
    case 'o':
        options->out_path = text;
        break;
    case 'p':
        options->page_path = text;
        break;
    case 'r':
        options->record_path = text;
        break;
    case 'l':
        options->eds[SIDE_LEFT] = text;
        break;
    case 'R':
        options->eds[SIDE_RIGHT] = text;
        break;
    case 's':
        step = step_or_error(state, "--step", text);
        if (step >= 0) {
            options->chosen[step] = options->any_chosen = true;
        }
        break;
    case 'k':
        take_skip(options, state, text);
        break;
    case ARGP_KEY_ARG:
        option_refuse_argument(state, text);
        break;
    case ARGP_KEY_END:
        if (options->device_path == NULL ||
            (!options->only_list && (options->interface == NULL) == (options->fd < 0))) {
            argp_error(state, "--can INTERFACE and --device FILE must be given");
        }
        check_files(options, state);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* ---- the person, and time -------------------------------------------------------------- */

static void instruct(void *context, enum commission_hand hand, enum side leg, const char *words)
{
    (void)context;
    (void)leg;
    if (hand != COMMISSION_HAND_NOTHING) {
        printf("  >> %s\n", words);
        fflush(stdout);
    }
}

/* The first letter of the next line of standard input; '\0' at its end, or when the program is to end: an
 * interrupt must not wait for a line. */
static char next_answer(void)
{
    char first = '\0', letter;
    while (!bus_program_is_to_end()) {
        struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
        if (poll(&input, 1, ANSWER_POLL_MS) <= 0) {
            continue;
        }
        if (read(STDIN_FILENO, &letter, 1) != 1 || letter == '\0') {
            return '\0';
        }
        if (letter == '\n') {
            return first != '\0' ? first : ' ';
        }
        first = first == '\0' ? letter : first;
    }
    return '\0';
}

/* A person at the terminal answers y or n; nobody answers where standard input is at its end. */
static int confirm(void *context, enum side leg, const char *question)
{
    (void)context;
    (void)leg;
    for (;;) {
        printf("  ?? %s (y/n) ", question);
        fflush(stdout);
        const char answer = next_answer();
        if (answer == '\0') {
            printf("\n");
            return -1;
        }
        if (answer == 'y' || answer == 'n') {
            return answer == 'y' ? 1 : 0;
        }
    }
}

/* ---- files ------------------------------------------------------------------------------- */

enum written { WRITTEN_RECORD, WRITTEN_PAGE, WRITTEN_DEVICE };

static int write_file(const struct options *options, const char *path, enum written what)
{
    static struct output_file file;
    char message[PATH_ROOM] = "";
    memset(&file, 0, sizeof file);
    if (output_file_open(&file, path, message, sizeof message) != 0) {
        return program_complain("%s", message);
    }
    switch (what) {
    case WRITTEN_RECORD:
        commission_record_write(&options->commission, file.stream);
        break;
    case WRITTEN_PAGE:
        commission_page_write(&options->commission, file.stream);
        break;
    case WRITTEN_DEVICE:
        device_file_write(file.stream, &options->commission.device);
        break;
    }
    if (output_file_commit(&file, message, sizeof message) != 0) {
        return program_complain("%s", message);
    }
    return 0;
}

/* After every step, so that a run that is broken off loses nothing. */
static int write_all(const struct options *options)
{
    return write_file(options, options->record_path, WRITTEN_RECORD) != 0 ||
                   write_file(options, options->page_path, WRITTEN_PAGE) != 0 ||
                   write_file(options, options->out_path, WRITTEN_DEVICE) != 0
               ? -1
               : 0;
}

static int read_all(struct options *options)
{
    struct commission *commission = &options->commission;
    char message[DEVICE_MESSAGE_MAX] = "";
    static struct device_file declared;
    if (device_file_read(&declared, options->device_path, message) != 0) {
        return program_complain("%s", message);
    }
    commission_declare(commission, &declared);
    if (commission_record_read(commission, options->record_path, message) != 0) {
        return program_complain("%s", message);
    }
    if (message[0] != '\0') {
        (void)program_complain("%s", message);
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (options->eds[leg] != NULL &&
            commission_read_eds(&commission->expected[leg], options->eds[leg], message) != 0) {
            return program_complain("%s", message);
        }
    }
    return 0;
}

/* ---- the command ---------------------------------------------------------------------------- */

static const char *help_text(void)
{
    static char text[HELP_MAX];
    size_t used = (size_t)snprintf(
        text, sizeof text, "Sets a device up step by step, and writes what was found.\vSteps:\n");
    for (int step = 0; step < COMMISSION_STEPS; step++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "  %-10s %s\n",
                                 commission_step_name((enum commission_step)step),
                                 commission_step_shows((enum commission_step)step));
    }
    (void)snprintf(
        text + used, sizeof text - used,
        "\nThe controller (board or afo host) must run and no walk be requested. It moves "
        "the motors; this program only asks, and when it goes away both springs are "
        "unloaded. Steps that have passed are not repeated unless --step names them. "
        "Ctrl-C ends it at any time without harm.\n"
        "\nExit status: 0 every step passed or was skipped, 1 not, 2 wrong usage, input or "
        "interface.");
    return text;
}

static bool is_wanted(const struct options *options, int step)
{
    if (options->any_chosen) {
        return options->chosen[step];
    }
    const enum commission_verdict verdict = options->commission.result[step].verdict;
    return verdict != COMMISSION_PASSED && verdict != COMMISSION_SKIPPED &&
           verdict != COMMISSION_NO_PART;
}

static int run_steps(struct options *options)
{
    struct commission *commission = &options->commission;
    for (int step = 0; step < COMMISSION_STEPS && !bus_program_is_to_end(); step++) {
        if (options->reason[step] != NULL) {
            commission_skip(commission, (enum commission_step)step, options->reason[step]);
        } else if (is_wanted(options, step)) {
            (void)commission_run(commission, (enum commission_step)step);
        } else {
            continue;
        }
        if (write_all(options) != 0) {
            return EXIT_USAGE;
        }
    }
    return commission_is_complete(commission) ? EXIT_GOOD : EXIT_BAD;
}

/* Returns 0, or -1 behind a complaint. */
static int open_link(struct options *options, struct ctl_link *link)
{
    static const struct socketcan_filter filters[] = {{CO_COB_SDO_ANSWER, ANY_NODE_MASK},
                                                      {CO_COB_HEARTBEAT, ANY_NODE_MASK}};
    link->node = NODE_CONTROLLER;
    if (options->interface == NULL) {
        link->bus = frame_socket_bus(&options->frames);
        link->wait = frame_socket_wait;
        link->pause = frame_socket_pause;
        link->context = &options->frames;
        return frame_socket_init(&options->frames, options->fd) == 0
                   ? 0
                   : program_complain(
                         "--frames %d: no socket of packets was inherited by this number",
                         options->fd);
    }
    const int opened = socketcan_bus_open(&options->socket, options->interface, filters, 2, false);
    if (opened != 0) {
        bus_program_no_interface(options->interface, opened);
        return -1;
    }
    link->bus = socketcan_bus_interface(&options->socket);
    link->wait = bus_wait;
    link->pause = bus_wait_pause;
    link->context = &options->socket;
    return 0;
}

int afo_commission(int argc, char **argv)
{
    const struct argp parser = {option_list, take, 0, help_text(), 0, 0, 0};
    static struct options options;
    struct commission *commission = &options.commission;
    struct ctl *ctl = &commission->ctl;
    options.fd = -1;
    options.out_path = "commissioned.ini";
    options.page_path = "commissioning.html";
    options.record_path = "commissioning.ini";
    option_parse(&parser, argc, argv, &options);
    if (read_all(&options) != 0) {
        return EXIT_USAGE;
    }
    if (options.only_list) {
        commission_list_write(commission, stdout);
        return program_output_done() == 0 ? EXIT_GOOD : EXIT_USAGE;
    }
    const time_t now = time(NULL);
    (void)strftime(commission->now, sizeof commission->now, "%Y-%m-%d %H:%M", localtime(&now));
    bus_program_catch_signals();
    if (open_link(&options, &ctl->link) != 0) {
        return EXIT_USAGE;
    }
    ctl->out = stdout;
    ctl->complaints = stderr;
    commission->person = (struct commission_operator){.instruct = instruct, .confirm = confirm};
    ctl_open(ctl);
    const int status = run_steps(&options);
    if (options.interface != NULL) {
        socketcan_bus_close(&options.socket);
    }
    return program_output_done() != 0 ? EXIT_USAGE : status;
}
