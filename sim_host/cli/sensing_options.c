#include "sim_host/cli/sensing_options.h"

#include <stdlib.h>

enum { KEY_SENSORS = 0x700, KEY_SEED, KEY_DRIVE_EDS };

static const struct argp_option option_list[] = {
    {"sensors", KEY_SENSORS, "PRESET", 0, "ideal, 17bit (default), 14bit or 12bit", 0},
    {"seed", KEY_SEED, "N", 0, "seed of all noise (default 1)", 0},
    {"drive-eds", KEY_DRIVE_EDS, "FILE.eds", 0,
     "the virtual CiA 402 drives refuse what this data sheet does not have; a second one is the right drive's",
     0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    static const char *const presets[] = {"ideal", "17bit", "14bit", "12bit"};
    struct sensing_options *options = (struct sensing_options *)state->input;
    switch (key) {
    case KEY_SENSORS:
        options->preset_name =
            presets[option_choice(state, "--sensors", text, presets,
                                  sizeof presets / sizeof presets[0], sizeof presets[0])];
        (void)sensor_preset_from_name(options->preset_name, &options->preset);
        return 0;
    case KEY_DRIVE_EDS:
        if (options->drive_eds_path[SIDE_LEFT] == NULL) {
            options->drive_eds_path[SIDE_LEFT] = text;
        }
        options->drive_eds_path[SIDE_RIGHT] = text;
        return 0;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp sensing_options_parser = {option_list, take, 0, 0, 0, 0, 0};

void sensing_options_init(struct sensing_options *options)
{
    *options = (struct sensing_options){.preset = SENSORS_17BIT, .preset_name = "17bit", .seed = 1};
}

/* The sheet stays until the process ends: drives point to it. */
static int read_sheet(const char *path, const struct eds_file **sheet, char *message)
{
    struct eds_file *eds = calloc(1, sizeof *eds);
    if (eds == NULL || eds_file_read(eds, path, message) != 0) {
        free(eds);
        return -1;
    }
    *sheet = eds;
    return 0;
}

int sensing_options_configure(const struct sensing_options *options,
                              const struct walk_options *walk, const struct sensor_options *sensor,
                              struct loop_config *config, char *message)
{
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    if (walk_options_resolve(walk, &subject, &params, &speed_rad_s, message) != 0 ||
        loop_configure(config, &subject, &params, speed_rad_s, options->preset, options->seed,
                       message) != 0) {
        return -1;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (options->drive_eds_path[side] != NULL &&
            read_sheet(options->drive_eds_path[side], &config->drive_eds[side], message) != 0) {
            return -1;
        }
    }
    if (sensor != NULL) {
        sensor_options_apply(sensor, config);
    }
    return 0;
}
