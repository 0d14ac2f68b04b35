/* Command-line options that change the leg sensors of a preset. */
#ifndef SIM_HOST_CLI_SENSOR_OPTIONS_H
#define SIM_HOST_CLI_SENSOR_OPTIONS_H

#include <argp.h>

#include "sim_host/loop/loop.h"

/* Of both legs; negative = as the preset has it. */
struct sensor_options {
    double latency_ms;
    double noise_counts;            /* white, RMS, of the leg angle */
    double drop_share;              /* samples that are not sent */
    double coloured_mrad;           /* slow noise of the leg angle, RMS, below 5 Hz */
    double offset_mrad[SIDE_COUNT]; /* mounting error, 0 = none */
};

/* Child parser: its input is a struct sensor_options, set up by sensor_options_init. */
extern const struct argp sensor_options_parser;

void sensor_options_init(struct sensor_options *options);

/* Changes the plant's sensors, and tells the controller the latency, which it is
 * meant to know; noise, offsets and losses it is not told. */
void sensor_options_apply(const struct sensor_options *options, struct loop_config *config);

#endif
