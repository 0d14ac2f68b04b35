/* afo walker: the walker's side of a real CAN bus, plant and four CANopen nodes.
 *
 * Its time advances one tick per SYNC, so a controller may pace it in real time or
 * run it in lock-step. When the SYNC stays away it goes on by the clock: the drives
 * notice that their master is gone and unload, the walker falls, the hand picks it up.
 * A SYNC that another one has followed already is answered no more, as no device answers one
 * that passed while it was busy: the answers would come in a bunch.
 */
#include <stdio.h>

#include "hal/bus/frame_table.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "model/tick.h"
#include "sim_host/bus/bus_budget.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/cli/walker_options.h"
#include "sim_host/cli/walker_report.h"
#include "sim_host/loop/loop.h"
#include "sim_host/nodes/walker_nodes.h"
#include "sim_host/programs/commands.h"

enum { CLOCK_TICKS_AT_ONCE = 20 };

static const uint64_t NS_PER_MS = 1000000, TICK_NS = UINT64_C(1000) * TICK_PERIOD_US;
static const uint64_t IDLE_NS = 5000000; /* longest sleep while nobody is heard */
static const uint64_t RECOVERY_NS = 100000000;

/* ---- the walker ------------------------------------------------------------ */

struct session {
    struct walker_options options;
    struct loop_config config;
    struct socketcan_bus bus;
    struct can_bus port; /* the same, as it is without the answers that are too late */
    bool is_late;
    struct walker_nodes nodes;
    uint32_t sdo_requests; /* when the filters were last set */
    uint64_t start_ns;     /* CLOCK_MONOTONIC */
    uint64_t last_sync_ns; /* CLOCK_MONOTONIC; 0: none yet */
    uint64_t next_clock_ns, next_recovery_ns;
    uint64_t time_ns; /* the nodes' time */
    bool by_clock;
    struct walker_figures figures;
    double apex_speed_rad_s[WALKER_APEXES_MAX];
};

static bool is_answer(uint32_t id)
{
    return id == FRAME_DRIVE_STATE_LEFT || id == FRAME_DRIVE_STATE_RIGHT ||
           id == FRAME_LEG_STATE_LEFT || id == FRAME_LEG_STATE_RIGHT;
}

static enum can_result node_send(void *context, const struct can_msg *message)
{
    struct session *session = context;
    if (session->is_late && message->flags == 0 && is_answer(message->id)) {
        return CAN_OK;
    }
    return can_bus_send(&session->port, message);
}

static enum can_result node_receive(void *context, struct can_msg *message, uint64_t *time_ns)
{
    struct session *session = context;
    return can_bus_receive(&session->port, message, time_ns);
}

static void node_get_status(void *context, struct can_bus_status *status)
{
    struct session *session = context;
    can_bus_get_status(&session->port, status);
}

static void node_recover(void *context)
{
    struct session *session = context;
    can_bus_recover(&session->port);
}

static const struct can_bus_ops node_ops = {node_send, node_receive, node_get_status, node_recover};

static void listen_to_nodes_ids(struct session *session)
{
    uint16_t ids[WALKER_NODES_IDS_MAX];
    struct socketcan_filter filters[SOCKETCAN_FILTERS_MAX];
    unsigned count = walker_nodes_ids(&session->nodes, ids);
    if (count > SOCKETCAN_FILTERS_MAX) {
        count = 0; /* more than filters: hear everything */
    }
    for (unsigned i = 0; i < count; i++) {
        filters[i] = (struct socketcan_filter){.id = ids[i], .mask = CAN_ID_STANDARD_MAX};
    }
    (void)socketcan_bus_set_filters(&session->bus, filters, count);
    session->sdo_requests = walker_nodes_sdo_requests(&session->nodes);
}

static int prepare(struct session *session)
{
    const struct walker_options *options = &session->options;
    char message[LOOP_MESSAGE_MAX] = "";
    if (sensing_options_configure(&options->sensing, &options->walk, NULL, &session->config,
                                  message) != 0) {
        return program_complain("%s", message);
    }
    session->config.plant.start_hold.hold_after_fall = true;
    if (options->in_stand) {
        session->config.plant.start_hold.release_tick = UINT64_MAX / 2;
    }
    const int error = socketcan_bus_open(&session->bus, options->bus.interface, NULL, 0, false);
    if (error != 0) {
        bus_program_no_interface(options->bus.interface, error);
        return -1;
    }
    session->start_ns = socketcan_now_ns();
    session->port = socketcan_bus_interface(&session->bus);
    struct can_bus bus[WALKER_NODES];
    for (int i = 0; i < WALKER_NODES; i++) {
        bus[i] = (struct can_bus){&node_ops, session};
    }
    if (walker_nodes_init(&session->nodes, &session->config.plant,
                          &session->config.subject.device.description, bus, 0, message) != 0) {
        socketcan_bus_close(&session->bus);
        return program_complain("%s", message);
    }
    listen_to_nodes_ids(session);
    return 0;
}

static void record(struct session *session)
{
    struct walk_event event;
    while (plant_next_event(&session->nodes.plant, &event)) {
        if (event.kind == WALK_EVENT_APEX && session->figures.apexes < WALKER_APEXES_MAX) {
            session->apex_speed_rad_s[session->figures.apexes++] = event.value;
        } else if (event.kind == WALK_EVENT_FAULT) {
            session->figures.falls++;
            snprintf(session->figures.last_fall, sizeof session->figures.last_fall, "%s",
                     walk_fault_name((enum walk_fault)(int)event.value));
        }
    }
}

static void finish_tick(struct session *session)
{
    walker_nodes_advance(&session->nodes);
    walker_nodes_measure(&session->nodes);
    record(session);
}

static void take_frame(struct session *session, const struct can_msg *message, uint64_t stamp_ns)
{
    const bool is_sync = message->id == FRAME_SYNC && message->flags == 0;
    if (is_sync) {
        session->time_ns += session->last_sync_ns != 0 ? TICK_NS : 0;
        session->last_sync_ns = stamp_ns;
        session->by_clock = false;
        session->is_late = socketcan_bus_has_fetched(&session->bus, FRAME_SYNC);
        session->figures.unanswered += session->is_late ? 1 : 0;
    }
    (void)walker_nodes_receive(&session->nodes, message, session->time_ns);
    if (is_sync) {
        /* Other protocols than CANopen speak by time, not when a SYNC says so. */
        walker_nodes_process(&session->nodes, session->time_ns);
        session->figures.sync_ticks++;
        finish_tick(session);
        session->is_late = false;
    } else if (walker_nodes_sdo_requests(&session->nodes) != session->sdo_requests) {
        listen_to_nodes_ids(session);
    }
}

/* Without SYNC: time passes all the same. */
static void go_by_clock(struct session *session, uint64_t now_ns)
{
    if (session->last_sync_ns == 0) { /* nobody has come yet: held, only heartbeats */
        session->time_ns = now_ns - session->start_ns;
        walker_nodes_process(&session->nodes, session->time_ns);
        return;
    }
    if (!session->by_clock) {
        if (now_ns - session->last_sync_ns < session->options.silence_ms * NS_PER_MS) {
            return;
        }
        session->by_clock = true;
        session->figures.silences++;
        session->next_clock_ns = now_ns;
    }
    for (int i = 0; i < CLOCK_TICKS_AT_ONCE && now_ns >= session->next_clock_ns; i++) {
        session->next_clock_ns += TICK_NS;
        session->time_ns += TICK_NS;
        session->figures.clock_ticks++;
        walker_nodes_process(&session->nodes, session->time_ns);
        finish_tick(session);
    }
    if (now_ns >= session->next_clock_ns) {
        session->next_clock_ns = now_ns + TICK_NS; /* the process was stopped: no burst */
    }
}

/* The nodes ask for a restart once; the controller chip may need more, and may not be ours to restart. */
static void look_after_bus(struct session *session, const struct can_bus *bus, uint64_t now_ns)
{
    char advice[SOCKETCAN_ADVICE_MAX];
    if (session->bus.status.error_state == CAN_BUS_OFF && now_ns >= session->next_recovery_ns) {
        session->next_recovery_ns = now_ns + RECOVERY_NS;
        can_bus_recover(bus);
    }
    if (socketcan_bus_advice(&session->bus, advice, sizeof advice)) {
        program_complain("%s", advice);
    }
}

static void serve(struct session *session)
{
    const struct can_bus bus = socketcan_bus_interface(&session->bus);
    uint64_t now_ns = session->start_ns;
    const uint32_t steps = session->options.bus.steps;
    while (!bus_program_is_to_end() && (steps == 0 || session->figures.apexes < steps)) {
        struct can_msg message;
        const uint64_t deadline_ns = session->by_clock ? session->next_clock_ns : now_ns + IDLE_NS;
        /* While frames flow the clock is not asked: system calls are what costs here. */
        const bool frames = socketcan_bus_wait(&session->bus, deadline_ns) == 1;
        while (frames && can_bus_receive(&bus, &message, &now_ns) == CAN_OK) {
            take_frame(session, &message, now_ns);
        }
        if (!frames || session->by_clock || session->last_sync_ns == 0) {
            now_ns = socketcan_now_ns();
            look_after_bus(session, &bus, now_ns);
            go_by_clock(session, now_ns);
        }
    }
    socketcan_bus_flush(&session->bus);
}

/* ---- the whole ------------------------------------------------------------- */

static void report(struct session *session)
{
    const struct can_bus_status *status = &session->bus.status;
    struct walker_figures *figures = &session->figures;
    figures->interface = session->options.bus.interface;
    figures->kernel_full = session->bus.counters.kernel_full;
    figures->went_down = session->bus.counters.went_down;
    figures->apex_speed_rad_s = session->apex_speed_rad_s;
    if (session->options.bus.json) {
        walker_report_json(figures, status);
    } else if (!session->options.bus.quiet) {
        walker_report_text(figures, status);
    }
}

int afo_walker(int argc, char **argv)
{
    static struct session session;
    bus_program_catch_signals();
    walker_options_parse(&session.options, argc, argv);
    char message[BUS_BUDGET_MESSAGE_MAX];
    if (bus_budget_check_build(message, sizeof message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    if (prepare(&session) != 0) {
        return EXIT_USAGE;
    }
    serve(&session);
    walker_nodes_free(&session.nodes);
    socketcan_bus_close(&session.bus);
    report(&session);
    if (program_output_done() != 0) {
        return EXIT_USAGE;
    }
    return session.figures.falls > 0 ? EXIT_BAD : EXIT_GOOD;
}
