/* afo blackbox: the controller's black box, fetched over CAN, as a candump log. */
#include <stdio.h>

#include "hal/bus/frame_table.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/program.h"
#include "sim_host/log/black_box_log.h"
#include "sim_host/programs/bus_wait.h"
#include "sim_host/programs/commands.h"

struct options {
    const char *interface, *out_path;
    bool freeze, release, quiet;
};

static const struct argp_option option_list[] = {
    {"out", 'o', "FILE", 0, "the log (standard output)", 0},
    {"freeze", 'f', 0, 0, "freeze a box that still records; without, only a frozen one is read", 0},
    {"release", 'r', 0, 0,
     "let it record anew once the log is written, and call its crash record seen", 0},
    {"quiet", 'q', 0, 0, "no summary on standard error", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;

    switch (key) {
    case 'o':
        options->out_path = text;
        break;
    case 'f':
        options->freeze = true;
        break;
    case 'r':
        options->release = true;
        break;
    case 'q':
        options->quiet = true;
        break;
    case ARGP_KEY_ARG:
        if (options->interface != NULL) {
            argp_error(state, "one interface at a time, found also \"%s\"", text);
        }
        options->interface = text;
        break;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "which interface? afo blackbox IFACE");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void summarize(const struct black_box_summary *summary, const char *version)
{
    fprintf(stderr, "firmware %s, build %08x, parameter CRC %08x\n", version,
            (unsigned)summary->build_id, (unsigned)summary->parameter_crc);
    fprintf(stderr, "ticks %u to %u: %u frames, %u snapshots; fault bits %08x at tick %u\n",
            (unsigned)summary->first_tick, (unsigned)summary->last_tick, (unsigned)summary->frames,
            (unsigned)summary->snapshots, (unsigned)summary->reason,
            (unsigned)summary->trigger_tick);
    if (summary->damaged > 0 || summary->lost_frames > 0) {
        fprintf(stderr, "%u blocks broke off, %u frames found no room\n",
                (unsigned)summary->damaged, (unsigned)summary->lost_frames);
    }
}

static int run(const struct options *options, struct socketcan_bus *socket, struct output_file *out)
{
    static struct black_box box;
    const struct can_bus bus = socketcan_bus_interface(socket);
    struct black_box_summary summary;
    struct crash_record crash;
    char version[BLACK_BOX_VERSION_MAX + 1], message[OUTPUT_PATH_MAX + 256] = "";

    if (black_box_fetch_crash(&bus, bus_wait, socket, &crash, message, sizeof message) != 0) {
        program_complain("%s", message);
        return EXIT_BAD;
    }
    if (crash.magic != 0 && !options->quiet) {
        fprintf(
            stderr,
            "crash %u since power-up: cause %u, pc %08x, lr %08x, detail %u, address %08x, cfsr %08x\n",
            (unsigned)crash.count, (unsigned)crash.cause, (unsigned)crash.pc, (unsigned)crash.lr,
            (unsigned)crash.detail, (unsigned)crash.fault_address, (unsigned)crash.cfsr);
    }
    if (black_box_fetch(&bus, bus_wait, socket, options->freeze, &box, version, message,
                        sizeof message) != 0) {
        program_complain("%s", message);
        return EXIT_BAD;
    }
    if (black_box_log_write(&box, version, options->interface, out->stream, &summary) != 0 &&
        summary.blocks == 0) {
        program_complain("the box holds nothing that can be read");
        return EXIT_BAD;
    }
    if (output_file_commit(out, message, sizeof message) != 0 ||
        (options->release &&
         black_box_release(&bus, bus_wait, socket, message, sizeof message) != 0)) {
        program_complain("%s", message);
        return EXIT_BAD;
    }
    if (!options->quiet) {
        summarize(&summary, version);
    }
    return EXIT_GOOD;
}

int afo_blackbox(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        "IFACE",
        "Fetches the black box of the orthosis controller (node 16) over SDO and writes it as a "
        "candump log, which afo replay plays from the middle of the walk.\v"
        "Exit status: 0 fetched, 1 not, 2 wrong usage or interface.",
        0,
        0,
        0};
    static const struct socketcan_filter filters[] = {
        {FRAME_SDO_ANSWER_CONTROLLER, CAN_ID_STANDARD_MAX}};
    static struct socketcan_bus socket;
    static struct output_file out;
    struct options options = {.out_path = "/dev/stdout"};
    char message[OUTPUT_PATH_MAX + 256] = "";

    option_parse(&parser, argc, argv, &options);
    const int opened = socketcan_bus_open(&socket, options.interface, filters, 1, false);
    if (opened != 0) {
        bus_program_no_interface(options.interface, opened);
        return EXIT_USAGE;
    }
    int status = EXIT_USAGE;
    if (output_file_open(&out, options.out_path, message, sizeof message) != 0) {
        program_complain("%s", message);
    } else {
        status = run(&options, &socket, &out);
    }
    output_file_discard(&out);
    socketcan_bus_close(&socket);
    return status;
}
