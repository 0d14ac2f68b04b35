/* afo slcan: a walk with the flashed object code on an emulated board that has no CAN
 * controller, but an slcan adapter on its UART. */
#include <stdio.h>
#include <string.h>

#include "sim_host/cli/emulator_options.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/progress.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/emulator/image_start.h"
#include "sim_host/emulator/slcan_bridge.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/walk_record.h"
#include "sim_host/loop/walk_watch.h"
#include "sim_host/programs/commands.h"

struct options {
    struct walk_options walk;
    struct emulator_options emulator;
};

struct session {
    struct options options;
    struct loop_config config;
    struct loop loop;
    struct emulator emulator;
    struct slcan_bridge bridge;
    struct walk_record record;
    char trouble[256];
};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;

    (void)text;
    if (key != ARGP_KEY_INIT) {
        return ARGP_ERR_UNKNOWN;
    }
    state->child_inputs[0] = &options->walk;
    state->child_inputs[1] = &options->emulator;
    return 0;
}

static int prepare(struct session *session)
{
    const struct options *options = &session->options;
    struct sensing_options sensing;
    char message[LOOP_MESSAGE_MAX] = "out of memory";

    sensing_options_init(&sensing);
    slcan_bridge_init(&session->bridge, &session->emulator);
    session->bridge.corrupt_frame = options->emulator.corrupt_frame;
    if (sensing_options_configure(&sensing, &options->walk, NULL, &session->config, message) == 0 &&
        walk_record_init(&session->record, options->emulator.steps, 0.0)) {
        session->config.wrap_bus = slcan_bridge_wrap;
        session->config.wrap_context = &session->bridge;
        if (loop_init(&session->loop, &session->config, NULL, message) == 0 &&
            image_start(&session->emulator, EMULATOR_UART, options->emulator.image, &session->loop,
                        false, message, sizeof message) == 0) {
            return 0;
        }
    }
    return program_complain("%s", message);
}

static bool walk(struct session *session)
{
    struct walk_watch watch;
    struct progress progress;
    enum walk_end end;

    walk_watch_init(&watch, session->options.emulator.steps, false);
    progress_begin(&progress, "steps", session->options.emulator.steps,
                   session->options.emulator.quiet || session->options.emulator.json);
    do {
        loop_tick(&session->loop);
        (void)walk_record_take(&session->record, &session->loop);
        if (session->bridge.failed) {
            snprintf(session->trouble, sizeof session->trouble,
                     "the board is gone, silent, or out of step");
            return false;
        }
        progress_tell(&progress, session->record.count);
        end = walk_watch_tick(&watch, &session->record, &session->loop);
    } while (end == WALK_GOES_ON);
    progress_end(&progress);
    if (end == WALK_FELL) {
        snprintf(session->trouble, sizeof session->trouble, "fell: %s",
                 walk_fault_name(plant_fault(&session->loop.nodes.plant)));
    } else if (end == WALK_STALLED) {
        snprintf(session->trouble, sizeof session->trouble, "no step within %d s",
                 walk_watch_limit_s(&watch));
    }
    return end == WALK_DONE;
}

static void report_json(const struct session *session, bool walked)
{
    const struct slcan_bridge *bridge = &session->bridge;
    struct json_writer json;

    json_begin(&json, stdout);
    json_open_object(&json, NULL);
    json_bool(&json, "walked", walked);
    json_unsigned(&json, "steps", session->record.count);
    json_text(&json, "trouble", session->trouble);
    json_unsigned(&json, "ticks", session->loop.tick);
    json_unsigned(&json, "syncs", bridge->syncs);
    json_unsigned(&json, "compared_frames", bridge->compared);
    json_unsigned(&json, "differences", bridge->differences);
    json_unsigned(&json, "bytes_in", bridge->bytes_in);
    json_unsigned(&json, "bytes_out", bridge->bytes_out);
    json_close_object(&json);
    json_end(&json);
}

static void report(const struct session *session)
{
    const struct slcan_bridge *bridge = &session->bridge;

    printf("%u steps over slcan, %llu ticks; %llu bytes from the board, %llu to it\n",
           session->record.count, (unsigned long long)session->loop.tick,
           (unsigned long long)bridge->bytes_in, (unsigned long long)bridge->bytes_out);
    printf("frames compared with the host's build: %llu, different: %llu\n",
           (unsigned long long)bridge->compared, (unsigned long long)bridge->differences);
    if (session->trouble[0] != '\0') {
        printf("trouble: %s\n", session->trouble);
    }
}

int afo_slcan(int argc, char **argv)
{
    static const struct argp_child children[] = {
        {&walk_options_parser, 0, "", 1}, {&emulator_options_parser, 0, "", 2}, {0}};
    static const struct argp parser = {
        0,
        take,
        0,
        "Walks with the flashed object code on an emulated Cortex-M4F over slcan on its UART; the "
        "adapter, the bus and the walker are here.\v"
        "Exit status: 0 walked and every frame was the host's, 1 not, 2 usage.",
        children,
        0,
        0};
    static struct session session;

    session.emulator = (struct emulator){.to_image = -1, .from_image = -1, .uart = -1};
    walk_options_init(&session.options.walk);
    emulator_options_init(&session.options.emulator, 3, 1000);
    option_parse(&parser, argc, argv, &session.options);
    int status = EXIT_USAGE;
    if (prepare(&session) == 0) {
        const bool walked = walk(&session);
        if (session.options.emulator.json) {
            report_json(&session, walked);
        } else if (!session.options.emulator.quiet) {
            report(&session);
        }
        status = walked && session.bridge.differences == 0 ? EXIT_GOOD : EXIT_BAD;
    }
    emulator_stop(&session.emulator);
    walk_record_free(&session.record);
    loop_free(&session.loop);
    return status;
}
