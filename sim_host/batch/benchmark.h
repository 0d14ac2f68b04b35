/* Measures methods that compute a stride: time against error, over strides known in higher precision.
 *
 * For the programs of make bench. Prints lines "method,setting,largest error,median error,strides per second"
 * to stdout, which scripts/bench collects.
 */
#ifndef SIM_HOST_BATCH_BENCHMARK_H
#define SIM_HOST_BATCH_BENCHMARK_H

#include "sim_host/batch/reference.h"

#define BENCHMARK_MAX_ROWS 1000

struct benchmark_rows {
    struct reference_stride row[BENCHMARK_MAX_ROWS];
    int count;
    double least_time_s; /* least time spent on one measurement */
};

/* Reads the rows named on the command line: PROGRAM FILE [SECONDS [MORE]]. 0, and a message on stderr, when it cannot.
 * PROGRAM --help says so on stdout and ends the program. */
int benchmark_open(struct benchmark_rows *rows, int argc, char **argv);

/* Computes the next apex of every row; setting: what the ladder varies. Returns 0 when a stride failed. */
typedef int benchmark_method_fn(void *context, const struct benchmark_rows *rows, double setting,
                                double (*next)[3]);

/* Measures one setting: the errors, then the fastest of at least three passes in `least_time_s`. repeats: how often
 * one call of the method computes the rows. Times are processor time of this thread. */
void benchmark_measure(const char *name, const struct benchmark_rows *rows,
                       benchmark_method_fn *method, void *context, double setting, int repeats);

/* Processor time of this thread, s. */
double benchmark_now_s(void);

#endif
