/* afo view: a walk in a browser. The walk is in this process, the page's server in one of its own, and between them
 * there is a socket only; so nothing that a browser does can disturb the walk. */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "firmware/version.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/sim_session.h"
#include "sim_host/cli/view_options.h"
#include "sim_host/loop/frame_stream.h"
#include "sim_host/programs/commands.h"
#include "sim_host/programs/python_tool.h"
#include "sim_host/programs/view_subject.h"

enum { ARGUMENTS_MAX = 32, SERVE_TICKS = TICKS_OF_MS(8), SOCKET_BYTES = 4 << 20 };
enum { SERVER_END_MS = 10000, END_PERIOD_MS = 20 };

struct view {
    struct view_options options;
    struct sim_session session;
    struct frame_stream stream;
    struct python_tool tool;
    char port[16], fd[16];
    char *subject; /* JSON, owned */
    pid_t server_pid;
    int server_status; /* its exit status, once it has ended by itself */
    bool told_gone;
};

/* ---- the server ---------------------------------------------------------------- */

static void become_server(const struct view *view)
{
    const struct view_options *options = &view->options;
    const char *given[][2] = {{"--afo", view->tool.program},
                              {"--subject", view->subject},
                              {"--fd", view->fd},
                              {"--can", options->interface},
                              {"--replay", options->replay_path},
                              {"--port", view->port},
                              {"--listen", options->listen},
                              {"--names", options->host_names},
                              {"--trials", options->trials_path}};
    const char *arguments[ARGUMENTS_MAX] = {NULL};
    int count = 2;
    for (size_t i = 0; i < sizeof given / sizeof given[0]; i++) {
        if (given[i][1] != NULL && given[i][1][0] != '\0') {
            arguments[count++] = given[i][0];
            arguments[count++] = given[i][1];
        }
    }
    arguments[count] = options->control ? "--control" : NULL;
    python_tool_become(&view->tool, arguments);
}

/* Starts the server in a process of its own. Returns this side of the socket, or -1 behind a complaint. */
static int start_server(struct view *view)
{
    int ends[2];
    const int bytes = SOCKET_BYTES;
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
        return program_complain("socketpair: %s", strerror(errno));
    }
    (void)setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    snprintf(view->fd, sizeof view->fd, "%d", ends[1]);
    fflush(stdout);
    view->server_pid = fork();
    if (view->server_pid == 0) {
        close(ends[0]);
        become_server(view);
        _exit(EXIT_USAGE);
    }
    close(ends[1]);
    return view->server_pid > 0 ? ends[0] : program_complain("fork: %s", strerror(errno));
}

/* ---- the walk ------------------------------------------------------------------- */

/* Nobody may read this program's complaints: a full pipe, or a terminal that is held, must not hold the walk. */
static bool may_complain(void)
{
    struct pollfd errors = {.fd = STDERR_FILENO, .events = POLLOUT};
    return poll(&errors, 1, 0) == 1 && (errors.revents & POLLOUT) != 0;
}

/* Returns whether to go on: not when the server never came, or ended of its own will. */
static bool look_after_server(struct view *view)
{
    int status = 0;
    if (view->told_gone || waitpid(view->server_pid, &status, WNOHANG) != view->server_pid) {
        return true;
    }
    view->told_gone = true;
    view->server_pid = 0;
    if (WIFEXITED(status)) {
        view->server_status = WEXITSTATUS(status);
        return false; /* it said why */
    }
    if (may_complain()) {
        program_complain("the page's server was killed (signal %d). The walk goes on without it, "
                         "Ctrl-C ends it",
                         WTERMSIG(status));
    }
    return true;
}

static int begin_walk(struct view *view)
{
    struct sim_session *session = &view->session;
    session->config.plant.start_hold.hold_after_fall = true;
    if (sim_session_open(session) != 0) {
        return -1;
    }
    return frame_stream_attach(&view->stream, session->loop)
               ? 0
               : program_complain("the bus has no port left for the view");
}

static int restart(struct view *view)
{
    struct sim_session *session = &view->session;
    if (session->options.log_path != NULL) {
        view->stream.wants_restart = false;
        if (may_complain()) {
            program_complain("--log holds one walk: it is not begun anew");
        }
        return 0;
    }
    sim_session_free(session);
    return begin_walk(view);
}

static bool tick(struct view *view, struct pacer *pacer, uint32_t *push_ticks)
{
    struct sim_session *session = &view->session;
    (void)pacer_wait(pacer);
    control_task_show_missed(&session->loop->rig.task,
                             pacer->missed < UINT32_MAX ? (uint32_t)pacer->missed : UINT32_MAX);
    ground_options_tick(&session->options.ground, session->loop, push_ticks);
    loop_tick(session->loop);
    (void)walk_record_take(&session->record, session->loop);
    if (session->loop->tick % SERVE_TICKS == 0) {
        frame_stream_serve(&view->stream);
        if (!look_after_server(view)) {
            return false;
        }
    }
    return session->record.count < session->options.steps && !sim_session_output_failed(session);
}

static int walk(struct view *view)
{
    struct pacer pacer;
    uint32_t push_ticks = 0;
    bool on = true;
    pacer_start(&pacer, UINT64_C(1000) * TICK_PERIOD_US);
    while (on && !bus_program_is_to_end()) {
        on = tick(view, &pacer, &push_ticks);
        if (on && view->stream.wants_restart) {
            push_ticks = 0;
            on = restart(view) == 0;
        }
    }
    frame_stream_serve(&view->stream);
    return EXIT_GOOD;
}

static int complete_log(struct sim_session *session)
{
    char message[OUTPUT_PATH_MAX + 256];
    return session->log.stream == NULL ||
                   output_file_commit(&session->log, message, sizeof message) == 0
               ? 0
               : program_complain("%s", message);
}

static int end_server(struct view *view, int fd)
{
    int status = 0;
    close(fd); /* the end of its input ends it */
    pid_t ended = 0;
    for (int i = 0; view->server_pid > 0 && ended == 0 && i < SERVER_END_MS / END_PERIOD_MS; i++) {
        ended = waitpid(view->server_pid, &status, WNOHANG);
        if (ended == 0) {
            (void)usleep(1000 * END_PERIOD_MS);
        }
    }
    if (view->server_pid > 0 && ended == 0) {
        if (may_complain()) {
            program_complain("the page's server does not end: it is killed");
        }
        kill(view->server_pid, SIGKILL);
        (void)waitpid(view->server_pid, &status, 0);
    } else if (ended > 0 && WIFEXITED(status)) {
        view->server_status = WEXITSTATUS(status);
    }
    return view->server_status;
}

static int view_walk(struct view *view)
{
    struct sim_session *session = &view->session;
    session->options = view->options.sim;
    int status = EXIT_USAGE;
    if (sim_session_configure(session) != 0) {
        return status;
    }
    if (view->options.in_stand) {
        session->config.standby = true;
        session->config.plant.start_hold.release_tick = UINT64_MAX / 2;
    }
    view->subject = view_subject_json(&session->config.subject, &session->config.params,
                                      session->config.desired_speed_rad_s, &view->options);
    const int fd = view->subject != NULL ? start_server(view) : program_complain("out of memory");
    if (fd < 0) {
        return status;
    }
    frame_stream_init(&view->stream, fd);
    if (begin_walk(view) == 0) {
        status = walk(view);
        status = complete_log(session) == 0 ? status : EXIT_USAGE;
    }
    const int ended = end_server(view, fd);
    sim_session_free(session);
    return status == EXIT_GOOD ? ended : status;
}

/* Without a walk in this process it becomes the server itself. */
static int view_other(struct view *view)
{
    struct subject subject;
    struct control_params params;
    double speed_rad_s = 0.0;
    char message[SUBJECT_MESSAGE_MAX] = "";
    if (walk_options_resolve(&view->options.sim.walk, &subject, &params, &speed_rad_s, message) !=
        0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    view->subject = view_subject_json(&subject, &params, speed_rad_s, &view->options);
    if (view->subject == NULL) {
        program_complain("out of memory");
        return EXIT_USAGE;
    }
    become_server(view);
    return EXIT_USAGE;
}

int afo_view(int argc, char **argv)
{
    static struct view view;
    view_options_parse(&view.options, argc, argv);
    snprintf(view.port, sizeof view.port, "%u", view.options.port);
    int status = EXIT_USAGE;
    if (python_tool_find(&view.tool, "view", "serve.py") == 0) {
        if (view.options.interface != NULL || view.options.replay_path != NULL) {
            status = view_other(&view);
        } else {
            bus_program_catch_signals();
            status = view_walk(&view);
        }
    }
    free(view.subject);
    return status;
}
