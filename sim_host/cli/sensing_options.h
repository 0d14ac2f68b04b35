/* The options --sensors and --seed, the same for every command that has a simulated walker. */
#ifndef SIM_HOST_CLI_SENSING_OPTIONS_H
#define SIM_HOST_CLI_SENSING_OPTIONS_H

#include <argp.h>
#include <stdint.h>

#include "sim_host/cli/sensor_options.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/loop/loop.h"

struct sensing_options {
    enum sensor_preset_kind preset;
    const char *preset_name;
    uint64_t seed;                          /* of all noise */
    const char *drive_eds_path[SIDE_COUNT]; /* NULL: the virtual drives have all that they have */
};

/* Child parser: its input is a struct sensing_options, set up by sensing_options_init. */
extern const struct argp sensing_options_parser;

void sensing_options_init(struct sensing_options *options);

/* From the options to a configured loop: who walks and how fast, with which sensors. sensor: changes of
 * the preset, or NULL. Returns 0, or -1 with the reason in message (LOOP_MESSAGE_MAX bytes). */
int sensing_options_configure(const struct sensing_options *options,
                              const struct walk_options *walk, const struct sensor_options *sensor,
                              struct loop_config *config, char *message);

#endif
