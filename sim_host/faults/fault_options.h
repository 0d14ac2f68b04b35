/* Command line of afo faults. */
#ifndef SIM_HOST_FAULTS_FAULT_OPTIONS_H
#define SIM_HOST_FAULTS_FAULT_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/faults/campaign.h"

enum { FAULT_JOBS_MAX = 64, FAULT_RUNS_MAX = 10000000 };

struct fault_options {
    uint32_t runs, jobs, run;
    uint64_t seed;
    bool single, markdown;
    const char *out, *log, *ticks, *only;
    bool people;           /* the campaign of people, by: */
    bool by_reflexes;      /* a person who walks by reflexes, and not recorded or made ones */
    const char *data;      /* a folder of recordings; NULL: none, made people only */
    const char *person;    /* person file */
    const char *device[2]; /* device files */
    struct campaign_walker walker;
    int argc;
    char **argv;
};

/* Parses the command line; --help and wrong usage end the process. */
void fault_options_parse(struct fault_options *options, int argc, char **argv);

/* Whether --only asks for runs whose first fault is of this kind; without it, for all. */
bool fault_options_want(const struct fault_options *options, uint32_t kind);

#endif
