/* Command line of afo host. */
#ifndef SIM_HOST_CLI_HOST_OPTIONS_H
#define SIM_HOST_CLI_HOST_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/walk_options.h"

struct host_options {
    struct walk_options walk;
    struct bus_options bus;
    bool real_time;
    bool auto_reset; /* on a bench: clear a latched fault by itself, and walk again */
    bool standby;    /* no walk is asked for at the start */
    uint64_t answer_timeout_ns;
};

/* Parses the command line; --help and wrong usage end the process. */
void host_options_parse(struct host_options *options, int argc, char **argv);

#endif
