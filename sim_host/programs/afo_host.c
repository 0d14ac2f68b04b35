/* afo-host: the control task on Linux, on a real CAN interface. */
#include <argp.h>
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "firmware/bus_recorder.h"
#include "firmware/version.h"
#include "hal/frame_table.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/host/output_file.h"
#include "sim_host/host/pacer.h"
#include "sim_host/host/task_rig.h"
#include "sim_host/host/walk_options.h"

enum { EXIT_DONE = 0, EXIT_FAULT = 1, EXIT_USAGE = 2 };

/* Lock-step: an answer that takes longer is lost, and the cycle goes on without it. */
#define ANSWER_TIMEOUT_NS UINT64_C(250000000)
#define TICK_NS ((uint64_t)TICK_PERIOD_US * 1000u)
/* A stop that was asked for must have unloaded the springs by then. */
enum { STOP_TICKS = 3000, SILENT_CYCLES = 40, PATIENT_CYCLES = 3 };

struct options {
    struct walk_options walk;
    const char *interface;
    uint32_t steps; /* 0 = until stopped */
    bool real_time;
    bool auto_reset; /* on a bench: clear a latched fault by itself */
    bool quiet;
    bool json;
};

struct host {
    struct options options;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    struct socketcan_bus socket;
    struct task_rig rig;
    struct bus_recorder recorder;
    struct black_box black_box; /* read it with afo-blackbox */
    struct pacer pacer;
    uint64_t lost_cycles; /* cycles that went on without an answer */
    uint32_t steps;
    uint32_t faults; /* times that a fault was latched */
    bool refusal_told;
    enum supervisor_state told_state;
};

static volatile sig_atomic_t stop_wanted;

static void on_signal(int number)
{
    (void)number;
    stop_wanted = 1;
}

/* ---- options --------------------------------------------------------------- */

enum { KEY_AUTO_RESET = 0x100 };

static const struct argp_option option_list[] = {
    {"can", 'c', "IFACE", 0, "CAN interface, such as can0 or vcan0 (required)", 2},
    {"steps", 'n', "N", 0, "stop after N steps (default: until interrupted)", 2},
    {"real-time", 'r', 0, 0,
     "SYNC every millisecond by the clock (default: lock-step, as fast as the nodes answer)", 2},
    {"auto-reset", KEY_AUTO_RESET, 0, 0,
     "clear a latched fault once all nodes are back and still (on a bench only: never with a "
     "wearer)",
     2},
    {"json", 'j', 0, 0, "one JSON object on standard output at the end", 2},
    {"quiet", 'q', 0, 0, "only errors", 2},
    {0}};

static error_t take(int key, char *text, struct argp_state *state)
{
    struct options *options = (struct options *)state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        break;
    case 'c':
        options->interface = text;
        break;
    case 'n':
        options->steps = (uint32_t)option_whole(state, "--steps", text, 1, 1000000000);
        break;
    case 'r':
        options->real_time = true;
        break;
    case KEY_AUTO_RESET:
        options->auto_reset = true;
        break;
    case 'j':
        options->json = true;
        break;
    case 'q':
        options->quiet = true;
        break;
    case ARGP_KEY_ARG:
        argp_error(state, "unexpected argument \"%s\"", text);
        break;
    case ARGP_KEY_END:
        if (options->interface == NULL) {
            argp_error(state, "--can IFACE is required");
        }
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void parse(struct options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {{&walk_options_parser, 0, "", 1}, {0}};
    static const struct argp parser = {
        option_list,
        take,
        0,
        "Runs the control task on a CAN interface. An interrupt (Ctrl-C) unloads the springs, "
        "switches the drives off and ends.\v"
        "Exit status: 0 walked, 1 stopped by a fault, 2 wrong usage, input or interface.",
        children,
        0,
        0};
    walk_options_init(&options->walk);
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
    struct socketcan_filter filters[SOCKETCAN_FILTERS_MAX];
    unsigned count = 0;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        const bool heard = table[i].sender != NODE_CONTROLLER || frame_is_masters(table[i].id);
        if (heard && table[i].id != FRAME_SYNC && count < SOCKETCAN_FILTERS_MAX) {
            filters[count++] = (struct socketcan_filter){table[i].id, CAN_ID_STANDARD_MAX};
        }
    }
    const int result =
        socketcan_bus_open(&host->socket, host->options.interface, filters, count, true);
    if (result == 0) {
        return 0;
    }
    fprintf(stderr, "afo-host: %s: %s%s\n", host->options.interface, strerror(-result),
            result == -EAFNOSUPPORT ? " (this kernel has no CAN; scripts/vcan-guest brings one)"
            : result == -ENODEV     ? " (ip link shows the interfaces)"
                                    : "");
    return -1;
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

/* ---- running --------------------------------------------------------------- */

static const char *state_name(enum supervisor_state state)
{
    static const char *const names[SUPERVISOR_STATES] = {"waiting for the nodes",
                                                         "self test",
                                                         "standby",
                                                         "engaging",
                                                         "walking",
                                                         "unloading",
                                                         "FAULT"};
    return (unsigned)state < SUPERVISOR_STATES ? names[state] : "unknown";
}

static void tell(struct host *host)
{
    const struct control_task *task = &host->rig.task;
    const struct setup_failure *failure = &task->setup.failure;
    if (failure->verdict < SETUP_DONE && !host->refusal_told) {
        host->refusal_told = true;
        fprintf(stderr, "afo-host: node %u refused: object 0x%04X:%02X, expected 0x%X, %s 0x%X\n",
                failure->node, failure->index, failure->sub, failure->expected,
                failure->verdict == SETUP_DIFFERS ? "found" : "abort code", failure->found);
    }
    if (task->output.state != host->told_state && !host->options.quiet && !host->options.json) {
        printf("  tick %8u  %s%s%s\n", task->tick, state_name(task->output.state),
               task->output.fault != SUPERVISOR_FAULT_NONE ? ": " : "",
               task->output.fault != SUPERVISOR_FAULT_NONE
                   ? supervisor_fault_name(task->output.fault)
                   : "");
        fflush(stdout);
    }
    if (task->output.state != host->told_state && task->output.state == SUPERVISOR_FAULT) {
        host->faults++;
    }
    host->told_state = task->output.state;
}

/* Handles frames until the cycle is complete (lock-step) or deadline_ns. Returns
 * false at the deadline. */
static bool run_cycle(struct host *host, uint64_t deadline_ns, bool lock_step)
{
    struct control_task *task = &host->rig.task;
    const uint32_t before = task->tick;
    for (;;) {
        if (control_task_poll(task) & CONTROL_TASK_NEW_STEP) {
            host->steps++;
        }
        if (lock_step && task->tick != before && control_task_cycle_complete(task)) {
            return true;
        }
        if (socketcan_now_ns() >= deadline_ns) {
            return false;
        }
        const int ready = socketcan_bus_wait(&host->socket, deadline_ns);
        if (ready < 0 && ready != -EINTR) {
            /* Interface down: nothing to wait for but the deadline. */
            usleep(1000);
        }
    }
}

static bool has_stopped(const struct control_task *task)
{
    const enum supervisor_state state = task->output.state;
    return !supervisor_may_enable(state) && !supervisor_may_assist(state);
}

static void run(struct host *host)
{
    struct control_task *task = &host->rig.task;
    uint32_t stop_ticks = 0;
    uint32_t silent_cycles = 0;
    if (host->options.real_time) {
        pacer_start(&host->pacer, TICK_NS);
    }
    while (stop_ticks < STOP_TICKS) {
        if (host->options.real_time) {
            (void)pacer_wait(&host->pacer);
        }
        (void)control_task_start_cycle(task);
        /* Nodes that are not operational, or gone, do not answer: then a tick lasts its time. */
        const bool answers =
            network_all_operational(&task->network) && silent_cycles < PATIENT_CYCLES;
        const uint64_t patience_ns = answers ? ANSWER_TIMEOUT_NS : TICK_NS;
        const uint64_t deadline_ns = host->options.real_time ? host->pacer.next_ns - TICK_NS / 10
                                                             : socketcan_now_ns() + patience_ns;
        if (!run_cycle(host, deadline_ns, !host->options.real_time) && answers &&
            !host->options.real_time) {
            host->lost_cycles++;
        }
        silent_cycles = control_task_cycle_complete(task) ? 0 : silent_cycles + 1;
        tell(host);
        const bool stuck = task->output.state == SUPERVISOR_FAULT ||
                           task->output.state == SUPERVISOR_INIT; /* a drive's own fault */
        if (host->options.auto_reset && stuck && network_all_operational(&task->network)) {
            task->node.objects.reset_requested = 1; /* obeyed at standstill only */
        }
        if (host->options.auto_reset && !stop_wanted) {
            task->node.objects.walk_requested = stuck ? 0 : 1; /* and asks anew */
        }
        if (host->options.steps > 0 && host->steps >= host->options.steps) {
            stop_wanted = 1;
        }
        if (stop_wanted) {
            task->node.objects.walk_requested = 0;
            stop_ticks++;
            if ((has_stopped(task) && stop_ticks > 10) || silent_cycles > SILENT_CYCLES) {
                break; /* unloaded and off, or nobody left to tell */
            }
        }
    }
}

/* ---- reporting ------------------------------------------------------------- */

static void report_text(const struct host *host)
{
    const struct control_task *task = &host->rig.task;
    struct can_bus_status status;
    const struct can_bus bus = task->config.bus;
    can_bus_get_status(&bus, &status);
    printf("\n  steps      %u; last: %.6f rad/s measured, %.6f commanded, r0 %.6f m\n", host->steps,
           (double)task->controller.last_step.measured_speed_rad_s,
           (double)task->controller.last_step.commanded_speed_rad_s,
           (double)task->controller.last_step.r0_m);
    printf("  ticks      %u; %llu cycles without all answers, %u answers late\n", task->tick,
           (unsigned long long)host->lost_cycles, task->counters.late_answers);
    printf("  bus        %u frames out, %u in, %u refused, %u lost on receive, %u error frames, "
           "bus-off %u times\n",
           status.tx_frames, status.rx_frames, status.tx_refused, status.rx_overflow,
           status.error_frames, status.bus_off_count);
    printf("  state      %s, fault: %s\n", state_name(task->output.state),
           supervisor_fault_name(task->output.fault));
    if (host->options.real_time) {
        pacer_report(&host->pacer, stdout);
    }
}

static void report_json(const struct host *host)
{
    const struct control_task *task = &host->rig.task;
    struct can_bus_status status;
    const struct can_bus bus = task->config.bus;
    can_bus_get_status(&bus, &status);
    printf(
        "{\"steps\": %u, \"ticks\": %u, \"lost_cycles\": %llu, \"late_answers\": %u, "
        "\"measured_speed_rad_s\": %.9g, \"r0_m\": %.9g, \"state\": %d, \"fault\": %d, \"faults\": %u, "
        "\"tx_frames\": %u, \"rx_frames\": %u, \"tx_refused\": %u, \"rx_overflow\": %u, "
        "\"error_frames\": %u, \"missed_deadlines\": %llu, \"worst_late_us\": %.3f}\n",
        host->steps, task->tick, (unsigned long long)host->lost_cycles, task->counters.late_answers,
        (double)task->controller.last_step.measured_speed_rad_s,
        (double)task->controller.last_step.r0_m, (int)task->output.state, (int)task->output.fault,
        host->faults, status.tx_frames, status.rx_frames, status.tx_refused, status.rx_overflow,
        status.error_frames, (unsigned long long)host->pacer.missed,
        1e-3 * (double)host->pacer.worst_late_ns);
}

int main(int argc, char **argv)
{
    static struct host host;
    char message[SUBJECT_MESSAGE_MAX] = "";
    const struct sigaction action = {.sa_handler = on_signal};

    parse(&host.options, argc, argv);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    if (walk_options_resolve(&host.options.walk, &host.subject, &host.params, &host.speed_rad_s,
                             message) != 0) {
        fprintf(stderr, "afo-host: %s\n", message);
        return EXIT_USAGE;
    }
    if (open_bus(&host) != 0) {
        return EXIT_USAGE;
    }
    if (task_rig_init(&host.rig, &host.subject, &host.params, recorded_bus(&host), host.speed_rad_s,
                      true) != CONTROL_PARAMS_OK) {
        fprintf(stderr, "afo-host: the control task refuses these parameters\n");
        socketcan_bus_close(&host.socket);
        return EXIT_USAGE;
    }
    if (host.recorder.box != NULL) {
        controller_node_attach(&host.rig.task.node, NULL, NULL, host.recorder.box, NULL);
    }
    run(&host);
    if (host.options.json) {
        report_json(&host);
    } else if (!host.options.quiet) {
        report_text(&host);
    }
    const bool faulty = host.rig.task.output.fault != SUPERVISOR_FAULT_NONE || host.refusal_told;
    socketcan_bus_close(&host.socket);
    if (output_standard_done("afo-host") != 0) {
        return EXIT_USAGE;
    }
    return faulty ? EXIT_FAULT : EXIT_DONE;
}
