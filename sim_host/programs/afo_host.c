/* afo-host: the control task on Linux, on a real CAN interface. */
#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "firmware/bus_recorder.h"
#include "firmware/version.h"
#include "hal/bus/frame_table.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/cli/operator_line.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/loop/lock_step.h"
#include "sim_host/loop/pacer.h"
#include "sim_host/subjects/host_task.h"

enum { EXIT_DONE = 0, EXIT_FAULT = 1, EXIT_USAGE = 2 };

#define TICK_NS ((uint64_t)TICK_PERIOD_US * 1000u)
#define LISTEN_NS UINT64_C(1000000000)
#define RECOVERY_NS UINT64_C(100000000)
/* Waking up from the wait for frames may take so long. What comes later is not lost: it waits
 * in the kernel, in its place before the next SYNC. */
#define REAL_TIME_MARGIN_NS (3 * TICK_NS / 10)
/* A stop that was asked for must have unloaded the springs by then; what the bus does not
 * take is set directly. */
enum { STOP_TICKS = 3000, STOP_ASK_TICKS = 100, SILENT_CYCLES = 40 };
/* So many answers in a row that did not come, and nobody is waited for any more. */
enum { PATIENT_CYCLES = 3 };
/* After the last step asked for its telemetry has still to come out. */
enum { LAST_FRAMES_TICKS = 3 };
/* Between two resets of --auto-reset: the drives take theirs at a rising edge. */
enum { RESET_TICKS = 50 };
/* A log that names its build early is known by its beginning. */
enum { IDENTITY_TICK = 10 };

struct options {
    struct walk_options walk;
    struct bus_options bus;
    bool real_time;
    bool auto_reset; /* on a bench: clear a latched fault by itself, and walk again */
    uint64_t patience_ns;
};

struct host {
    struct options options;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    struct socketcan_bus socket, operator_socket;
    struct operator_line operator_line;
    struct host_task rig;
    struct bus_recorder recorder;
    struct black_box black_box; /* read it with afo-blackbox */
    bool identity_told;         /* asked for over the bus, for the log's sake */
    bool nodes_seen;            /* all were operational once */
    struct pacer pacer;
    struct host_figures figures;
    unsigned unanswered;         /* in a row */
    uint32_t step_tick;          /* in which the last one was told */
    uint32_t told_down, told_up; /* times that the interface went down and came back */
    uint32_t told_bus_off;       /* times that the controller chip left the bus */
    bool is_bus_off;             /* by what was told */
    uint64_t next_recovery_ns;
    uint32_t told_refusal; /* number of the last one that was told */
    enum supervisor_state told_state;
};

/* ---- options --------------------------------------------------------------- */

enum { KEY_AUTO_RESET = 0x100, KEY_PATIENCE };

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "Time:", 3},
    {"real-time", 'r', 0, 0,
     "SYNC every millisecond by the clock (default: lock-step, as fast as the nodes answer)", 0},
    {"answer-timeout", KEY_PATIENCE, "MS", 0,
     "lock-step: an answer that takes longer is lost, and the walk goes on without it "
     "(default 1000)",
     0},
    {"auto-reset", KEY_AUTO_RESET, 0, 0,
     "clear a latched fault once all nodes are back and still, and walk again (on a bench only: "
     "never with a wearer)",
     0},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->bus;
        break;
    case 'r':
        options->real_time = true;
        break;
    case KEY_PATIENCE:
        options->patience_ns = option_whole(state, "--answer-timeout", text, 1, 600000) * 1000000u;
        break;
    case KEY_AUTO_RESET:
        options->auto_reset = true;
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void parse(struct options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {
        {&walk_options_parser, 0, "", 1}, {&bus_options_parser, 0, "", 2}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Runs the control task on a CAN interface. An interrupt (Ctrl-C), SIGTERM, a hangup or a "
        "reader of the output that went away unloads the springs, switches the drives off and "
        "ends. So do, with --steps, a latched fault and a node that is refused because it is not as "
        "the subject says; without --steps an operator may clear the fault over the bus, and a "
        "refused node may be exchanged or switched off and on, which sets it up anew: --auto-reset "
        "waits for that, with --steps as well. A node that is not there is always waited for.\v"
        "Exit status: 0 walked, 1 stopped by a fault or a node is refused, 2 wrong usage, input or "
        "interface, or the output could not be written.",
        children,
        0,
        0};
    walk_options_init(&options->walk);
    options->patience_ns = UINT64_C(1000000000);
    option_identity("afo-host");
    if (argp_parse(&parser, argc, argv, 0, NULL, options) != 0) {
        exit(EXIT_USAGE);
    }
}

/* ---- opening --------------------------------------------------------------- */

#define SENDER(name, id, bytes, period_us, deadline_us, node, kind) {id, node},
static const struct {
    uint16_t id;
    uint8_t sender;
} table[] = {FRAME_TABLE(SENDER)};
#undef SENDER

static int open_bus(struct host *host)
{
    const struct socketcan_filter answers = {FRAME_SDO_ANSWER_CONTROLLER, CAN_ID_STANDARD_MAX};
    struct socketcan_filter filters[SOCKETCAN_FILTERS_MAX];
    unsigned count = 0;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        const bool heard = table[i].sender != NODE_CONTROLLER || frame_is_masters(table[i].id);
        if (heard && table[i].id != FRAME_SYNC && count < SOCKETCAN_FILTERS_MAX) {
            filters[count++] = (struct socketcan_filter){table[i].id, CAN_ID_STANDARD_MAX};
        }
    }
    if (host->subject.protocol != DRIVE_PROTOCOL_CIA402) {
        count = 0; /* their identifiers are no frames of the table: hear everything */
    }
    int error =
        socketcan_bus_open(&host->socket, host->options.bus.interface, filters, count, true);
    if (error == 0) {
        error = socketcan_bus_open(&host->operator_socket, host->options.bus.interface, &answers, 1,
                                   false);
        if (error == 0) {
            operator_line_init(&host->operator_line,
                               socketcan_bus_interface(&host->operator_socket));
            return 0;
        }
        socketcan_bus_close(&host->socket);
    }
    bus_program_no_interface("afo-host", host->options.bus.interface, error);
    return -1;
}

static void close_bus(struct host *host)
{
    socketcan_bus_close(&host->operator_socket);
    socketcan_bus_close(&host->socket);
}

/* The bus, with the black box before it; only the orthosis's own drives have snapshots. */
static struct can_bus recorded_bus(struct host *host)
{
    const struct can_bus bus = socketcan_bus_interface(&host->socket);
    const struct snapshot_source source = {&host->rig.task, &host->rig.cia402};
    if (host->subject.protocol != DRIVE_PROTOCOL_CIA402) {
        return bus;
    }
    black_box_start(&host->black_box, version_build_id(), controller_node_crc_of(&host->params));
    bus_recorder_init(&host->recorder, &bus, &host->black_box, &source);
    return bus_recorder_interface(&host->recorder);
}

/* A snapshot holds nothing of the nodes' set-up, and none could be gone on from in its middle:
 * what counts is recorded from where all are operational. */
static void record_from_here(struct host *host)
{
    if (!host->nodes_seen && network_all_operational(&host->rig.task.network)) {
        host->nodes_seen = true;
        if (host->black_box.header.state == (uint32_t)BLACK_BOX_RECORDING) {
            black_box_start(&host->black_box, version_build_id(),
                            host->rig.task.node.objects.params_crc);
        }
    }
}

/* ---- running --------------------------------------------------------------- */

static void tell_interface(struct host *host)
{
    const struct socketcan_counters *counters = &host->socket.counters;
    const char *name = host->options.bus.interface;
    if (counters->went_down != host->told_down) {
        fprintf(stderr, "afo-host: %s is down, nothing is sent or heard\n", name);
        host->told_down = counters->went_down;
    }
    if (counters->came_back != host->told_up) {
        fprintf(stderr, "afo-host: %s is up again\n", name);
        host->told_up = counters->came_back;
    }
}

static void tell_bus_off(struct host *host)
{
    const struct can_bus_status *status = &host->socket.status;
    const char *name = host->options.bus.interface;
    char advice[SOCKETCAN_ADVICE_MAX];
    if (status->bus_off_count != host->told_bus_off) {
        host->told_bus_off = status->bus_off_count;
        host->is_bus_off = true;
        fprintf(stderr, "afo-host: %s is bus-off: the controller chip took itself off the bus\n",
                name);
    }
    if (host->is_bus_off && status->error_state != CAN_BUS_OFF) {
        host->is_bus_off = false;
        fprintf(stderr, "afo-host: %s is on the bus again\n", name);
    }
    if (socketcan_bus_advice(&host->socket, advice, sizeof advice)) {
        fprintf(stderr, "afo-host: %s\n", advice);
    }
}

static void tell(struct host *host)
{
    const struct control_task *task = &host->rig.task;
    tell_interface(host);
    tell_bus_off(host);
    host_report_refusal(task, &host->told_refusal);
    if (task->output.state != host->told_state && !host->options.bus.quiet &&
        !host->options.bus.json) {
        printf("  tick %8u  %s%s%s\n", task->tick, host_report_state_name(task->output.state),
               task->output.fault != SUPERVISOR_FAULT_NONE ? ": " : "",
               task->output.fault != SUPERVISOR_FAULT_NONE
                   ? supervisor_fault_name(task->output.fault)
                   : "");
        fflush(stdout);
    }
    if (task->output.state != host->told_state && task->output.state == SUPERVISOR_FAULT) {
        host->figures.faults++;
    }
    host->told_state = task->output.state;
}

static uint64_t deadline_of(const struct host *host, uint64_t start_ns, bool awaited)
{
    if (host->options.real_time) {
        return host->pacer.next_ns - REAL_TIME_MARGIN_NS;
    }
    /* Where nobody will answer a tick lasts its time. */
    return start_ns +
           (awaited && host->unanswered < PATIENT_CYCLES ? host->options.patience_ns : TICK_NS);
}

/* Off the bus, the controller chip comes back only when somebody asks for it (or by the
 * interface's own restart-ms). */
static void recover_bus(struct host *host, uint64_t now_ns)
{
    if (host->socket.status.error_state == CAN_BUS_OFF && now_ns >= host->next_recovery_ns) {
        const struct can_bus bus = socketcan_bus_interface(&host->socket);
        host->next_recovery_ns = now_ns + RECOVERY_NS;
        can_bus_recover(&bus);
    }
}

/* Sends the SYNC and handles frames until the cycle is complete (lock-step) or its time is
 * over. In lock-step time stands still while somebody works on an answer: how fast the
 * machine is does not count. */
static void run_cycle(struct host *host)
{
    struct control_task *task = &host->rig.task;
    const uint32_t before = task->tick;
    const uint64_t start_ns = socketcan_now_ns();
    const bool lock_step = !host->options.real_time;
    const bool walking = network_all_operational(&task->network);
    const unsigned expected = lock_step_expected(task);
    const bool sent = control_task_start_cycle(task) == CAN_OK;
    recover_bus(host, start_ns);
    for (;;) {
        if (control_task_poll(task) & CONTROL_TASK_NEW_STEP) {
            host->figures.steps++;
            host->step_tick = task->tick;
        }
        const bool answered = task->tick != before && lock_step_answered(task, expected);
        if (lock_step && answered && expected != 0) {
            host->unanswered = 0;
            return;
        }
        /* What was not sent, or was lost with the interface, nobody will answer. */
        const bool awaited = sent && !answered && !host->socket.is_down;
        const uint64_t deadline_ns = deadline_of(host, start_ns, awaited);
        if (socketcan_now_ns() >= deadline_ns) {
            host->figures.lost_cycles += walking && lock_step && !answered ? 1 : 0;
            host->unanswered = answered ? 0 : host->unanswered + 1;
            return;
        }
        const int ready = socketcan_bus_wait(&host->socket, deadline_ns);
        if (ready < 0 && ready != -EINTR) {
            /* Interface down: nothing to wait for but the deadline. */
            usleep(1000);
        }
    }
}

/* Without torque by their own word, or out of our reach. */
static bool drives_are_off(const struct control_task *task)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(&task->config.drives, (enum side)leg, &drive);
        if (drive.age_ticks <= SILENT_CYCLES && drive.state != DRIVE_DISABLED &&
            drive.state != DRIVE_FAULT) {
            return false;
        }
    }
    return true;
}

static bool has_stopped(const struct control_task *task)
{
    const enum supervisor_state state = task->output.state;
    return !supervisor_may_enable(state) && !supervisor_may_assist(state) && drives_are_off(task);
}

static bool nobody_answers(const struct control_task *task)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(&task->config.drives, (enum side)leg, &drive);
        if (task->sensors.reading[leg].age_ticks == 0 || drive.age_ticks == 0) {
            return false;
        }
    }
    return true;
}

/* What an operator would ask for now. */
static void operate(struct host *host, bool stop)
{
    struct control_task *task = &host->rig.task;
    struct operator_line *line = &host->operator_line;
    const enum supervisor_state state = task->output.state;
    uint8_t walk = task->node.objects.walk_requested;
    operator_line_poll(line, line->under_way ? socketcan_now_ns() : 0);
    if (task->tick >= IDENTITY_TICK && !host->identity_told) {
        host->identity_told = !operator_line_ask_identity(line, socketcan_now_ns());
        return; /* one after the other */
    }
    if (host->options.auto_reset) {
        /* A request that ended in a stop is spent: it is taken back, and made anew. */
        const bool over = state == SUPERVISOR_UNLOADING || state == SUPERVISOR_FAULT;
        walk = over ? 0 : state == SUPERVISOR_STANDBY ? 1 : walk;
    }
    walk = stop ? 0 : walk;
    if (walk != task->node.objects.walk_requested) {
        operator_line_ask(line, OPERATOR_WALK, walk, socketcan_now_ns());
    } else if (host->options.auto_reset && task->tick % RESET_TICKS == 0 &&
               (state == SUPERVISOR_FAULT || state == SUPERVISOR_INIT) && /* a drive's own fault */
               network_all_operational(&task->network)) {
        operator_line_ask(line, OPERATOR_RESET, 1, socketcan_now_ns()); /* obeyed at standstill */
    }
}

static bool wants_to_end(const struct host *host)
{
    const struct control_task *task = &host->rig.task;
    const uint32_t steps = host->options.bus.steps;
    if (bus_program_is_to_end() || ferror(stdout)) {
        return true;
    }
    /* A walk of so many steps has nobody who would clear a fault, or restart a node. */
    const bool failed = (task->output.state == SUPERVISOR_FAULT || host_report_is_refused(task)) &&
                        !host->options.auto_reset;
    const bool walked =
        host->figures.steps >= steps && task->tick - host->step_tick >= LAST_FRAMES_TICKS;
    return steps > 0 && (failed || walked);
}

/* Before the first SYNC: who is there, and in which state. Nodes tell it ten times a second. */
static void listen(struct host *host)
{
    const uint64_t limit_ns =
        host->options.patience_ns < LISTEN_NS ? host->options.patience_ns : LISTEN_NS;
    const uint64_t end_ns = socketcan_now_ns() + limit_ns;
    do {
        (void)control_task_poll(&host->rig.task);
        (void)socketcan_bus_wait(&host->socket, end_ns);
    } while (!lock_step_knows_all(&host->rig.task) && socketcan_now_ns() < end_ns &&
             !bus_program_is_to_end());
}

static void run(struct host *host)
{
    struct control_task *task = &host->rig.task;
    uint32_t stop_ticks = 0;
    uint32_t silent_cycles = 0;
    if (host->options.real_time) {
        pacer_start(&host->pacer, TICK_NS);
    } else {
        listen(host);
    }
    while (stop_ticks < STOP_TICKS) {
        if (host->options.real_time) {
            (void)pacer_wait(&host->pacer);
            control_task_show_missed(
                task, host->pacer.missed < UINT32_MAX ? (uint32_t)host->pacer.missed : UINT32_MAX);
        }
        run_cycle(host);
        silent_cycles = nobody_answers(task) ? silent_cycles + 1 : 0;
        tell(host);
        record_from_here(host);
        const bool stop = stop_ticks > 0 || wants_to_end(host);
        operate(host, stop);
        if (stop) {
            stop_ticks++;
            if (stop_ticks > STOP_ASK_TICKS) {
                task->node.objects.walk_requested = 0;
            }
            const bool told = task->node.objects.walk_requested == 0 && stop_ticks > 10;
            if ((has_stopped(task) && told) || silent_cycles > SILENT_CYCLES) {
                break; /* unloaded and off, or nobody left to tell */
            }
        }
    }
}

int main(int argc, char **argv)
{
    static struct host host;
    char message[SUBJECT_MESSAGE_MAX] = "";

    parse(&host.options, argc, argv);
    bus_program_catch_signals();
    if (walk_options_resolve(&host.options.walk, &host.subject, &host.params, &host.speed_rad_s,
                             message) != 0) {
        fprintf(stderr, "afo-host: %s\n", message);
        return EXIT_USAGE;
    }
    if (open_bus(&host) != 0) {
        return EXIT_USAGE;
    }
    if (host_task_init(&host.rig, &host.subject, &host.params, recorded_bus(&host),
                       host.speed_rad_s, true) != CONTROL_PARAMS_OK) {
        fprintf(stderr, "afo-host: the control task refuses these parameters\n");
        close_bus(&host);
        return EXIT_USAGE;
    }
    if (host.recorder.box != NULL) {
        controller_node_attach(&host.rig.task.node, NULL, NULL, host.recorder.box, NULL);
    }
    run(&host);
    host.figures.went_down = host.socket.counters.went_down;
    if (host.options.bus.json) {
        host_report_json(&host.rig.task, &host.figures, &host.pacer);
    } else if (!host.options.bus.quiet) {
        host_report_text(&host.rig.task, &host.figures,
                         host.options.real_time ? &host.pacer : NULL);
    }
    const enum supervisor_fault fault = host.rig.task.output.fault;
    if (fault != SUPERVISOR_FAULT_NONE) {
        fprintf(stderr, "afo-host: stopped by a fault: %s\n", supervisor_fault_name(fault));
    }
    const bool faulty = fault != SUPERVISOR_FAULT_NONE || host_report_is_refused(&host.rig.task);
    close_bus(&host);
    if (output_standard_done("afo-host") != 0) {
        return EXIT_USAGE;
    }
    return faulty ? EXIT_FAULT : EXIT_DONE;
}
