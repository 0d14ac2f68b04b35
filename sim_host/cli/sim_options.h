/* Command line of afo sim. */
#ifndef SIM_HOST_CLI_SIM_OPTIONS_H
#define SIM_HOST_CLI_SIM_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/cli/ground_options.h"
#include "sim_host/cli/recording_options.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/cli/sensor_options.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/loop/loop.h"

struct sim_options {
    struct walk_options walk;
    uint32_t steps; /* UINT32_MAX: to the recording's end */
    struct sensing_options sensing;
    const char *csv_path;
    const char *pushes_path; /* NULL: no table of the legs' pushes */
    bool ticks;              /* a line a tick in --csv in place of the steps */
    const char *ticks_path;  /* NULL: no table of ticks beside that of the steps */
    const char *log_path;
    struct recording_options recording;
    struct sensor_options sensor;
    struct ground_options ground;
    enum loop_fault fault;
    uint32_t engage_steps; /* 0 = the bench: a walker without a push-off of its own */
    uint32_t fault_step, fault_delay_ms;
    double release_late_s; /* the latches open so much later than their cause */
    bool real_time;        /* one tick a millisecond instead of as fast as it goes */
    bool quiet;
    bool json;
    int argc; /* the whole command line, for the record */
    char **argv;
};

/* Parses the command line; --help and --version end the process with 0, a usage
 * error with a message on standard error and 2. */
void sim_options_parse(struct sim_options *options, int argc, char **argv);

#endif
