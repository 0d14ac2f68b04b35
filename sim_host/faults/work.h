/* Many runs by many processes, kept in files so that an interrupted campaign goes on.
 *
 * Each process appends a line for every run to a file of its own; lines that are there are not made
 * again, however many processes made them.
 */
#ifndef SIM_HOST_FAULTS_WORK_H
#define SIM_HOST_FAULTS_WORK_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { WORK_JOBS_MAX = 64 };

struct work {
    uint32_t runs, jobs;
    uint32_t chunk;  /* so many runs in a row are one process's */
    const char *out; /* folder; NULL: a temporary one */
    char prefix[64]; /* of the files' names: campaign and seed */
    double run_s;    /* of one processor, about, for the announcement */
    void *context;
    bool (*wants)(void *context, uint32_t index); /* whether run `index` is asked for */
    bool (*begin)(void *context);                 /* before the first run; false: no campaign */
    void (*make)(void *context, uint32_t index, FILE *file); /* one run, one line */
    /* A line that is there: its number and true, or false for a line that is none. */
    bool (*take)(void *context, const char *line, uint32_t *index);
};

/* Makes every run that is wanted and not there, then takes all lines that are there. Returns EXIT_GOOD, or
 * EXIT_USAGE behind a complaint. */
int work_do(struct work *work);

#endif
