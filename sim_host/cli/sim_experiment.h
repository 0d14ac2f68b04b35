/* The whole of a simulated experiment: who walked, by which law, how fast, with what sensors, on what
 * ground, what went wrong on purpose. */
#ifndef SIM_HOST_CLI_SIM_EXPERIMENT_H
#define SIM_HOST_CLI_SIM_EXPERIMENT_H

#include "sim_host/cli/json_writer.h"
#include "sim_host/cli/sim_options.h"

/* Puts it into an object that is open. config: as the options made it. */
void sim_experiment_json(struct json_writer *json, const struct sim_options *options,
                         const struct loop_config *config);

#endif
