/* afo-slcan: a walk with the flashed object code on an emulated board that has no CAN
 * controller, but an slcan adapter on its UART. */
#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/cli/walk_options.h"
#include "sim_host/emulator/slcan_bridge.h"
#include "sim_host/loop/loop.h"
#include "sim_host/loop/walk_record.h"
#include "sim_host/subjects/settings_image.h"

enum { EXIT_GOOD = 0, EXIT_BAD = 1, EXIT_USAGE = 2, PATIENCE_TICKS = 20000, REST_TICKS = 150 };

struct options {
    struct walk_options walk;
    const char *image;
    uint32_t steps;
    uint64_t corrupt_frame;
    bool json;
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

enum { KEY_IMAGE = 0x200, KEY_STEPS, KEY_CORRUPT };

static const struct argp_option option_list[] = {
    {"image", KEY_IMAGE, "ELF", 0, "what the emulator runs (build/arm/afo-mps2-an386.elf)", 2},
    {"steps", KEY_STEPS, "N", 0, "walk this many steps (3); a step takes some seconds", 2},
    {"corrupt", KEY_CORRUPT, "N", 0, "flip a bit of the board's N-th frame: must be noticed", 2},
    {"json", 'j', 0, 0, "one JSON object on standard output", 2},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;

    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        return 0;
    case KEY_IMAGE:
        options->image = text;
        return 0;
    case KEY_STEPS:
        options->steps = (uint32_t)option_whole(state, "--steps", text, 1, 1000);
        return 0;
    case KEY_CORRUPT:
        options->corrupt_frame = option_whole(state, "--corrupt", text, 1, UINT64_MAX);
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "unexpected argument \"%s\"", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int prepare(struct session *session)
{
    const struct options *options = &session->options;
    uint8_t nv[SETTINGS_IMAGE_BYTES];
    struct settings settings;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    char message[LOOP_MESSAGE_MAX] = "the settings do not fit the parameter memory";

    slcan_bridge_init(&session->bridge, &session->emulator);
    session->bridge.corrupt_frame = options->corrupt_frame;
    if (walk_options_resolve(&options->walk, &subject, &params, &speed_rad_s, message) == 0 &&
        loop_configure(&session->config, &subject, &params, speed_rad_s, SENSORS_17BIT, 1,
                       message) == 0 &&
        walk_record_init(&session->record, options->steps, 0.0)) {
        session->config.wrap_bus = slcan_bridge_wrap;
        session->config.wrap_context = &session->bridge;
        if (loop_init(&session->loop, &session->config, NULL, message) == 0) {
            settings_of_rig(&settings, &session->loop.rig, speed_rad_s, true);
            if (settings_image(&settings, nv) == 0 &&
                emulator_start(&session->emulator, EMULATOR_UART, options->image, nv, sizeof nv,
                               message, sizeof message) == 0) {
                return 0;
            }
        }
    }
    fprintf(stderr, "afo-slcan: %s\n", message);
    return -1;
}

static bool walk(struct session *session)
{
    const uint32_t steps = session->options.steps;
    uint64_t last_progress = 0;
    uint32_t seen = 0;

    while (session->loop.tick - last_progress < PATIENCE_TICKS) {
        loop_tick(&session->loop);
        (void)walk_record_take(&session->record, &session->loop);
        if (session->bridge.failed) {
            snprintf(session->trouble, sizeof session->trouble,
                     "the board is gone, silent, or out of step");
            return false;
        }
        if (plant_fault(&session->loop.nodes.plant) != WALK_FAULT_NONE) {
            snprintf(session->trouble, sizeof session->trouble, "fell: %s",
                     walk_fault_name(plant_fault(&session->loop.nodes.plant)));
            return false;
        }
        if (session->record.count != seen) {
            seen = session->record.count;
            last_progress = session->loop.tick;
        }
        if (seen >= steps && (session->record.rows[steps - 1].measured ||
                              session->loop.tick - last_progress > REST_TICKS)) {
            return true;
        }
    }
    snprintf(session->trouble, sizeof session->trouble, "no step for %d ticks", PATIENCE_TICKS);
    return false;
}

static void report(const struct session *session, bool walked)
{
    const struct slcan_bridge *bridge = &session->bridge;

    if (session->options.json) {
        printf(
            "{\"walked\": %s, \"steps\": %u, \"trouble\": \"%s\", \"ticks\": %llu, \"syncs\": %u, "
            "\"compared_frames\": %llu, \"differences\": %llu, \"bytes_in\": %llu, "
            "\"bytes_out\": %llu}\n",
            walked ? "true" : "false", session->record.count, session->trouble,
            (unsigned long long)session->loop.tick, bridge->syncs,
            (unsigned long long)bridge->compared, (unsigned long long)bridge->differences,
            (unsigned long long)bridge->bytes_in, (unsigned long long)bridge->bytes_out);
        return;
    }
    printf("%u steps over slcan, %llu ticks; %llu bytes from the board, %llu to it\n",
           session->record.count, (unsigned long long)session->loop.tick,
           (unsigned long long)bridge->bytes_in, (unsigned long long)bridge->bytes_out);
    printf("frames compared with the host's build: %llu, different: %llu\n",
           (unsigned long long)bridge->compared, (unsigned long long)bridge->differences);
    if (session->trouble[0] != '\0') {
        printf("trouble: %s\n", session->trouble);
    }
}

int main(int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 1}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Walks with the flashed object code on an emulated Cortex-M4F over slcan on its UART; the "
        "adapter, the bus and the walker are here.\v"
        "Exit status: 0 walked and every frame was the host's, 1 not, 2 usage.",
        children,
        0,
        0};
    static struct session session;

    session.options = (struct options){.image = "build/arm/afo-mps2-an386.elf", .steps = 3};
    session.emulator = (struct emulator){.to_image = -1, .from_image = -1, .uart = -1};
    option_identity("afo-slcan");
    walk_options_init(&session.options.walk);
    if (argp_parse(&parser, argc, argv, 0, NULL, &session.options) != 0) {
        return EXIT_USAGE;
    }
    int status = EXIT_USAGE;
    if (prepare(&session) == 0) {
        const bool walked = walk(&session);
        report(&session, walked);
        status = walked && session.bridge.differences == 0 ? EXIT_GOOD : EXIT_BAD;
    }
    emulator_stop(&session.emulator);
    walk_record_free(&session.record);
    loop_free(&session.loop);
    return status;
}
