/* afo-settings: a subject's settings as the orthosis keeps them in flash, to be written to a
 * new device along with its firmware. */
#include <argp.h>
#include <stdio.h>
#include <string.h>

#include "sim_host/cli/output_file.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/subjects/settings_image.h"

enum { EXIT_WRITTEN = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

struct options {
    struct walk_options walk;
    const char *out_path;
    bool walk_at_start;
};

enum { KEY_WALK_AT_START = 0x200 };

static const struct argp_option option_list[] = {
    {"autostart", KEY_WALK_AT_START, 0, 0,
     "assist without being asked over the bus (on a bench only)", 2},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;

    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        return 0;
    case KEY_WALK_AT_START:
        options->walk_at_start = true;
        return 0;
    case ARGP_KEY_ARG:
        if (options->out_path != NULL) {
            argp_error(state, "one file at a time, found also \"%s\"", text);
        }
        options->out_path = text;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "into which file? afo-settings FILE.bin");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void no_recovery(void *context)
{
    (void)context;
}

static enum can_result no_frames(void *context, const struct can_msg *message)
{
    (void)context;
    (void)message;
    return CAN_OK;
}

/* The control task that is set up to read its settings from has no bus. */
static const struct can_bus_ops no_bus = {.send = no_frames, .recover = no_recovery};

static int write_settings(const struct options *options)
{
    static struct host_task rig;
    static uint8_t image[SETTINGS_IMAGE_BYTES];
    static struct output_file out;
    struct settings settings;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    char message[OUTPUT_PATH_MAX + SUBJECT_MESSAGE_MAX] = "";

    if (walk_options_resolve(&options->walk, &subject, &params, &speed_rad_s, message) != 0) {
        fprintf(stderr, "afo-settings: %s\n", message);
        return EXIT_USAGE;
    }
    if (subject.protocol != DRIVE_PROTOCOL_CIA402 ||
        host_task_init(&rig, &subject, &params, (struct can_bus){&no_bus, NULL}, speed_rad_s,
                       false) != CONTROL_PARAMS_OK) {
        fprintf(stderr, "afo-settings: the firmware speaks to CiA 402 drives only\n");
        return EXIT_USAGE;
    }
    settings_of_rig(&settings, &rig, speed_rad_s, options->walk_at_start);
    if (settings_check(&settings) != SETTINGS_OK || settings_image(&settings, image) != 0) {
        fprintf(stderr, "afo-settings: the firmware would refuse these settings\n");
        return EXIT_FAILED;
    }
    if (output_file_open(&out, options->out_path, message, sizeof message) != 0) {
        fprintf(stderr, "afo-settings: %s\n", message);
        return EXIT_FAILED;
    }
    (void)fwrite(image, 1, sizeof image, out.stream); /* the stream keeps its error */
    if (output_file_commit(&out, message, sizeof message) != 0) {
        fprintf(stderr, "afo-settings: %s\n", message);
        return EXIT_FAILED;
    }
    return EXIT_WRITTEN;
}

int main(int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 1}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        "FILE.bin",
        "Writes a subject's settings as the orthosis keeps them: both banks of its parameter "
        "memory, 8 KiB from 0x0807E000 on (make flash SUBJECT=FILE).\v"
        "Exit status: 0 written, 1 not, 2 wrong usage or subject.",
        children,
        0,
        0};
    struct options options = {0};

    walk_options_init(&options.walk);
    option_identity("afo-settings");
    if (argp_parse(&parser, argc, argv, 0, NULL, &options) != 0) {
        return EXIT_USAGE;
    }
    return write_settings(&options);
}
