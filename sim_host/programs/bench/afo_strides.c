/* afo-strides: walks a given number of strides on the batch engine and tells a digest of every bit of them.
 *
 * The digest is the same for any vectors, threads, compiler and machine; scripts/soak-strides and
 * scripts/neon-check compare it. Also watched: that the process does not grow. */
#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "firmware/version.h"
#include "sim_host/batch/batch.h"

enum { EXIT_WELL = 0, EXIT_ILL = 1, EXIT_USAGE = 2 };
enum { MOST_WALKERS = 8192, STRIDES_EACH = 100, SETTLED_ROUNDS = 3 };
#define GROWTH_MOST_KB 1024 /* of the process after its first rounds */
#define DIGEST_START 14695981039346656037u

struct options {
    double strides;
    int walkers, lanes, threads;
};

static const struct argp_option table[] = {
    {"strides", 'n', "N", 0, "at least so many (1e6)", 0},
    {"walkers", 'w', "N", 0,
     "so many side by side, 100 strides each (8192); the digest depends on it", 0},
    {"lanes", 'l', "2|4|8", 0, "vectors of that width (0: the widest)", 0},
    {"threads", 't', "N", 0, "so many threads (0: all cores)", 0},
    {0},
};

static double number_of(const char *text, double low, double high, const char *name,
                        const struct argp_state *state)
{
    char *end;
    const double number = strtod(text, &end);
    if (end == text || *end != '\0' || !(number >= low && number <= high)) {
        argp_error(state, "--%s: \"%s\" is not a number from %g to %g", name, text, low, high);
    }
    return number;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case 'n':
        options->strides = number_of(argument, 1, 1e15, "strides", state);
        return 0;
    case 'w':
        options->walkers = (int)number_of(argument, 8, MOST_WALKERS, "walkers", state);
        return 0;
    case 'l':
        options->lanes = (int)number_of(argument, 0, 8, "lanes", state);
        return 0;
    case 't':
        options->threads = (int)number_of(argument, 0, 256, "threads", state);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* The paper's walker, an adult, heavy legs: by turns. */
static const struct batch_walker bodies[] = {{1.0, 0.01, 1.0, 100.0, 9.80665},
                                             {65.0, 2.5, 0.93, 7000.0, 9.80665},
                                             {1.0, 0.1, 1.0, 100.0, 9.80665}};
#define BODIES (sizeof bodies / sizeof bodies[0])

static double next_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* Starts around the gaits: walks of every period, chaos and falls; an eighth of them on ground that is not level. */
static void make_starts(struct batch_item *items, size_t count, uint64_t *seed)
{
    for (size_t i = 0; i < count; i++) {
        const struct batch_walker *body = &bodies[i % BODIES];
        const double pace = sqrt(body->gravity_m_s2 / body->leg_length_m / 9.80665);
        items[i] = (struct batch_item){.walker = (uint32_t)(i % BODIES)};
        items[i].apex[0] = -pace * (0.39 + 0.04 * next_random(seed));
        items[i].apex[1] = -0.07 + 0.02 * next_random(seed);
        items[i].apex[2] = pace * (1.7 + 0.1 * next_random(seed));
        items[i].push_m = body->leg_length_m * (0.04 + 0.055 * next_random(seed));
        if (i < count / 8) {
            items[i].slope_rad = 0.004 * (next_random(seed) - 0.5);
            items[i].height_rise = 0.002 * (next_random(seed) - 0.5);
        }
    }
}

struct tally {
    uint64_t digest, strides, falls, by_apex[MOST_WALKERS];
};

/* Each walker's own digest of its apexes: which thread takes which is chance. */
static int note(void *context, size_t index, struct batch_item *item,
                const struct batch_slopes *slopes)
{
    struct tally *tally = context;
    (void)slopes;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &item->apex[k], sizeof bits);
        tally->by_apex[index] = (tally->by_apex[index] ^ bits) * 1099511628211u;
    }
    return 0;
}

static int walk_round(const struct options *options, struct batch_item *items, uint64_t *seed,
                      struct tally *tally)
{
    const size_t count = (size_t)options->walkers;
    const struct batch_settings settings = {0};
    const struct batch_job job = {.walkers = bodies,
                                  .walker_count = BODIES,
                                  .items = items,
                                  .count = count,
                                  .strides = STRIDES_EACH,
                                  .stride_done = note,
                                  .context = tally};
    make_starts(items, count, seed);
    for (size_t i = 0; i < count; i++) {
        tally->by_apex[i] = DIGEST_START;
    }
    const enum batch_error error = batch_run_threads(&settings, &job, options->threads);
    if (error != BATCH_OK) {
        fprintf(stderr, "afo-strides: %s\n", batch_error_name(error));
        return 0;
    }
    for (size_t i = 0; i < count; i++) {
        const uint64_t more[] = {tally->by_apex[i], (uint64_t)items[i].fault,
                                 (uint64_t)items[i].strides};
        for (size_t k = 0; k < sizeof more / sizeof more[0]; k++) {
            tally->digest = (tally->digest ^ more[k]) * 1099511628211u;
        }
        tally->strides += (uint64_t)items[i].strides;
        tally->falls += items[i].fault != 0;
    }
    return 1;
}

/* Memory this process holds, kB; 0 where /proc does not tell. */
static long resident_kb(void)
{
    char line[128], *second = line; /* total and resident pages, and more */
    long resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file != NULL) {
        if (fgets(line, sizeof line, file) != NULL) {
            (void)strtol(line, &second, 10);
            resident = strtol(second, NULL, 10);
        }
        fclose(file);
    }
    return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int run(const struct options *options, struct batch_item *items, struct tally *tally)
{
    const double start = now_s();
    uint64_t seed = 2;
    long settled_kb = 0;
    *tally = (struct tally){.digest = DIGEST_START};
    for (int round = 0; (double)tally->strides < options->strides; round++) {
        if (!walk_round(options, items, &seed, tally)) {
            return EXIT_ILL;
        }
        settled_kb = round < SETTLED_ROUNDS ? resident_kb() : settled_kb;
        if (isatty(STDERR_FILENO)) {
            fprintf(stderr, "\r%.3g of %g strides", (double)tally->strides, options->strides);
        }
    }
    const long end_kb = resident_kb();
    const double took = now_s() - start;
    printf(
        "%s, %d threads: %llu strides, %llu falls, digest %016llx, %.0f a second, %ld kB grown by %ld\n",
        batch_lanes_name(), options->threads, (unsigned long long)tally->strides,
        (unsigned long long)tally->falls, (unsigned long long)tally->digest,
        (double)tally->strides / took, end_kb, end_kb - settled_kb);
    return end_kb - settled_kb <= GROWTH_MOST_KB && fflush(stdout) == 0 && !ferror(stdout)
               ? EXIT_WELL
               : EXIT_ILL;
}

int main(int argc, char **argv)
{
    const struct argp parser = {
        table, parse, NULL, "Walks many strides on the batch engine and tells a digest of all.",
        NULL,  NULL,  NULL};
    struct options options = {1e6, MOST_WALKERS, 0, 0};
    argp_program_version = version_text();
    argp_err_exit_status = EXIT_USAGE;
    argp_parse(&parser, argc, argv, 0, NULL, &options);
    if (batch_use_lanes(options.lanes) != BATCH_OK) {
        fputs("afo-strides: --lanes must be 2, 4 or 8, and this processor must have them\n",
              stderr);
        return EXIT_USAGE;
    }
    struct batch_item *items = calloc(MOST_WALKERS, sizeof *items);
    struct tally *tally = calloc(1, sizeof *tally);
    const int status = items == NULL || tally == NULL ? EXIT_ILL : run(&options, items, tally);
    free(items);
    free(tally);
    return status;
}
