/* afo sim: the walker walks, or falls, because of the frames on the bus. */
#include <signal.h>
#include <stdio.h>

#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/experiment.h"
#include "sim_host/cli/person_fit.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/push_report.h"
#include "sim_host/cli/sim_experiment.h"
#include "sim_host/cli/sim_session.h"
#include "sim_host/programs/commands.h"

enum { MESSAGE_MAX = OUTPUT_PATH_MAX + 256 };

static volatile sig_atomic_t interrupted;

static void on_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

/* A walk that cannot be written leaves no file that looks like a whole one. The file
 * that cannot be written itself is left to its commit, which knows the reason. */
static void discard_unfinished(struct output_file *file)
{
    if (file->stream == NULL || ferror(file->stream)) {
        return;
    }
    program_complain("the walk was broken off, %s is not written", file->path);
    output_file_discard(file);
}

/* A whole walk's file takes its place; what an interrupted one has come to lies beside it.
 * Returns 0, or -1 with a complaint. */
static int complete_output(const struct sim_session *session, struct output_file *file)
{
    char message[MESSAGE_MAX];
    const bool part = interrupted && !sim_session_output_failed(session) && !file->direct;
    if (file->stream == NULL) {
        return 0;
    }
    const int status = part ? output_file_keep_part(file, message, sizeof message)
                            : output_file_commit(file, message, sizeof message);
    if (status != 0) {
        return program_complain("%s", message);
    }
    if (part) {
        program_complain("the walk was broken off: its %u steps are in %s.part",
                         session->record.count, file->path);
    }
    return 0;
}

static void tell_experiment(struct json_writer *json, const void *context)
{
    const struct sim_session *session = (const struct sim_session *)context;
    sim_experiment_json(json, &session->options, &session->config);
}

/* The table, and behind it the file that says what it is a table of. */
static int complete_table(struct sim_session *session, struct output_file *table)
{
    char message[MESSAGE_MAX];
    if (table->stream == NULL) {
        return 0;
    }
    if (complete_output(session, table) != 0) {
        return -1;
    }
    if (interrupted) {
        return 0;
    }
    return experiment_write(table, session->options.argc, session->options.argv, tell_experiment,
                            session, message, sizeof message) == 0
               ? 0
               : program_complain("%s", message);
}

/* What a fitting run has learned. */
static int write_fit(const struct sim_session *session)
{
    const char *path = session->options.recording.fit_path;
    char message[MESSAGE_MAX];
    struct person_fit fit;
    struct output_file file = {0};
    if (path == NULL || interrupted) {
        return 0;
    }
    if (!person_fit_make(&session->record.gait, &session->config.params, &fit)) {
        return program_complain("nothing was fitted: %u edges of a foot's switch belong to found "
                                "events, %d are needed, and no bias may be above 80 ms",
                                fit.edges, PERSON_FIT_LEAST);
    }
    if (output_file_open(&file, path, message, sizeof message) != 0) {
        return program_complain("%s", message);
    }
    person_fit_write(file.stream, &fit, &session->config.subject.person);
    return output_file_commit(&file, message, sizeof message) == 0
               ? 0
               : program_complain("%s", message);
}

/* A disturbance that was asked for and never came must not pass for one that was survived. */
static int complain_of_what_never_came(const struct sim_session *session, int status)
{
    const struct sim_options *options = &session->options;
    if (status != EXIT_GOOD) {
        return status;
    }
    if (options->ground.push_Ns != 0.0 && session->push_ticks == 0) {
        program_complain("--push did not happen: the walk ended before its time");
        status = EXIT_USAGE;
    }
    if (options->fault != LOOP_FAULT_NONE && !session->loop->fault_active) {
        program_complain("--fault did not happen: the walk ended before --fault-step");
        status = EXIT_USAGE;
    }
    return status;
}

static int finish(struct sim_session *session)
{
    const struct sim_options *options = &session->options;
    int status = session->outcome.fell || session->outcome.fault[0] != '\0' ? EXIT_BAD : EXIT_GOOD;

    if (sim_session_output_failed(session)) {
        discard_unfinished(&session->csv);
        discard_unfinished(&session->ticks);
        discard_unfinished(&session->log);
    }
    if (session->csv.stream != NULL && !options->ticks) {
        sim_report_csv(session->csv.stream, &session->record, session->config.desired_speed_rad_s);
    }
    if (session->pushes.stream != NULL) {
        push_report_csv(session->pushes.stream, &session->record.push, session->loop);
    }
    const int csv = complete_table(session, &session->csv);
    const int ticks = complete_table(session, &session->ticks);
    const int log = complete_output(session, &session->log); /* whatever became of the other */
    const int pushes = complete_table(session, &session->pushes);
    const int fit = write_fit(session);
    if (csv != 0 || ticks != 0 || log != 0 || pushes != 0 || fit != 0) {
        status = EXIT_USAGE;
    }
    if (options->json) {
        sim_report_json(stdout, options, session->loop, &session->record, &session->outcome);
    } else if (!options->quiet) {
        sim_report_text(stdout, options, session->loop, &session->record, &session->outcome);
    }
    if (options->real_time && !options->quiet) {
        pacer_report(&session->pacer, options->json ? stderr : stdout);
    }
    if (program_output_done() != 0) {
        status = EXIT_USAGE;
    }
    return complain_of_what_never_came(session, status);
}

int afo_sim(int argc, char **argv)
{
    static struct sim_session session;
    int status = EXIT_USAGE;
    signal(SIGINT, on_interrupt);
    signal(SIGTERM, on_interrupt);
    signal(SIGHUP, on_interrupt);
    signal(SIGPIPE, SIG_IGN); /* a reader that went away is a write error like others */
    sim_options_parse(&session.options, argc, argv);
    if (sim_session_configure(&session) == 0 && sim_session_open(&session) == 0) {
        sim_session_walk(&session, &interrupted);
        status = finish(&session);
    }
    sim_session_free(&session);
    return status;
}
