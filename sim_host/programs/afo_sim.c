/* afo-sim: the walker walks, or falls, because of the frames on the bus. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "sim_host/cli/output_file.h"
#include "sim_host/cli/recording_options.h"
#include "sim_host/cli/sim_options.h"
#include "sim_host/cli/sim_report.h"
#include "sim_host/loop/pacer.h"
#include "sim_host/loop/walk_record.h"

enum { EXIT_WALKED = 0, EXIT_FELL = 1, EXIT_USAGE = 2 };

/* After the last apex asked for, the controller's record of it is still to come. */
enum {
    RECORD_DELAY_TICKS = TICKS_OF_MS(150),
    FIRST_STEP_TICKS = TICKS_OF_MS(20000),
    STEP_TICKS = TICKS_OF_MS(10000),
    LAST_FRAMES_TICKS = 3
};

/* A walker's legs swing by 40 degrees and more; radians read as degrees make that 0.7. */
#define LEAST_SPAN_RAD 0.05

static volatile sig_atomic_t interrupted;

static void on_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

struct session {
    struct sim_options options;
    struct loop_config config;
    struct loop *loop;
    struct walk_record record;
    struct output_file csv, log;
    struct sim_outcome outcome;
    struct pacer pacer;
    bool pushed;
};

static void complain(const char *message)
{
    fprintf(stderr, "afo-sim: %s\n", message);
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- preparing ------------------------------------------------------------- */

static int prepare(struct session *session)
{
    const struct sim_options *options = &session->options;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    char message[LOOP_MESSAGE_MAX] = "";

    if (walk_options_resolve(&options->walk, &subject, &params, &speed_rad_s, message) != 0 ||
        loop_configure(&session->config, &subject, &params, speed_rad_s, options->sensors,
                       options->seed, message) != 0) {
        complain(message);
        return -1;
    }
    sensor_options_apply(&options->sensor, &session->config);
    if (options->engage_steps > 0) {
        loop_configure_recording(&session->config, options->engage_steps);
    }
    ground_options_apply(&options->ground, &session->config);
    session->config.fault = options->fault;
    session->config.fault_step = options->fault_step;
    if (options->recording_path != NULL &&
        recording_options_apply(options->recording_path, &options->recording_format,
                                options->walk.open_loop, &session->config, message) != 0) {
        complain(message);
        return -1;
    }
    return 0;
}

static int open_outputs(struct session *session)
{
    char message[OUTPUT_PATH_MAX + 256];
    if (session->options.csv_path != NULL &&
        output_file_open(&session->csv, session->options.csv_path, message, sizeof message) != 0) {
        complain(message);
        return -1;
    }
    if (session->options.log_path != NULL &&
        output_file_open(&session->log, session->options.log_path, message, sizeof message) != 0) {
        complain(message);
        return -1;
    }
    return 0;
}

/* ---- walking --------------------------------------------------------------- */

static void show_progress(const struct session *session, bool last)
{
    const struct walk_record *record = &session->record;
    if (record->count == 0) {
        return;
    }
    fprintf(stderr, "\r  step %u", record->count);
    if (session->options.steps != UINT32_MAX) {
        fprintf(stderr, " of %u", session->options.steps);
    }
    fprintf(stderr, ", %.4f rad/s ", record->rows[record->count - 1].apex_speed_rad_s);
    if (last) {
        fputs("\r                                                  \r", stderr);
    }
    fflush(stderr);
}

static void judge_fall(struct session *session, enum walk_fault fault)
{
    session->outcome.fell = true;
    snprintf(session->outcome.fault, sizeof session->outcome.fault, "%s", walk_fault_name(fault));
}

/* True when the walk is over; says why in session->outcome. */
static bool is_over(struct session *session, uint64_t last_progress_tick)
{
    const struct loop *loop = session->loop;
    const struct walk_record *record = &session->record;
    const enum walk_fault fault = plant_fault(&loop->nodes.plant);
    if (fault != WALK_FAULT_NONE) {
        judge_fall(session, fault);
        return true;
    }
    if (record->count >= session->options.steps &&
        (record->rows[session->options.steps - 1].measured ||
         loop->tick - last_progress_tick > RECORD_DELAY_TICKS)) {
        return true;
    }
    if (session->options.recording_path != NULL) { /* may stand still as long as they like */
        struct plant_truth truth;
        plant_truth(&loop->nodes.plant, &truth);
        return truth.finished;
    }
    const uint64_t patience = record->count == 0 ? FIRST_STEP_TICKS : STEP_TICKS;
    if (loop->tick - last_progress_tick > patience) {
        snprintf(session->outcome.fault, sizeof session->outcome.fault,
                 record->count == 0 ? "no first step within %d s" : "no further step within %d s",
                 (int)((uint64_t)patience * TICK_PERIOD_US / 1000000u));
        return true;
    }
    return false;
}

static bool output_failed(const struct session *session)
{
    return (session->csv.stream != NULL && ferror(session->csv.stream)) ||
           (session->log.stream != NULL && ferror(session->log.stream));
}

/* What the controller told about the last step may still wait for its turn on the bus. */
static void let_last_frames_out(struct session *session)
{
    for (int i = 0; i < LAST_FRAMES_TICKS; i++) {
        loop_tick(session->loop);
        const int event = walk_record_take(&session->record, session->loop);
        if (session->options.ticks) {
            sim_tick_line(session->csv.stream, session->loop, event);
        }
    }
}

static void walk(struct session *session)
{
    struct loop *loop = session->loop;
    const bool progress =
        !session->options.quiet && !session->options.json && isatty(STDERR_FILENO);
    uint64_t last_progress_tick = 0;
    uint32_t seen = 0;
    const double start_s = now_s();

    if (session->options.real_time) {
        pacer_start(&session->pacer, 1000000);
    }
    do {
        if (session->options.real_time) {
            (void)pacer_wait(&session->pacer);
        }
        ground_options_tick(&session->options.ground, loop, &session->pushed);
        loop_tick(loop);
        const int event = walk_record_take(&session->record, loop);
        if (session->options.ticks) {
            sim_tick_line(session->csv.stream, loop, event);
        }
        if (session->record.count != seen) {
            seen = session->record.count;
            last_progress_tick = loop->tick;
            if (progress && seen % 10 == 0) {
                show_progress(session, false);
            }
        }
        if (interrupted) {
            snprintf(session->outcome.fault, sizeof session->outcome.fault, "interrupted");
            break;
        }
        if (output_failed(session)) { /* finish() says which and why */
            snprintf(session->outcome.fault, sizeof session->outcome.fault,
                     "an output could not be written");
            break;
        }
    } while (!is_over(session, last_progress_tick));
    if (session->outcome.fault[0] == '\0') {
        let_last_frames_out(session);
    }
    session->outcome.wall_s = now_s() - start_s;
    if (progress) {
        show_progress(session, true);
    }
}

static void name_controller_fault(struct session *session)
{
    const enum supervisor_fault fault = session->loop->rig.task.output.fault;
    if (fault == SUPERVISOR_FAULT_NONE) {
        return;
    }
    const size_t used = strlen(session->outcome.fault);
    snprintf(session->outcome.fault + used, sizeof session->outcome.fault - used,
             "%scontroller: %s", used > 0 ? "; " : "", supervisor_fault_name(fault));
}

/* ---- reporting ------------------------------------------------------------- */

/* A walk that cannot be written leaves no file that looks like a whole one. The file
 * that cannot be written itself is left to its commit, which knows the reason. */
static void discard_unfinished(struct output_file *file)
{
    if (file->stream == NULL || ferror(file->stream)) {
        return;
    }
    fprintf(stderr, "afo-sim: the walk was broken off, %s is not written\n", file->path);
    output_file_discard(file);
}

/* A whole walk's file takes its place; what an interrupted one has come to lies beside it.
 * Returns 0, or -1 with a complaint. */
static int complete_output(const struct session *session, struct output_file *file)
{
    char message[OUTPUT_PATH_MAX + 256];
    const bool part = interrupted && !output_failed(session) && !file->direct;
    if (file->stream == NULL) {
        return 0;
    }
    const int status = part ? output_file_keep_part(file, message, sizeof message)
                            : output_file_commit(file, message, sizeof message);
    if (status != 0) {
        complain(message);
        return -1;
    }
    if (part) {
        fprintf(stderr, "afo-sim: the walk was broken off: its %u steps are in %s.part\n",
                session->record.count, file->path);
    }
    return 0;
}

/* A disturbance that was asked for and never came must not pass for one that was survived. */
static int complain_of_what_never_came(const struct session *session, int status)
{
    const struct sim_options *options = &session->options;
    if (status != EXIT_WALKED) {
        return status;
    }
    if (options->ground.push_Ns != 0.0 && !session->pushed) {
        complain("--push did not happen: the walk ended before its time");
        status = EXIT_USAGE;
    }
    if (options->fault != LOOP_FAULT_NONE && !session->loop->fault_active) {
        complain("--fault did not happen: the walk ended before --fault-step");
        status = EXIT_USAGE;
    }
    return status;
}

static int finish(struct session *session)
{
    const struct sim_options *options = &session->options;
    int status =
        session->outcome.fell || session->outcome.fault[0] != '\0' ? EXIT_FELL : EXIT_WALKED;

    if (output_failed(session)) {
        discard_unfinished(&session->csv);
        discard_unfinished(&session->log);
    }
    if (session->csv.stream != NULL && !options->ticks) {
        sim_report_csv(session->csv.stream, &session->record, session->config.desired_speed_rad_s);
    }
    const int csv = complete_output(session, &session->csv);
    const int log = complete_output(session, &session->log); /* whatever became of the other */
    if (csv != 0 || log != 0) {
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
    if (fflush(stdout) != 0 || ferror(stdout)) {
        complain("cannot write to standard output");
        status = EXIT_USAGE;
    }
    return complain_of_what_never_came(session, status);
}

static int run(struct session *session)
{
    char message[LOOP_MESSAGE_MAX] = "";
    if (prepare(session) != 0) {
        return EXIT_USAGE;
    }
    session->loop = (struct loop *)malloc(sizeof *session->loop);
    const uint32_t rows =
        session->options.recording_path != NULL ? 1000000 : session->options.steps + 2;
    const double origin_s =
        session->options.recording_path != NULL
            ? (double)session->config.plant.recording_start_tick * session->config.plant.tick_s
            : 0.0;
    if (session->loop == NULL || !walk_record_init(&session->record, rows, origin_s)) {
        complain("out of memory");
        return EXIT_USAGE;
    }
    if (open_outputs(session) != 0) {
        return EXIT_USAGE;
    }
    if (loop_init(session->loop, &session->config, session->log.stream, message) != 0) {
        complain(message);
        return EXIT_USAGE;
    }
    if (session->options.recording_path != NULL) {
        const struct recording *recording = &session->loop->nodes.plant.recording;
        session->record.gait.origin_s -= recording->start_s; /* as the file counts */
        if (recording_span_rad(recording) < LEAST_SPAN_RAD) {
            complain("the recorded legs move by less than 3 degrees: are the angles in radians "
                     "(--angles rad)?");
        }
    }
    if (session->options.ticks) {
        sim_tick_header(session->csv.stream);
    }
    walk(session);
    name_controller_fault(session);
    const int status = finish(session);
    loop_free(session->loop);
    return status;
}

int main(int argc, char **argv)
{
    static struct session session;
    signal(SIGINT, on_interrupt);
    signal(SIGTERM, on_interrupt);
    signal(SIGHUP, on_interrupt);
    signal(SIGPIPE, SIG_IGN); /* a reader that went away is a write error like others */
    sim_options_parse(&session.options, argc, argv);
    const int status = run(&session);
    output_file_discard(&session.csv);
    output_file_discard(&session.log);
    walk_record_free(&session.record);
    free(session.loop);
    return status;
}
