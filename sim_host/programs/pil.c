/* afo pil: the walk with the flashed object code on an emulated Cortex-M4F.
 *
 * The image runs in QEMU, the plant here; every frame that the image sends is
 * compared with what the host's build of the same code sends on the same frames.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/pil_options.h"
#include "sim_host/cli/pil_report.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/cli/progress.h"
#include "sim_host/cli/recording_options.h"
#include "sim_host/emulator/image_start.h"
#include "sim_host/emulator/pil_session.h"
#include "sim_host/programs/commands.h"

struct pil {
    struct pil_options options;
    struct loop_config config;
    struct pil_session session;
    struct output_file log, costs, black_box_log;
    struct progress progress;
};

static void tell_progress(void *context, uint32_t steps)
{
    progress_tell((struct progress *)context, steps);
}

static int configure(struct pil *pil)
{
    const struct pil_options *options = &pil->options;
    char message[LOOP_MESSAGE_MAX] = "";

    if (sensing_options_configure(&options->sensing, &options->walk, &options->sensor, &pil->config,
                                  message) != 0 ||
        recording_options_play(options->recording_path, options->walk.open_loop, &pil->config,
                               message) != 0) {
        return program_complain("%s", message);
    }
    return 0;
}

static int start(struct pil *pil)
{
    struct pil_session *session = &pil->session;
    const bool damaged = session->fault == PIL_FAULT_PARAMETERS;
    char message[512] = "";

    session->bridge.comparing = session->bridge.comparing && !damaged;
    if (image_start(&session->emulator, EMULATOR_PIPES, pil->options.emulator.image, session->loop,
                    damaged, message, sizeof message) != 0) {
        return program_complain("%s", message);
    }
    return pil_bridge_greet(&session->bridge) == 0
               ? 0
               : program_complain("the image does not answer (is qemu-system-arm installed?)");
}

static int prepare(struct pil *pil)
{
    const struct pil_options *options = &pil->options;
    struct pil_session *session = &pil->session;
    char message[LOOP_MESSAGE_MAX] = "";

    if (configure(pil) != 0 || program_open_output(&pil->log, options->log_path) != 0 ||
        program_open_output(&pil->costs, options->costs_path) != 0 ||
        program_open_output(&pil->black_box_log, options->black_box_path) != 0) {
        return -1;
    }
    pil_bridge_init(&session->bridge, &session->emulator);
    session->bridge.corrupt_frame = options->emulator.corrupt_frame;
    session->bridge.costs = pil->costs.stream;
    session->steps = options->emulator.steps;
    session->is_recording = options->recording_path != NULL;
    session->fault = options->fault;
    session->fault_step = options->fault_step;
    session->on_step = tell_progress;
    session->context = &pil->progress;
    pil->config.wrap_bus = pil_bridge_wrap;
    pil->config.wrap_context = &session->bridge;
    session->loop = calloc(1, sizeof *session->loop);
    if (session->loop == NULL || !walk_record_init(&session->record, session->steps, 0.0)) {
        return program_complain("out of memory");
    }
    if (loop_init(session->loop, &pil->config, pil->log.stream, message) != 0) {
        return program_complain("%s", message);
    }
    session->tool =
        sim_bus_port(&session->loop->bus, sim_bus_attach(&session->loop->bus, "tool", NULL, NULL));
    return start(pil);
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int run(struct pil *pil)
{
    struct pil_session *session = &pil->session;
    const double start_s = now_s();

    if (prepare(pil) != 0) {
        return EXIT_USAGE;
    }
    progress_begin(&pil->progress, "steps", session->steps,
                   pil->options.emulator.quiet || pil->options.emulator.json);
    pil_session_walk(session);
    progress_end(&pil->progress);
    if (session->fault != PIL_FAULT_NONE) {
        pil_session_bring_fault(session);
    }
    if (pil->black_box_log.stream != NULL && session->trouble[0] == '\0') {
        pil_session_fetch_black_box(session, pil->black_box_log.stream);
    }
    const double wall_s = now_s() - start_s;
    if (program_commit_output(&pil->log) != 0 || program_commit_output(&pil->costs) != 0 ||
        program_commit_output(&pil->black_box_log) != 0) {
        return EXIT_BAD;
    }
    if (pil->options.emulator.json) {
        pil_report_json(session, wall_s);
    } else if (!pil->options.emulator.quiet) {
        pil_report_text(session, wall_s);
    }
    return session->reached && session->bridge.differences == 0 ? EXIT_GOOD : EXIT_BAD;
}

int afo_pil(int argc, char **argv)
{
    static struct pil pil;

    pil.session.emulator = (struct emulator){.to_image = -1, .from_image = -1, .uart = -1};
    pil_options_parse(&pil.options, argc, argv);
    const int status = run(&pil);
    emulator_stop(&pil.session.emulator);
    output_file_discard(&pil.log);
    output_file_discard(&pil.costs);
    output_file_discard(&pil.black_box_log);
    walk_record_free(&pil.session.record);
    if (pil.session.loop != NULL) {
        loop_free(pil.session.loop);
        free(pil.session.loop);
    }
    return status;
}
