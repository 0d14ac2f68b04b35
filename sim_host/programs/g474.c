/* afo g474: the walk with the very image that is flashed, in an emulated STM32G474. */
#include <time.h>

#include "hal/bus/frame_table.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/g474_options.h"
#include "sim_host/cli/g474_report.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/cli/progress.h"
#include "sim_host/cli/recording_options.h"
#include "sim_host/ctl/ctl.h"
#include "sim_host/emulator/g474/chip_gdb.h"
#include "sim_host/emulator/g474/chip_trial.h"
#include "sim_host/programs/commands.h"

struct g474 {
    struct g474_options options;
    struct chip_session session;
    struct output_file log, costs, trace, profile_file;
    struct chip_profile profile;
    struct progress progress;
    struct chip_gdb gdb;
};

static void tell_progress(void *context, uint32_t steps)
{
    progress_tell((struct progress *)context, steps);
}

static int prepare(struct g474 *g474)
{
    const struct g474_options *options = &g474->options;
    struct chip_session *session = &g474->session;
    struct loop_config config;
    char message[LOOP_MESSAGE_MAX] = "";

    if (sensing_options_configure(&options->sensing, &options->walk, &options->sensor, &config,
                                  message) != 0 ||
        recording_options_play(options->recording_path, options->walk.open_loop, &config,
                               message) != 0) {
        return program_complain("%s", message);
    }
    if (program_open_output(&g474->log, options->log_path) != 0 ||
        program_open_output(&g474->costs, options->costs_path) != 0 ||
        program_open_output(&g474->trace, options->trace_path) != 0 ||
        program_open_output(&g474->profile_file, options->profile_path) != 0) {
        return -1;
    }
    session->steps = options->emulator.steps;
    session->seconds = options->seconds;
    session->is_recording = options->recording_path != NULL;
    session->fault = options->fault;
    session->fault_step = options->fault_step;
    session->cuts.at = options->cut;
    session->cuts.every = options->every;
    session->cuts.alike = options->alike;
    session->lose = options->lose;
    session->on_step = tell_progress;
    session->context = &g474->progress;
    if (chip_session_start(session, &config, options->core, options->emulator.image,
                           g474->log.stream, message) != 0) {
        return program_complain("%s", message);
    }
    session->bridge.corrupt_frame = options->emulator.corrupt_frame;
    session->bridge.costs = g474->costs.stream;
    session->chip.trace = g474->trace.stream;
    if (g474->profile_file.stream != NULL) {
        g474->profile.out = g474->profile_file.stream;
        session->chip.profile = &g474->profile;
    }
    if (options->gdb && chip_gdb_open(&g474->gdb, &session->chip, options->gdb_port) != 0) {
        return program_complain("%s", g474->gdb.link.message);
    }
    return 0;
}

enum { SDO_PATIENCE_TICKS = 500 };

static bool let_it_run(void *context, unsigned waits)
{
    struct chip_session *session = context;

    chip_bridge_tick(&session->bridge);
    return waits < SDO_PATIENCE_TICKS;
}

/* What `afo ctl board' says of this board. */
static void ask_board(struct chip_session *session, bool json)
{
    static char verb[] = "board";
    static struct ctl ctl;
    char *words[] = {verb};

    chip_bridge_stop_comparing(&session->bridge);
    session->crash_known = true; /* the tool's queue is read from here on */
    ctl = (struct ctl){.link = {.bus = session->tool,
                                .wait = let_it_run,
                                .context = session,
                                .node = NODE_CONTROLLER},
                       .json = json,
                       .out = stdout,
                       .complaints = stderr};
    ctl_open(&ctl);
    (void)ctl_run(&ctl, 1, words);
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int run(struct g474 *g474)
{
    struct chip_session *session = &g474->session;
    const double start_s = now_s();

    if (prepare(g474) != 0) {
        return EXIT_USAGE;
    }
    progress_begin(&g474->progress, "steps", session->steps,
                   g474->options.emulator.quiet || g474->options.emulator.json);
    chip_session_walk(session);
    progress_end(&g474->progress);
    if (session->fault != CHIP_FAULT_NONE && session->trouble[0] == '\0') {
        chip_trial_run(session);
    }
    const double wall_s = now_s() - start_s;
    chip_gdb_close(&g474->gdb);
    if (program_commit_output(&g474->log) != 0 || program_commit_output(&g474->costs) != 0 ||
        program_commit_output(&g474->trace) != 0 ||
        program_commit_output(&g474->profile_file) != 0) {
        return EXIT_BAD;
    }
    if (g474->options.emulator.json) {
        g474_report_json(session, wall_s);
    } else if (!g474->options.emulator.quiet) {
        g474_report_text(session, wall_s);
    }
    if (g474->options.board) {
        ask_board(session, g474->options.emulator.json);
    }
    return chip_session_is_good(session) ? EXIT_GOOD : EXIT_BAD;
}

int afo_g474(int argc, char **argv)
{
    static struct g474 g474;

    g474_options_parse(&g474.options, argc, argv);
    const int status = run(&g474);
    output_file_discard(&g474.log);
    output_file_discard(&g474.costs);
    output_file_discard(&g474.trace);
    output_file_discard(&g474.profile_file);
    chip_session_free(&g474.session);
    return status;
}
