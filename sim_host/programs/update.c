/* afo update: a new program for the controller, over CAN. */
#include <stdio.h>
#include <stdlib.h>

#include "hal/bus/frame_table.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/option.h"
#include "sim_host/cli/program.h"
#include "sim_host/log/program_send.h"
#include "sim_host/programs/bus_wait.h"
#include "sim_host/programs/commands.h"

enum {
    RESTART_WAITS = 20, /* each asks, and waits for a second when nothing answers */
    FILE_MAX = 1024 * 1024
};

struct options {
    const char *interface, *image;
    bool allow_older, quiet;
};

enum { KEY_ALLOW = 0x200 };

static const struct argp_option option_list[] = {
    {"allow-downgrade", KEY_ALLOW, 0, 0, "take an image that is older than the running program", 0},
    {"quiet", 'q', 0, 0, "no progress on standard error", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;

    switch (key) {
    case KEY_ALLOW:
        options->allow_older = true;
        break;
    case 'q':
        options->quiet = true;
        break;
    case ARGP_KEY_ARG:
        if (options->interface == NULL) {
            options->interface = text;
        } else if (options->image == NULL) {
            options->image = text;
        } else {
            argp_error(state, "one image at a time, found also \"%s\"", text);
        }
        break;
    case ARGP_KEY_END:
        if (options->image == NULL) {
            argp_error(state, "which image? afo update IFACE IMAGE");
        }
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

struct progress_of {
    size_t length;
    unsigned percent;
};

static void tell(void *context, size_t done)
{
    struct progress_of *progress = context;
    const unsigned percent = (unsigned)(100 * done / progress->length);

    if (percent >= progress->percent + 10) {
        progress->percent = percent;
        fprintf(stderr, "%u %%\n", percent);
    }
}

static uint8_t *read_file(const char *path, size_t *bytes)
{
    FILE *file = fopen(path, "rb");
    uint8_t *content = file != NULL ? malloc(FILE_MAX) : NULL;

    *bytes = content != NULL ? fread(content, 1, FILE_MAX, file) : 0;
    if (file == NULL) {
        program_complain("cannot read the image %s", path);
    } else {
        fclose(file);
    }
    return content;
}

static int run(const struct options *options, struct socketcan_bus *socket, const uint8_t *program,
               size_t length, const struct program_header *header)
{
    const struct can_bus bus = socketcan_bus_interface(socket);
    struct sdo_upload tool = {
        .bus = &bus, .node = NODE_CONTROLLER, .wait = bus_wait, .context = socket};
    struct progress_of progress = {length, 0};
    struct program_send send = {.tool = &tool,
                                .allow_older = options->allow_older,
                                .told = options->quiet ? NULL : tell,
                                .told_context = &progress,
                                .restart_waits = RESTART_WAITS};
    uint32_t before = 0;

    if (program_send_identify(&send, &before) != 0 ||
        program_send(&send, program, length, header->crc) != 0) {
        program_complain("%s", send.message);
        return EXIT_BAD;
    }
    if (!options->quiet) {
        fprintf(stderr, "version %u.%u.%u, build %08x runs\n", header->version >> 16,
                header->version >> 8 & 0xFF, header->version & 0xFF, (unsigned)header->build_id);
    }
    return EXIT_GOOD;
}

int afo_update(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        "IFACE IMAGE",
        "Sends a program (build/arm/afo-BOARD.bin) to the orthosis controller (node 16) over CAN, "
        "and waits until it runs. The controller takes it at standstill without torque only. "
        "Power may fail at any time: the old or the new program runs afterwards. Nobody's "
        "authority is checked: whoever reaches the bus can do this.\v"
        "Exit status: 0 the new program runs, 1 not, 2 wrong usage, image or interface.",
        0,
        0,
        0};
    static const struct socketcan_filter filters[] = {
        {FRAME_SDO_ANSWER_CONTROLLER, CAN_ID_STANDARD_MAX}};
    static struct socketcan_bus socket;
    struct options options = {0};
    struct program_header header;
    size_t bytes, length = 0;

    option_parse(&parser, argc, argv, &options);
    uint8_t *file = read_file(options.image, &bytes);
    const uint8_t *program = file != NULL ? program_send_find(file, bytes, &length, &header) : NULL;
    if (program == NULL) {
        if (file != NULL) {
            program_complain("%s holds no program: make firmware builds build/arm/afo-BOARD.bin",
                             options.image);
        }
        free(file);
        return EXIT_USAGE;
    }
    const int opened = socketcan_bus_open(&socket, options.interface, filters, 1, false);
    if (opened != 0) {
        bus_program_no_interface(options.interface, opened);
        free(file);
        return EXIT_USAGE;
    }
    const int status = run(&options, &socket, program, length, &header);
    socketcan_bus_close(&socket);
    free(file);
    return status;
}
