/* afo replay: a recorded log through the control task, command frames compared. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/version.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/log/replay.h"
#include "sim_host/programs/commands.h"

struct options {
    struct walk_options walk;
    const char *log_path;
    const char *interface; /* NULL: the controller's */
    bool quiet;
    bool foreign_nodes;
    bool from_boot;
};

enum { KEY_FOREIGN_NODES = 0x600, KEY_INTERFACE, KEY_FROM_BOOT };

static const struct argp_option option_list[] = {
    {"quiet", 'q', 0, 0, "say nothing when all is equal", 2},
    {"interface", KEY_INTERFACE, "NAME", 0,
     "which interface of the log (default: the one with the controller's frames)", 2},
    {"from-boot", KEY_FROM_BOOT, 0, 0,
     "leave out what lies before the controller's first boot-up: the log begins in the middle of a run",
     2},
    {"foreign-nodes", KEY_FOREIGN_NODES, 0, 0,
     "other nodes spoke with identifiers of the controller (a tool's SDO requests, NMT): what it does not hear itself "
     "is theirs",
     2},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        break;
    case 'q':
        options->quiet = true;
        break;
    case KEY_INTERFACE:
        if (text[0] == '\0' || strlen(text) >= CANDUMP_INTERFACE_MAX) {
            argp_error(state, "an interface has a name of 1 to 15 characters, not \"%s\"", text);
        }
        options->interface = text;
        break;
    case KEY_FOREIGN_NODES:
        options->foreign_nodes = true;
        break;
    case KEY_FROM_BOOT:
        options->from_boot = true;
        break;
    case ARGP_KEY_ARG:
        if (options->log_path != NULL) {
            argp_error(state, "one log at a time, found also \"%s\"", text);
        }
        options->log_path = text;
        break;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "which log? afo replay LOG");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* Extra frames that no digest tells of: the controller's own, or another node's? */
static int report_unheard(const struct replay *replay, const char *path)
{
    printf(
        "%s: %s; %llu such frame%s in all that the controller does not hear itself: its own, or another node's "
        "(then say --foreign-nodes)\n",
        path, replay->unheard_message, (unsigned long long)replay->unheard_frames,
        replay->unheard_frames == 1 ? "" : "s");
    return EXIT_BAD;
}

static void report_identity(const struct replay *replay)
{
    const uint32_t own = version_build_id();
    printf("recorded by build %08x, parameter CRC %08x", replay->build_id, replay->parameter_crc);
    if (replay->build_id != own) {
        printf(" (this is another build: %08x)", own);
    }
    putchar('\n');
}

static int report(const struct replay *replay, enum replay_verdict verdict, const char *path,
                  bool quiet)
{
    switch (verdict) {
    case REPLAY_EQUAL:
        if (!quiet) {
            printf("%s: %llu frames, %llu ticks; all %llu frames of the controller reproduced",
                   path, (unsigned long long)replay->frames, (unsigned long long)replay->all_ticks,
                   (unsigned long long)replay->compared);
            if (replay->runs > 1) {
                printf(", in %u runs", replay->runs);
            }
            putchar('\n');
            if (replay->interfaces > 1) {
                printf("of interface %s, the log has %u\n", replay->interface, replay->interfaces);
            }
            if (replay->foreign_frames > 0) {
                printf("%llu frame%s of another node with identifiers of the controller\n",
                       (unsigned long long)replay->foreign_frames,
                       replay->foreign_frames == 1 ? "" : "s");
            }
            if (replay->build_id != 0) {
                report_identity(replay);
            }
            if (replay->all_ticks > replay->digest_tick) {
                printf("the inputs of the last %llu ticks were not judged: no digest of the "
                       "controller follows them\n",
                       (unsigned long long)(replay->all_ticks - replay->digest_tick));
            }
            if (replay->snapshots > 0) {
                printf("from the middle of a walk, by %u snapshot%s\n", replay->snapshots,
                       replay->snapshots > 1 ? "s" : "");
            }
        }
        return EXIT_GOOD;
    case REPLAY_DIFFERS:
        printf("%s: %s\n", path, replay->message);
        return EXIT_BAD;
    default:
        program_complain("%s: %s", path, replay->message);
        return EXIT_USAGE;
    }
}

int afo_replay(int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 1}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        "LOG",
        "Feeds a candump log (-: standard input) to the control task and compares every frame that the controller "
        "sent, bit by bit. Subject, speed and law must be those of the recorded run.\v"
        "Exit status: 0 all frames reproduced, 1 a frame differs, 2 wrong usage or log.",
        children,
        0,
        0};
    static struct replay replay;
    struct options options = {0};
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    char message[SUBJECT_MESSAGE_MAX] = "";

    walk_options_init(&options.walk);
    option_parse(&parser, argc, argv, &options);
    if (walk_options_resolve(&options.walk, &subject, &params, &speed_rad_s, message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    const bool is_input = strcmp(options.log_path, "-") == 0;
    FILE *log = is_input ? stdin : fopen(options.log_path, "r");
    if (log == NULL) {
        program_complain("%s: %s", options.log_path, strerror(errno));
        return EXIT_USAGE;
    }
    if (replay_init(&replay, &subject, &params, speed_rad_s) != 0) {
        program_complain("the control task refuses these parameters");
        fclose(log);
        return EXIT_USAGE;
    }
    if (options.interface != NULL) {
        (void)replay_set_interface(&replay, options.interface);
    }
    replay.from_boot = options.from_boot;
    const enum replay_verdict verdict = replay_run(&replay, log);
    fclose(log);
    const int status =
        verdict == REPLAY_EQUAL && replay.unheard_frames > 0 && !options.foreign_nodes
            ? report_unheard(&replay, options.log_path)
            : report(&replay, verdict, options.log_path, options.quiet);
    return program_output_done() == 0 ? status : EXIT_USAGE;
}
