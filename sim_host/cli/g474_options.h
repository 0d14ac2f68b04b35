/* The command line of afo g474: what it is told to walk, and the faults it can bring. */
#ifndef SIM_HOST_CLI_G474_OPTIONS_H
#define SIM_HOST_CLI_G474_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/cli/emulator_options.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/cli/sensor_options.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/emulator/g474/chip_session.h"

struct g474_options {
    struct walk_options walk;
    struct emulator_options emulator;
    struct sensing_options sensing;
    struct sensor_options sensor;
    const char *core;
    double seconds;
    enum chip_fault fault;
    uint32_t fault_step, cut, every, lose;
    const char *log_path, *costs_path, *trace_path, *profile_path, *recording_path;
    bool board, alike, gdb;
    unsigned gdb_port;
};

/* Sets the defaults and takes the arguments; ends the program where they are wrong (status 2)
 * or ask for help. */
void g474_options_parse(struct g474_options *options, int argc, char **argv);

#endif
