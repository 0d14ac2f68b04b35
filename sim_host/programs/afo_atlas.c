/* Where a walker walks, point by point: the basin of attraction as a volume, the plane of push-off and stiffness.
 * See `afo-atlas --help`; scripts/bench-atlas draws what it writes. Runs under mpirun as it stands. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "firmware/version.h"
#include "sim_host/batch/atlas.h"
#include "sim_host/batch/batch.h"

static const char help[] =
    "usage: afo-atlas basin FILE [--points N] [--r0 M] [--strides N] [--threads N]\n"
    "       afo-atlas plane FILE [--points N] [--mass-ratio X] [--threads N]\n"
    "basin: N^3 apexes of the paper's walker (default 128): forward speed 0.05..2 rad/s, swing angle\n"
    "       -0.8..1.2 rad, swing rate -1..4 rad/s; a byte each: whole strides before the fall, or 255 (default r0\n"
    "       0.05, 60 strides)\n"
    "plane: N x N (default 200) of r0/l 0.005..0.3 and k l/(M g) 3..30 for a walker of m/M = X (default 0.01, the\n"
    "       paper's; 0.0385 a 70 kg adult's); a byte each: 0 falls, 1..64 period, 255 none\n"
    "--lanes 2, 4 or 8: vectors of that width (0: the widest; the results are the same).\n"
    "FILE is resumed when it is there; interrupt at will. mpirun -n R afo-atlas ... shares the work among ranks.\n";

enum { EXIT_USAGE = 2 };

struct options {
    int points, strides, threads, lanes;
    double push, mass_ratio;
};

static int number_of(const char *text, double low, double high, double *number)
{
    char *end;
    *number = strtod(text, &end);
    return end != text && *end == '\0' && *number >= low && *number <= high;
}

/* One option and its value; 0, and a message, when it is not one. */
static int take(struct options *options, const char *name, const char *text)
{
    static const struct {
        const char *name;
        double low, high;
    } known[] = {{"--points", 2, 20000}, {"--strides", 1, 254},  {"--threads", 0, 256},
                 {"--r0", 0, 10},        {"--mass-ratio", 0, 1}, {"--lanes", 0, 8}};
    double number = 0.0;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(name, known[i].name) != 0) {
            continue;
        }
        if (text == NULL || !number_of(text, known[i].low, known[i].high, &number)) {
            fprintf(stderr, "afo-atlas: %s must be a number from %g to %g\n", name, known[i].low,
                    known[i].high);
            return 0;
        }
        switch (i) {
        case 0:
            options->points = (int)number;
            break;
        case 1:
            options->strides = (int)number;
            break;
        case 2:
            options->threads = (int)number;
            break;
        case 3:
            options->push = number;
            break;
        case 4:
            options->mass_ratio = number;
            break;
        default:
            options->lanes = (int)number;
        }
        return 1;
    }
    fprintf(stderr, "afo-atlas: unknown option %s; see --help\n", name);
    return 0;
}

static int run(struct chunks_job job, const struct options *options)
{
    job.threads = options->threads;
    job.is_progress_shown = isatty(STDERR_FILENO) || getenv("OMPI_COMM_WORLD_SIZE") != NULL;
    const enum chunks_status status = chunks_run(&job);
    if (status == CHUNKS_DONE || status == CHUNKS_HELPED) {
        return EXIT_SUCCESS;
    }
    fprintf(stderr, "afo-atlas: %s: %s%s%s\n", job.path, chunks_status_name(status),
            status == CHUNKS_NO_FILE ? ": " : "", status == CHUNKS_NO_FILE ? strerror(errno) : "");
    return EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    const int is_basin = argc > 2 && strcmp(argv[1], "basin") == 0;
    const int is_plane = argc > 2 && strcmp(argv[1], "plane") == 0;
    struct options options = {is_basin ? 128 : 200, 60, 0, 0, 0.05, 0.01};
    if (argc > 1 && strcmp(argv[1], "--version") == 0) {
        printf("afo-atlas %s\n", version_text());
        return EXIT_SUCCESS;
    }
    if (!is_basin && !is_plane) {
        const int is_asked = argc > 1 && strcmp(argv[1], "--help") == 0;
        fputs(help, is_asked ? stdout : stderr);
        return is_asked ? EXIT_SUCCESS : EXIT_USAGE;
    }
    if (argv[2][0] == '-') {
        fprintf(stderr, "afo-atlas: %s: the name of a file comes first; see --help\n", argv[2]);
        return EXIT_USAGE;
    }
    for (int i = 3; i < argc; i += 2) {
        if (!take(&options, argv[i], i + 1 < argc ? argv[i + 1] : NULL)) {
            return EXIT_USAGE;
        }
    }
    if (batch_use_lanes(options.lanes) != BATCH_OK) {
        fputs(
            "afo-atlas: --lanes must be 2, 4 or 8, and this processor must have them; 0: the widest\n",
            stderr);
        return EXIT_USAGE;
    }
    if (is_basin) {
        struct atlas_basin basin = {1.0,
                                    0.01,
                                    1.0,
                                    100.0,
                                    9.80665,
                                    options.push,
                                    1e-6,
                                    {0.05, 2.0, options.points},
                                    {-0.8, 1.2, options.points},
                                    {-1.0, 4.0, options.points},
                                    options.strides};
        return run(atlas_basin_job(&basin, argv[2]), &options);
    }
    struct atlas_plane plane = {
        options.mass_ratio, {0.005, 0.3, options.points}, {3.0, 30.0, options.points}};
    return run(atlas_plane_job(&plane, argv[2]), &options);
}
