/* Command line of afo view. */
#ifndef SIM_HOST_CLI_VIEW_OPTIONS_H
#define SIM_HOST_CLI_VIEW_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/cli/sim_options.h"

struct view_options {
    struct sim_options sim;  /* of the walk in this process; always in real time */
    const char *interface;   /* --can; NULL: none */
    const char *replay_path; /* --replay: a log or a trial; NULL: none */
    const char *trials_path; /* where trials are kept */
    const char *listen;      /* the address that is listened at */
    const char *host_names;  /* further names by which browsers may call it; NULL: none */
    unsigned port;           /* 0: any free one */
    bool control;
    bool in_stand; /* the walker in this process is kept in a stand, and no walk is asked for */
};

/* Parses the command line; --help and --version end the process with 0, a usage error with a message on
 * standard error and 2. */
void view_options_parse(struct view_options *options, int argc, char **argv);

#endif
