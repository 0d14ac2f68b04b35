/* Command line of afo pil: what it is told to walk, and the fault it is to bring. */
#ifndef SIM_HOST_CLI_PIL_OPTIONS_H
#define SIM_HOST_CLI_PIL_OPTIONS_H

#include <stdint.h>

#include "sim_host/cli/emulator_options.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/cli/sensor_options.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/emulator/pil_faults.h"

struct pil_options {
    struct walk_options walk;
    struct emulator_options emulator;
    struct sensing_options sensing;
    struct sensor_options sensor;
    enum pil_fault fault;
    uint32_t fault_step;
    const char *log_path, *costs_path, *black_box_path, *recording_path;
};

/* Sets the defaults and parses the command line; --help and wrong usage end the process. */
void pil_options_parse(struct pil_options *options, int argc, char **argv);

#endif
