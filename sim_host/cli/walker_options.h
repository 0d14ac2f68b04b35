/* Command line of afo walker. */
#ifndef SIM_HOST_CLI_WALKER_OPTIONS_H
#define SIM_HOST_CLI_WALKER_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/sensing_options.h"
#include "sim_host/cli/walk_options.h"

enum { WALKER_APEXES_MAX = 100000 };

struct walker_options {
    struct walk_options walk;
    struct bus_options bus; /* steps: at most WALKER_APEXES_MAX */
    struct sensing_options sensing;
    bool in_stand;       /* it is held for ever, for commissioning */
    uint64_t silence_ms; /* without SYNC, before time goes on by the clock */
};

/* Parses the command line; --help and wrong usage end the process. */
void walker_options_parse(struct walker_options *options, int argc, char **argv);

#endif
