#include "sim_host/cli/sim_session.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "model/tick.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/program_output.h"
#include "sim_host/cli/progress.h"
#include "sim_host/cli/recording_options.h"
#include "sim_host/loop/walk_watch.h"

/* What the controller told about the last step may still wait for its turn on the bus. */
enum { LAST_FRAMES_TICKS = 3, RECORDED_STEPS_MAX = 1000000 };

/* A walker's legs swing by 40 degrees and more; radians read as degrees make that 0.7. */
#define LEAST_SPAN_RAD 0.05

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- preparing ------------------------------------------------------------- */

int sim_session_configure(struct sim_session *session)
{
    const struct sim_options *options = &session->options;
    char message[LOOP_MESSAGE_MAX] = "";

    if (sensing_options_configure(&options->sensing, &options->walk, &options->sensor,
                                  &session->config, message) != 0) {
        return program_complain("%s", message);
    }
    if (options->engage_steps > 0) {
        loop_configure_person(&session->config, options->engage_steps);
    }
    ground_options_apply(&options->ground, &session->config);
    session->config.fault = options->fault;
    session->config.fault_step = options->fault_step;
    session->config.fault_delay_ticks = TICKS_OF_MS(options->fault_delay_ms);
    for (int side = 0; side < SIDE_COUNT; side++) {
        session->config.plant.sea[side].release_latency_s += options->release_late_s;
    }
    if (recording_options_person(&options->recording)) {
        struct recording_options recording = options->recording;
        recording.open_loop = options->walk.open_loop;
        if (recording_options_apply(&recording, &session->config, message) != 0) {
            return program_complain("%s", message);
        }
    }
    return 0;
}

int sim_session_open(struct sim_session *session)
{
    const struct sim_options *options = &session->options;
    const bool recorded = recording_options_person(&options->recording);
    const uint32_t rows = recorded ? RECORDED_STEPS_MAX : options->steps + 2;
    const double origin_s =
        recorded ? (double)session->config.plant.recording_start_tick * session->config.plant.tick_s
                 : 0.0;
    char message[LOOP_MESSAGE_MAX] = "";

    session->loop = (struct loop *)malloc(sizeof *session->loop);
    if (session->loop == NULL || !walk_record_init(&session->record, rows, origin_s)) {
        free(session->loop); /* it is no loop yet */
        session->loop = NULL;
        return program_complain("out of memory");
    }
    if (program_open_output(&session->csv, options->csv_path) != 0 ||
        program_open_output(&session->ticks, options->ticks_path) != 0 ||
        program_open_output(&session->log, options->log_path) != 0 ||
        program_open_output(&session->pushes, options->pushes_path) != 0 ||
        loop_init(session->loop, &session->config, session->log.stream, message) != 0) {
        free(session->loop);
        session->loop = NULL;
        return message[0] != '\0' ? program_complain("%s", message) : -1;
    }
    if (options->recording.path != NULL) {
        const struct recording *recording = &session->loop->nodes.plant.recording;
        session->record.gait.origin_s -= recording->start_s; /* as the file counts */
        if (recording_span_rad(recording) < LEAST_SPAN_RAD) {
            program_complain("the recorded legs move by less than 3 degrees: are the angles in "
                             "radians (--angles rad)?");
        }
    }
    return 0;
}

void sim_session_free(struct sim_session *session)
{
    output_file_discard(&session->csv);
    output_file_discard(&session->ticks);
    output_file_discard(&session->pushes);
    output_file_discard(&session->log);
    walk_record_free(&session->record);
    if (session->loop != NULL) {
        loop_free(session->loop);
    }
    free(session->loop);
    session->loop = NULL;
}

/* ---- walking --------------------------------------------------------------- */

bool sim_session_output_failed(const struct sim_session *session)
{
    return (session->csv.stream != NULL && ferror(session->csv.stream)) ||
           (session->ticks.stream != NULL && ferror(session->ticks.stream)) ||
           (session->log.stream != NULL && ferror(session->log.stream));
}

/* Where a line a tick goes, or NULL. */
static FILE *tick_stream(const struct sim_session *session)
{
    return session->options.ticks ? session->csv.stream : session->ticks.stream;
}

static void tick(struct sim_session *session)
{
    FILE *stream = tick_stream(session);
    loop_tick(session->loop);
    const int event = walk_record_take(&session->record, session->loop);
    if (stream != NULL) {
        sim_tick_line(stream, session->loop, event, session->record.gait.origin_s);
    }
}

/* True when the walk is over; says why in session->outcome. */
static bool is_over(struct sim_session *session, struct walk_watch *watch)
{
    struct sim_outcome *outcome = &session->outcome;
    switch (walk_watch_tick(watch, &session->record, session->loop)) {
    case WALK_GOES_ON:
        return false;
    case WALK_FELL:
        outcome->fell = true;
        snprintf(outcome->fault, sizeof outcome->fault, "%s",
                 walk_fault_name(plant_fault(&session->loop->nodes.plant)));
        return true;
    case WALK_STALLED:
        snprintf(outcome->fault, sizeof outcome->fault,
                 watch->seen == 0 ? "no first step within %d s" : "no further step within %d s",
                 walk_watch_limit_s(watch));
        return true;
    default:
        return true;
    }
}

static void name_controller_fault(struct sim_session *session)
{
    const enum supervisor_fault fault = session->loop->rig.task.output.fault;
    if (fault == SUPERVISOR_FAULT_NONE) {
        return;
    }
    const size_t used = strlen(session->outcome.fault);
    snprintf(session->outcome.fault + used, sizeof session->outcome.fault - used,
             "%scontroller: %s", used > 0 ? "; " : "", supervisor_fault_name(fault));
}

void sim_session_walk(struct sim_session *session, const volatile sig_atomic_t *interrupted)
{
    struct progress progress;
    struct walk_watch watch;
    const double start_s = now_s();

    walk_watch_init(&watch, session->options.steps, session->options.recording.path != NULL);
    progress_begin(&progress, "steps",
                   session->options.steps != UINT32_MAX ? session->options.steps : 0,
                   session->options.quiet || session->options.json);
    if (tick_stream(session) != NULL) {
        sim_tick_header(tick_stream(session), session->loop);
    }
    if (session->options.real_time) {
        pacer_start(&session->pacer, UINT64_C(1000) * TICK_PERIOD_US);
    }
    do {
        if (session->options.real_time) {
            (void)pacer_wait(&session->pacer);
        }
        ground_options_tick(&session->options.ground, session->loop, &session->push_ticks);
        tick(session);
        if (session->record.count != watch.seen) {
            progress_tell(&progress, session->record.count);
        }
        if (*interrupted) {
            snprintf(session->outcome.fault, sizeof session->outcome.fault, "interrupted");
            break;
        }
        if (sim_session_output_failed(session)) { /* who completes it says which and why */
            snprintf(session->outcome.fault, sizeof session->outcome.fault,
                     "an output could not be written");
            break;
        }
    } while (!is_over(session, &watch));
    for (int i = 0; i < LAST_FRAMES_TICKS && session->outcome.fault[0] == '\0'; i++) {
        tick(session);
    }
    session->outcome.wall_s = now_s() - start_s;
    progress_end(&progress);
    name_controller_fault(session);
}
