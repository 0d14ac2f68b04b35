#include "sim_host/batch/benchmark.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "model/real.h"

double benchmark_now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int benchmark_open(struct benchmark_rows *rows, int argc, char **argv)
{
    static const char usage[] =
        "usage: %s REFERENCE.csv [SECONDS PER MEASUREMENT [MORE]]\n"
        "Lines \"method,setting,largest error,median error,strides per second\" over the strides of\n"
        "REFERENCE.csv (tests/sim_host/batch/reference_strides.csv), whose ends are known.\n";
    if (argc > 1 && strcmp(argv[1], "--help") == 0) {
        printf(usage, argv[0]);
        exit(fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE);
    }
    if (argc < 2 || argc > 4) {
        fprintf(stderr, usage, argv[0]);
        return 0;
    }
    rows->count = reference_read(argv[1], rows->row, BENCHMARK_MAX_ROWS);
    rows->least_time_s = argc > 2 ? strtod(argv[2], NULL) : 0.2;
    if (rows->count <= 0) {
        fprintf(stderr, "%s: cannot read strides from %s\n", argv[0], argv[1]);
        return 0;
    }
    return 1;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void errors_of(const struct benchmark_rows *rows, double (*next)[3], double *largest,
                      double *median)
{
    static double error[BENCHMARK_MAX_ROWS];
    for (int i = 0; i < rows->count; i++) {
        error[i] = 0.0;
        for (int k = 0; k < 3; k++) {
            const double off = real_abs(next[i][k] - rows->row[i].next[k]);
            error[i] = off > error[i] || off != off ? off : error[i];
        }
    }
    qsort(error, (size_t)rows->count, sizeof error[0], by_size);
    *largest = error[rows->count - 1];
    *median = error[rows->count / 2];
}

void benchmark_measure(const char *name, const struct benchmark_rows *rows,
                       benchmark_method_fn *method, void *context, double setting, int repeats)
{
    static double next[BENCHMARK_MAX_ROWS][3];
    double largest, median, best = 1e30, spent = 0.0;
    if (!method(context, rows, setting, next)) {
        fprintf(stderr, "%s at %g: a stride failed\n", name, setting);
        return;
    }
    errors_of(rows, next, &largest, &median);
    for (int pass = 0; pass < 3 || spent < rows->least_time_s; pass++) {
        const double start = benchmark_now_s();
        method(context, rows, setting, next);
        const double took = benchmark_now_s() - start;
        best = took < best ? took : best;
        spent += took;
    }
    printf("%s,%.17g,%.3e,%.3e,%.6g\n", name, setting, largest, median,
           (double)rows->count * repeats / best);
    fflush(stdout);
}
