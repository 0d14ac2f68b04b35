#include "sim_host/cli/sensing_options.h"

enum { KEY_SENSORS = 0x700, KEY_SEED };

static const struct argp_option option_list[] = {
    {"sensors", KEY_SENSORS, "PRESET", 0, "ideal, 17bit (default), 14bit or 12bit", 0},
    {"seed", KEY_SEED, "N", 0, "seed of all noise (default 1)", 0},
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
    if (sensor != NULL) {
        sensor_options_apply(sensor, config);
    }
    return 0;
}
