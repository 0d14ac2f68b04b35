#include "sim_host/faults/work.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/progress.h"

enum { PATH_BYTES = 1024, LINE_BYTES = 512, WAIT_US = 20000 };

static void path_of(char *path, const struct work *work, unsigned job)
{
    snprintf(path, PATH_BYTES, "%s/%s-job%u.txt", work->out, work->prefix, job);
}

/* Takes what is in the folder, of any number of processes. */
static void take_lines(const struct work *work, bool *done)
{
    char line[LINE_BYTES];
    for (unsigned job = 0; job < WORK_JOBS_MAX; job++) {
        char path[PATH_BYTES];
        uint32_t index;
        path_of(path, work, job);
        FILE *file = fopen(path, "r");
        while (file != NULL && fgets(line, sizeof line, file) != NULL) {
            if (work->take(work->context, line, &index) && index < work->runs) {
                done[index] = true;
            }
        }
        if (file != NULL) {
            fclose(file);
        }
    }
}

static uint32_t count_missing(const struct work *work, const bool *done)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < work->runs; i++) {
        count += !done[i] && work->wants(work->context, i) ? 1 : 0;
    }
    return count;
}

static int work_alone(const struct work *work, unsigned job, const bool *done,
                      atomic_uint *finished)
{
    char path[PATH_BYTES];
    path_of(path, work, job);
    FILE *file = fopen(path, "a");
    if (file == NULL) {
        program_complain("%s: %s", path, strerror(errno));
        return EXIT_USAGE;
    }
    for (uint32_t i = 0; i < work->runs; i++) {
        if (done[i] || i / work->chunk % work->jobs != job || !work->wants(work->context, i)) {
            continue;
        }
        work->make(work->context, i, file);
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

/* Children share what begin() has prepared; a fork keeps its addresses. */
static int work_together(const struct work *work, const bool *done)
{
    const uint32_t missing = count_missing(work, done);
    if (missing == 0) {
        return EXIT_GOOD;
    }
    atomic_uint *finished = (atomic_uint *)mmap(NULL, sizeof *finished, PROT_READ | PROT_WRITE,
                                                MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (finished == MAP_FAILED || !work->begin(work->context)) {
        return EXIT_USAGE;
    }
    program_announce((double)missing * work->run_s / (double)work->jobs, "%u runs by %u processes",
                     missing, work->jobs);
    int worst = EXIT_GOOD;
    fflush(NULL);
    for (unsigned job = 0; job < work->jobs; job++) {
        const pid_t child = fork();
        if (child == 0) {
            _exit(work_alone(work, job, done, finished));
        }
        worst = child < 0 ? EXIT_USAGE : worst;
    }
    const int ended = await_children(finished, missing);
    (void)munmap(finished, sizeof *finished);
    return worst != EXIT_GOOD ? worst : ended;
}

int work_do(struct work *work)
{
    char scratch[] = "/tmp/afo-faults-XXXXXX";
    const bool keeps = work->out != NULL;
    if (!keeps) {
        work->out = mkdtemp(scratch);
    } else if (mkdir(work->out, 0777) != 0 && errno != EEXIST) {
        program_complain("%s: %s", work->out, strerror(errno));
        return EXIT_USAGE;
    }
    bool *done = (bool *)calloc(work->runs, sizeof *done);
    if (done == NULL || work->out == NULL) {
        free(done);
        program_complain("out of memory, or no temporary directory");
        return EXIT_USAGE;
    }
    take_lines(work, done);
    int status = work_together(work, done);
    take_lines(work, done);
    if (status == EXIT_GOOD && count_missing(work, done) > 0) {
        status = EXIT_USAGE;
    }
    for (unsigned job = 0; !keeps && job < work->jobs; job++) {
        char path[PATH_BYTES];
        path_of(path, work, job);
        (void)unlink(path);
    }
    if (!keeps) {
        (void)rmdir(work->out);
    }
    free(done);
    return status;
}
