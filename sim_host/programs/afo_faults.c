/* afo-faults: injects faults into steady walks and judges what the plant did. */
#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim_host/cli/output_file.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/faults/campaign.h"
#include "sim_host/faults/summary.h"

enum { EXIT_SAFE = 0, EXIT_UNSAFE = 1, EXIT_USAGE = 2, PATH_BYTES = 1024, JOBS_MAX = 64 };

enum {
    KEY_RUNS = 0x500,
    KEY_JOBS,
    KEY_SEED,
    KEY_OUT,
    KEY_RUN,
    KEY_LOG,
    KEY_TICKS,
    KEY_MARKDOWN,
    KEY_ONLY
};

struct options {
    uint32_t runs, jobs, run;
    uint64_t seed;
    bool single, markdown;
    const char *out, *log, *ticks, *only;
};

static const struct argp_option option_list[] = {
    {"runs", KEY_RUNS, "N", 0, "how many runs (default 500)", 0},
    {"jobs", KEY_JOBS, "N", 0, "processes (default 1)", 0},
    {"seed", KEY_SEED, "N", 0, "which campaign (default 1)", 0},
    {"out", KEY_OUT, "DIR", 0, "keep results there; runs that are there are not made again", 0},
    {"only", KEY_ONLY, "TEXT", 0,
     "of those N only the runs whose first fault's name contains TEXT, such as \"foreign\"", 0},
    {"markdown", KEY_MARKDOWN, 0, 0, "the table as Markdown", 0},
    {"run", KEY_RUN, "I", 0, "run number I alone, and tell", 1},
    {"log", KEY_LOG, "FILE", 0, "with --run: every frame, as candump -L writes it", 1},
    {"csv", KEY_TICKS, "FILE", 0, "with --run: one line per tick (scripts/plot-fault draws it)", 1},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case KEY_RUNS:
        options->runs = (uint32_t)option_whole(state, "--runs", text, 1, 100000000);
        break;
    case KEY_JOBS:
        options->jobs = (uint32_t)option_whole(state, "--jobs", text, 1, JOBS_MAX);
        break;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        break;
    case KEY_OUT:
        options->out = text;
        break;
    case KEY_ONLY:
        options->only = text;
        break;
    case KEY_MARKDOWN:
        options->markdown = true;
        break;
    case KEY_RUN:
        options->run = (uint32_t)option_whole(state, "--run", text, 0, UINT32_MAX - 1);
        options->single = true;
        break;
    case KEY_LOG:
        options->log = text;
        break;
    case KEY_TICKS:
        options->ticks = text;
        break;
    case ARGP_KEY_ARG:
        argp_error(state, "unexpected argument \"%s\"", text);
        break;
    case ARGP_KEY_END:
        if (!options->single && (options->log != NULL || options->ticks != NULL)) {
            argp_error(state, "--log and --csv need --run I");
        }
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

/* ---- one run alone ------------------------------------------------------------------- */

enum { MESSAGE_BYTES = OUTPUT_PATH_MAX + 256 };

/* With no path: a file that is not open. */
static bool open_output(struct output_file *file, const char *path)
{
    char message[MESSAGE_BYTES];
    *file = (struct output_file){0};
    if (path != NULL && output_file_open(file, path, message, sizeof message) != 0) {
        fprintf(stderr, "afo-faults: %s\n", message);
        return false;
    }
    return true;
}

static bool commit_output(struct output_file *file)
{
    char message[MESSAGE_BYTES];
    if (file->stream != NULL && output_file_commit(file, message, sizeof message) != 0) {
        fprintf(stderr, "afo-faults: %s\n", message);
        return false;
    }
    return true;
}

static int run_alone(const struct options *options)
{
    struct campaign_plan plan;
    struct campaign_result result;
    struct output_file log, ticks;
    campaign_plan(options->seed, options->run, &plan);
    if (!open_output(&log, options->log)) {
        return EXIT_USAGE;
    }
    struct campaign *campaign = open_output(&ticks, options->ticks) ? campaign_create() : NULL;
    if (campaign == NULL) {
        output_file_discard(&log);
        output_file_discard(&ticks);
        return EXIT_USAGE;
    }
    campaign_run(campaign, &plan, log.stream, ticks.stream, &result);
    campaign_destroy(campaign);
    const bool log_kept = commit_output(&log), ticks_kept = commit_output(&ticks);
    summary_tell(stdout, &result);
    return !log_kept || !ticks_kept ? EXIT_USAGE : result.unsafe == 0 ? EXIT_SAFE : EXIT_UNSAFE;
}

/* ---- many ------------------------------------------------------------------------------ */

static void path_of(char *path, const char *directory, uint64_t seed, unsigned job)
{
    snprintf(path, PATH_BYTES, "%s/seed%llu-job%u.txt", directory, (unsigned long long)seed, job);
}

/* Takes what is in the directory, of any number of jobs, into results. */
static void read_results(const struct options *options, struct campaign_result *results, bool *done)
{
    char line[256];
    for (unsigned job = 0; job < JOBS_MAX; job++) {
        char path[PATH_BYTES];
        struct campaign_result result;
        path_of(path, options->out, options->seed, job);
        FILE *file = fopen(path, "r");
        while (file != NULL && fgets(line, sizeof line, file) != NULL) {
            if (campaign_read(line, options->seed, &result) && result.plan.index < options->runs) {
                results[result.plan.index] = result;
                done[result.plan.index] = true;
            }
        }
        if (file != NULL) {
            fclose(file);
        }
    }
}

/* Whether run i is asked for. */
static bool is_wanted(const struct options *options, uint32_t i)
{
    return options->only == NULL ||
           strstr(fault_kinds[i % FAULT_KINDS].name, options->only) != NULL;
}

static int work(const struct options *options, struct campaign *campaign, unsigned job,
                const bool *done)
{
    char path[PATH_BYTES];
    path_of(path, options->out, options->seed, job);
    FILE *file = fopen(path, "a");
    if (file == NULL) {
        fprintf(stderr, "afo-faults: %s: %s\n", path, strerror(errno));
        return EXIT_USAGE;
    }
    for (uint32_t i = job; i < options->runs; i += options->jobs) {
        struct campaign_plan plan;
        struct campaign_result result;
        if (done[i] || !is_wanted(options, i)) {
            continue;
        }
        campaign_plan(options->seed, i, &plan);
        campaign_run(campaign, &plan, NULL, NULL, &result);
        campaign_write(file, &result);
        if (fflush(file) != 0) {
            fprintf(stderr, "afo-faults: %s: %s\n", path, strerror(errno));
            return EXIT_USAGE;
        }
    }
    return fclose(file) == 0 ? EXIT_SAFE : EXIT_USAGE;
}

static bool all_done(const struct options *options, const bool *done)
{
    for (uint32_t i = 0; i < options->runs; i++) {
        if (!done[i] && is_wanted(options, i)) {
            return false;
        }
    }
    return true;
}

/* Children share the saved walks of the parent; a fork keeps their addresses. */
static int run_many(const struct options *options, const bool *done)
{
    if (all_done(options, done)) {
        return EXIT_SAFE;
    }
    struct campaign *campaign = campaign_create();
    if (campaign == NULL) {
        return EXIT_USAGE;
    }
    int worst = EXIT_SAFE;
    fflush(NULL);
    for (unsigned job = 0; job < options->jobs; job++) {
        const pid_t child = fork();
        if (child == 0) {
            _exit(work(options, campaign, job, done));
        }
        worst = child < 0 ? EXIT_USAGE : worst;
    }
    int status;
    while (wait(&status) > 0) {
        worst = status != 0 ? EXIT_USAGE : worst;
    }
    campaign_destroy(campaign);
    return worst;
}

/* Moves the results of the runs asked for to the front; how many they are. */
static uint32_t keep_wanted(const struct options *options, struct campaign_result *results)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < options->runs; i++) {
        if (is_wanted(options, i)) {
            results[count++] = results[i];
        }
    }
    return count;
}

static int run_campaign(struct options *options)
{
    char scratch[] = "/tmp/afo-faults-XXXXXX";
    const bool keeps = options->out != NULL;
    if (!keeps) {
        options->out = mkdtemp(scratch);
    } else if (mkdir(options->out, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "afo-faults: %s: %s\n", options->out, strerror(errno));
        return EXIT_USAGE;
    }
    struct campaign_result *results =
        (struct campaign_result *)calloc(options->runs, sizeof *results);
    bool *done = (bool *)calloc(options->runs, sizeof *done);
    if (results == NULL || done == NULL || options->out == NULL) {
        free(results);
        free(done);
        fputs("afo-faults: out of memory, or no temporary directory\n", stderr);
        return EXIT_USAGE;
    }
    read_results(options, results, done);
    int status = run_many(options, done);
    read_results(options, results, done);
    if (status == EXIT_SAFE && all_done(options, done)) {
        const uint32_t count = keep_wanted(options, results);
        const unsigned bad = summary_table(stdout, results, count, options->markdown);
        status = bad == 0 ? EXIT_SAFE : EXIT_UNSAFE;
    }
    for (unsigned job = 0; !keeps && job < options->jobs; job++) {
        char path[PATH_BYTES];
        path_of(path, options->out, options->seed, job);
        (void)unlink(path);
    }
    if (!keeps) {
        (void)rmdir(options->out);
    }
    free(results);
    free(done);
    return status;
}

int main(int argc, char **argv)
{
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Injects faults into steady walks of the simulated walker and judges by the plant what "
        "came of them.\v"
        "Exit status: 0 nothing unsafe or unnoticed, 1 something, 2 wrong usage.",
        0,
        0,
        0};
    struct options options = {.runs = 500, .jobs = 1, .seed = 1};
    option_identity("afo-faults");
    if (argp_parse(&parser, argc, argv, 0, NULL, &options) != 0) {
        return EXIT_USAGE;
    }
    const int status = options.single ? run_alone(&options) : run_campaign(&options);
    if (fflush(stdout) != 0 || ferror(stdout) != 0) {
        fputs("afo-faults: cannot write to standard output\n", stderr);
        return EXIT_USAGE;
    }
    return status;
}
