/* afo faults: injects faults into steady walks and judges what the plant did. */
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/experiment.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/progress.h"
#include "sim_host/faults/campaign.h"
#include "sim_host/faults/fault_options.h"
#include "sim_host/faults/summary.h"
#include "sim_host/programs/commands.h"

enum { PATH_BYTES = 1024, WAIT_US = 20000 };

/* Of one processor, about. */
#define RUN_S 0.022

/* ---- one run alone ------------------------------------------------------------------- */

enum { MESSAGE_BYTES = OUTPUT_PATH_MAX + 256 };

/* With no path: a file that is not open. */
static bool open_output(struct output_file *file, const char *path)
{
    char message[MESSAGE_BYTES];
    *file = (struct output_file){0};
    if (path != NULL && output_file_open(file, path, message, sizeof message) != 0) {
        program_complain("%s", message);
        return false;
    }
    return true;
}

static bool commit_output(struct output_file *file)
{
    char message[MESSAGE_BYTES];
    if (file->stream != NULL && output_file_commit(file, message, sizeof message) != 0) {
        program_complain("%s", message);
        return false;
    }
    return true;
}

/* What the table of --csv is a table of. */
static int write_experiment(const struct fault_options *options, const struct campaign_plan *plan,
                            const struct output_file *table)
{
    struct experiment experiment;
    char message[MESSAGE_BYTES];
    if (options->ticks == NULL) {
        return 0;
    }
    if (experiment_begin(&experiment, table, options->argc, options->argv, message,
                         sizeof message) != 0) {
        return program_complain("%s", message);
    }
    if (experiment.file.stream != NULL) {
        struct json_writer *json = &experiment.json;
        json_text(json, "who",
                  options->walker.person_path != NULL ? options->walker.person_path
                                                      : "the paper's walker");
        json_unsigned(json, "seed", options->seed);
        json_unsigned(json, "run", plan->index);
        json_text(json, "scene", campaign_scene_name(plan->scene));
        json_open_list(json, "faults");
        for (unsigned i = 0; i < plan->count; i++) {
            const struct fault_shot *shot = &plan->shot[i];
            json_open_object(json, NULL);
            json_text(json, "name", fault_kinds[shot->kind].name);
            json_unsigned(json, "node", shot->node);
            json_unsigned(json, "start_tick", shot->start_tick);
            json_unsigned(json, "duration_ticks", shot->duration_ticks);
            json_number(json, "magnitude", shot->magnitude, 9);
            json_text(json, "unit", fault_kinds[shot->kind].unit);
            json_close_object(json);
        }
        json_close_list(json);
    }
    return experiment_commit(&experiment, message, sizeof message) == 0
               ? 0
               : program_complain("%s", message);
}

static int run_alone(const struct fault_options *options)
{
    struct campaign_plan plan;
    struct campaign_result result;
    struct output_file log, ticks;
    campaign_plan(options->seed, options->run, &plan);
    if (!open_output(&log, options->log)) {
        return EXIT_USAGE;
    }
    struct campaign *campaign =
        open_output(&ticks, options->ticks) ? campaign_create(&options->walker) : NULL;
    if (campaign == NULL) {
        output_file_discard(&log);
        output_file_discard(&ticks);
        return EXIT_USAGE;
    }
    campaign_run(campaign, &plan, log.stream, ticks.stream, &result);
    campaign_destroy(campaign);
    const bool log_kept = commit_output(&log);
    const bool ticks_kept = commit_output(&ticks) && write_experiment(options, &plan, &ticks) == 0;
    summary_tell(stdout, &result);
    return !log_kept || !ticks_kept ? EXIT_USAGE : result.unsafe == 0 ? EXIT_GOOD : EXIT_BAD;
}

/* ---- many ------------------------------------------------------------------------------ */

static void path_of(char *path, const char *directory, uint64_t seed, unsigned job)
{
    snprintf(path, PATH_BYTES, "%s/seed%llu-job%u.txt", directory, (unsigned long long)seed, job);
}

/* Takes what is in the directory, of any number of jobs, into results. */
static void read_results(const struct fault_options *options, struct campaign_result *results,
                         bool *done)
{
    char line[256];
    for (unsigned job = 0; job < FAULT_JOBS_MAX; job++) {
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
static bool is_wanted(const struct fault_options *options, uint32_t i)
{
    return fault_options_want(options, i % FAULT_KINDS);
}

static int work(const struct fault_options *options, struct campaign *campaign, unsigned job,
                const bool *done, atomic_uint *finished)
{
    char path[PATH_BYTES];
    path_of(path, options->out, options->seed, job);
    FILE *file = fopen(path, "a");
    if (file == NULL) {
        program_complain("%s: %s", path, strerror(errno));
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
            program_complain("%s: %s", path, strerror(errno));
            return EXIT_USAGE;
        }
        atomic_fetch_add(finished, 1u);
    }
    return fclose(file) == 0 ? EXIT_GOOD : EXIT_USAGE;
}

/* Tells how many runs the children have counted, until all of them have ended. */
static int await_children(atomic_uint *finished, uint32_t wanted)
{
    struct progress progress;
    int worst = EXIT_GOOD, status;
    pid_t child;
    progress_begin(&progress, "runs", wanted, false);
    while ((child = waitpid(-1, &status, WNOHANG)) >= 0) {
        if (child == 0) {
            progress_tell(&progress, atomic_load(finished));
            (void)usleep(WAIT_US);
        } else if (status != 0) {
            worst = EXIT_USAGE;
        }
    }
    progress_end(&progress);
    return worst;
}

static uint32_t count_missing(const struct fault_options *options, const bool *done)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < options->runs; i++) {
        count += !done[i] && is_wanted(options, i) ? 1 : 0;
    }
    return count;
}

/* Children share the saved walks of the parent; a fork keeps their addresses. */
static int run_many(const struct fault_options *options, const bool *done)
{
    const uint32_t missing = count_missing(options, done);
    if (missing == 0) {
        return EXIT_GOOD;
    }
    struct campaign *campaign = campaign_create(&options->walker);
    atomic_uint *finished = (atomic_uint *)mmap(NULL, sizeof *finished, PROT_READ | PROT_WRITE,
                                                MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (campaign == NULL || finished == MAP_FAILED) {
        campaign_destroy(campaign);
        return EXIT_USAGE;
    }
    program_announce((double)missing * RUN_S / (double)options->jobs, "%u runs by %u processes",
                     missing, options->jobs);
    int worst = EXIT_GOOD;
    fflush(NULL);
    for (unsigned job = 0; job < options->jobs; job++) {
        const pid_t child = fork();
        if (child == 0) {
            _exit(work(options, campaign, job, done, finished));
        }
        worst = child < 0 ? EXIT_USAGE : worst;
    }
    const int ended = await_children(finished, missing);
    (void)munmap(finished, sizeof *finished);
    campaign_destroy(campaign);
    return worst != EXIT_GOOD ? worst : ended;
}

/* Moves the results of the runs asked for to the front; how many they are. */
static uint32_t keep_wanted(const struct fault_options *options, struct campaign_result *results)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < options->runs; i++) {
        if (is_wanted(options, i)) {
            results[count++] = results[i];
        }
    }
    return count;
}

static int run_campaign(struct fault_options *options)
{
    char scratch[] = "/tmp/afo-faults-XXXXXX";
    const bool keeps = options->out != NULL;
    if (!keeps) {
        options->out = mkdtemp(scratch);
    } else if (mkdir(options->out, 0777) != 0 && errno != EEXIST) {
        program_complain("%s: %s", options->out, strerror(errno));
        return EXIT_USAGE;
    }
    struct campaign_result *results =
        (struct campaign_result *)calloc(options->runs, sizeof *results);
    bool *done = (bool *)calloc(options->runs, sizeof *done);
    if (results == NULL || done == NULL || options->out == NULL) {
        free(results);
        free(done);
        program_complain("out of memory, or no temporary directory");
        return EXIT_USAGE;
    }
    read_results(options, results, done);
    int status = run_many(options, done);
    read_results(options, results, done);
    if (status == EXIT_GOOD && count_missing(options, done) == 0) {
        const uint32_t count = keep_wanted(options, results);
        const unsigned bad = summary_table(stdout, results, count, options->markdown);
        status = bad == 0 ? EXIT_GOOD : EXIT_BAD;
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

int afo_faults(int argc, char **argv)
{
    struct fault_options options;
    fault_options_parse(&options, argc, argv);
    const int status = options.single ? run_alone(&options) : run_campaign(&options);
    return program_output_done() == 0 ? status : EXIT_USAGE;
}
