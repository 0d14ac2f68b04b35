#include "sim_host/cli/sensor_options.h"

#include "sim_host/cli/option.h"

enum { KEY_LATENCY = 0x500, KEY_NOISE, KEY_DROP, KEY_COLOURED, KEY_OFFSET_LEFT, KEY_OFFSET_RIGHT };

#define COLOURED_NOISE_HZ 5.0

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "Leg sensors (default: as --sensors has them):", 1},
    {"sensor-latency", KEY_LATENCY, "MS", 0, "age of a sample at its SYNC, 0 to 5 ms", 0},
    {"sensor-noise", KEY_NOISE, "COUNTS", 0, "white noise of the leg angle, RMS", 0},
    {"sensor-drop", KEY_DROP, "SHARE", 0, "share of the samples that are not sent", 0},
    {"sensor-wander", KEY_COLOURED, "MRAD", 0, "noise of the leg angle below 5 Hz, RMS", 0},
    {"sensor-offset-left", KEY_OFFSET_LEFT, "MRAD", 0, "mounting error of the left leg angle", 0},
    {"sensor-offset-right", KEY_OFFSET_RIGHT, "MRAD", 0, "of the right one", 0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct sensor_options *options = (struct sensor_options *)state->input;
    switch (key) {
    case KEY_LATENCY:
        options->latency_ms = option_number(state, "--sensor-latency", text, 0.0, 5.0);
        break;
    case KEY_NOISE:
        options->noise_counts = option_number(state, "--sensor-noise", text, 0.0, 100.0);
        break;
    case KEY_DROP:
        options->drop_share = option_number(state, "--sensor-drop", text, 0.0, 1.0);
        break;
    case KEY_COLOURED:
        options->coloured_mrad = option_number(state, "--sensor-wander", text, 0.0, 100.0);
        break;
    case KEY_OFFSET_LEFT:
        options->offset_mrad[SIDE_LEFT] =
            option_number(state, "--sensor-offset-left", text, -500.0, 500.0);
        break;
    case KEY_OFFSET_RIGHT:
        options->offset_mrad[SIDE_RIGHT] =
            option_number(state, "--sensor-offset-right", text, -500.0, 500.0);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

const struct argp sensor_options_parser = {option_list, take, 0, 0, 0, 0, 0};

void sensor_options_init(struct sensor_options *options)
{
    *options = (struct sensor_options){-1.0, -1.0, -1.0, -1.0, {0.0, 0.0}};
}

void sensor_options_apply(const struct sensor_options *options, struct loop_config *config)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sensor_params *sensor = &config->plant.sensors[side];
        if (options->latency_ms >= 0.0) {
            sensor->latency_s = 1e-3 * options->latency_ms;
            config->params.sensor_latency_s = (real)sensor->latency_s;
        }
        if (options->noise_counts >= 0.0) {
            sensor->angle_noise_counts = options->noise_counts;
        }
        if (options->drop_share >= 0.0) {
            sensor->drop_probability = options->drop_share;
        }
        if (options->coloured_mrad >= 0.0) {
            sensor->angle_coloured_rad = 1e-3 * options->coloured_mrad;
            sensor->angle_coloured_hz = COLOURED_NOISE_HZ;
        }
        sensor->angle_offset_rad = 1e-3 * options->offset_mrad[side];
    }
}
