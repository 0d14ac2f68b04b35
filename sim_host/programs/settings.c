/* afo settings: a subject's settings as the orthosis keeps them in flash, to be written to a
 * new device along with its firmware. */
#include <stdio.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/programs/commands.h"
#include "sim_host/subjects/settings_image.h"

struct options {
    struct walk_options walk;
    const char *out_path;
    bool autostart;
};

enum { KEY_AUTOSTART = 0x200 };

static const struct argp_option option_list[] = {
    {"autostart", KEY_AUTOSTART, 0, 0,
     "assist after power-on without being asked over the bus (on a bench only)", 2},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;

    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        return 0;
    case KEY_AUTOSTART:
        options->autostart = true;
        return 0;
    case ARGP_KEY_ARG:
        if (options->out_path != NULL) {
            argp_error(state, "one file at a time, found also \"%s\"", text);
        }
        options->out_path = text;
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "into which file? afo settings FILE.bin");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int write_settings(const struct options *options)
{
    static uint8_t image[SETTINGS_IMAGE_BYTES];
    static struct output_file out;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    char message[OUTPUT_PATH_MAX + SUBJECT_MESSAGE_MAX] = "";

    if (walk_options_resolve(&options->walk, &subject, &params, &speed_rad_s, message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    if (options->autostart && !control_params_test_mode(&params)) {
        program_complain("--autostart is for a bench: a person (engage_steps above 0) is asked");
        return EXIT_USAGE;
    }
    if (settings_image_of(&subject, &params, speed_rad_s, options->autostart, image) != 0) {
        program_complain("the firmware would refuse these settings");
        return EXIT_BAD;
    }
    if (output_file_open(&out, options->out_path, message, sizeof message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    (void)fwrite(image, 1, sizeof image, out.stream); /* the stream keeps its error */
    if (output_file_commit(&out, message, sizeof message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    return EXIT_GOOD;
}

int afo_settings(int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 1}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        "FILE.bin",
        "Writes a person's and a device's settings as the orthosis keeps them: both banks of its parameter "
        "memory, 8 KiB from 0x0807E000 on (make flash PERSON=FILE DEVICE=FILE).\v"
        "Exit status: 0 written, 1 the firmware would refuse them, 2 wrong usage or files.",
        children,
        0,
        0};
    struct options options = {0};

    walk_options_init(&options.walk);
    option_parse(&parser, argc, argv, &options);
    return write_settings(&options);
}
