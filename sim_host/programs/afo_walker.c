/* afo-walker: the walker's side of a real CAN bus, plant and four CANopen nodes.
 *
 * Its time advances one tick per SYNC, so a controller may pace it in real time or
 * run it in lock-step. When the SYNC stays away it goes on by the clock: the drives
 * notice that their master is gone and unload, the walker falls, the hand picks it up.
 * A SYNC that another one has followed already is answered no more, as no device answers one
 * that passed while it was busy: the answers would come in a bunch.
 */
#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/bus_program.h"
#include "sim_host/cli/output_file.h"
#include "sim_host/cli/walk_options.h"
#include "sim_host/loop/loop.h"
#include "sim_host/nodes/walker_nodes.h"

enum { EXIT_WALKED = 0, EXIT_FELL = 1, EXIT_USAGE = 2 };
enum { APEXES_MAX = 100000, CLOCK_TICKS_AT_ONCE = 20 };

static const uint64_t NS_PER_MS = 1000000;
static const uint64_t IDLE_NS = 5000000; /* longest sleep while nobody is heard */
static const uint64_t RECOVERY_NS = 100000000;

/* ---- command line ---------------------------------------------------------- */

struct options {
    struct walk_options walk;
    struct bus_options bus;
    enum sensor_preset_kind sensors;
    uint64_t seed;
    uint64_t silence_ms;
};

enum { KEY_SENSORS = 0x100, KEY_SEED, KEY_SILENCE };

static const struct argp_option option_list[] = {
    {0, 0, 0, 0, "The walker:", 3},
    {"sensors", KEY_SENSORS, "PRESET", 0, "ideal, 17bit (default), 14bit or 12bit", 0},
    {"seed", KEY_SEED, "N", 0, "seed of all noise (default 1)", 0},
    {"silence", KEY_SILENCE, "MS", 0,
     "go on by the clock after so long without SYNC (default 1500: a host in lock-step waits 1000 "
     "for a lost frame; 20 suits real time)",
     0},
    {0}};

static error_t take_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->walk;
        state->child_inputs[1] = &options->bus;
        break;
    case KEY_SENSORS:
        if (!sensor_preset_from_name(text, &options->sensors)) {
            argp_error(state, "--sensors: \"%s\" is unknown, allowed is ideal, 17bit, 14bit, 12bit",
                       text);
        }
        break;
    case KEY_SEED:
        options->seed = option_whole(state, "--seed", text, 0, UINT64_MAX);
        break;
    case KEY_SILENCE:
        options->silence_ms = option_whole(state, "--silence", text, 2, 60000);
        break;
    case ARGP_KEY_END:
        if (options->bus.steps > APEXES_MAX) {
            argp_error(state, "--steps: the walker remembers %d at most", APEXES_MAX);
        }
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static void parse_options(struct options *options, int argc, char **argv)
{
    static const struct argp_child children[] = {
        {&walk_options_parser, 0, "", 1}, {&bus_options_parser, 0, "", 2}, {0}};
    static const struct argp parser = {
        option_list,
        take_option,
        0,
        "The simulated walker with its two SEA drives and two leg sensors as CANopen nodes "
        "1 to 4 on a CAN interface.\v"
        "Exit status: 0 ended without a fall, 1 fell, 2 wrong usage or no such interface.",
        children,
        0,
        0};
    *options = (struct options){.sensors = SENSORS_17BIT, .seed = 1, .silence_ms = 1500};
    walk_options_init(&options->walk);
    option_identity("afo-walker");
    if (argp_parse(&parser, argc, argv, 0, NULL, options) != 0) {
        exit(EXIT_USAGE);
    }
}

/* ---- the walker ------------------------------------------------------------ */

struct session {
    struct options options;
    struct loop_config config;
    struct socketcan_bus bus;
    struct can_bus port; /* the same, as it is without the answers that are too late */
    bool is_late;
    uint64_t unanswered;
    struct walker_nodes nodes;
    uint32_t sdo_requests; /* when the filters were last set */
    uint64_t start_ns;     /* CLOCK_MONOTONIC */
    uint64_t last_sync_ns; /* CLOCK_MONOTONIC; 0: none yet */
    uint64_t next_clock_ns, next_recovery_ns;
    uint64_t time_ns; /* the nodes' time */
    uint64_t sync_ticks, clock_ticks, silences;
    bool by_clock;
    unsigned falls, held;
    char last_fall[32];
    unsigned apexes;
    double apex_speed_rad_s[APEXES_MAX];
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

static void complain(const char *message)
{
    fprintf(stderr, "afo-walker: %s\n", message);
}

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
    const struct options *options = &session->options;
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
    session->config.plant.start_hold.hold_after_fall = true;
    const int error = socketcan_bus_open(&session->bus, options->bus.interface, NULL, 0, false);
    if (error != 0) {
        bus_program_no_interface("afo-walker", options->bus.interface, error);
        return -1;
    }
    session->start_ns = socketcan_now_ns();
    session->port = socketcan_bus_interface(&session->bus);
    struct can_bus bus[WALKER_NODES];
    for (int i = 0; i < WALKER_NODES; i++) {
        bus[i] = (struct can_bus){&node_ops, session};
    }
    const struct walker_drives drives = subject_drives(&session->config.subject);
    if (walker_nodes_init(&session->nodes, &session->config.plant, &drives, bus, 0, message) != 0) {
        complain(message);
        socketcan_bus_close(&session->bus);
        return -1;
    }
    listen_to_nodes_ids(session);
    return 0;
}

static void record(struct session *session)
{
    struct walk_event event;
    while (plant_next_event(&session->nodes.plant, &event)) {
        if (event.kind == WALK_EVENT_APEX && session->apexes < APEXES_MAX) {
            session->apex_speed_rad_s[session->apexes++] = event.value;
        } else if (event.kind == WALK_EVENT_FAULT) {
            session->falls++;
            snprintf(session->last_fall, sizeof session->last_fall, "%s",
                     walk_fault_name((enum walk_fault)(int)event.value));
        } else if (event.kind == WALK_EVENT_TAKE_HOLD) {
            session->held++;
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
        session->time_ns += session->last_sync_ns != 0 ? NS_PER_MS : 0;
        session->last_sync_ns = stamp_ns;
        session->by_clock = false;
        session->is_late = socketcan_bus_has_fetched(&session->bus, FRAME_SYNC);
        session->unanswered += session->is_late ? 1 : 0;
    }
    (void)walker_nodes_receive(&session->nodes, message, session->time_ns);
    if (is_sync) {
        /* Other protocols than CANopen speak by time, not when a SYNC says so. */
        walker_nodes_process(&session->nodes, session->time_ns);
        session->sync_ticks++;
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
        session->silences++;
        session->next_clock_ns = now_ns;
    }
    for (int i = 0; i < CLOCK_TICKS_AT_ONCE && now_ns >= session->next_clock_ns; i++) {
        session->next_clock_ns += NS_PER_MS;
        session->time_ns += NS_PER_MS;
        session->clock_ticks++;
        walker_nodes_process(&session->nodes, session->time_ns);
        finish_tick(session);
    }
    if (now_ns >= session->next_clock_ns) {
        session->next_clock_ns = now_ns + NS_PER_MS; /* the process was stopped: no burst */
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
        fprintf(stderr, "afo-walker: %s\n", advice);
    }
}

static void serve(struct session *session)
{
    const struct can_bus bus = socketcan_bus_interface(&session->bus);
    uint64_t now_ns = session->start_ns;
    const uint32_t steps = session->options.bus.steps;
    while (!bus_program_is_to_end() && (steps == 0 || session->apexes < steps)) {
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

/* ---- reporting ------------------------------------------------------------- */

static void report_json(const struct session *session)
{
    const struct can_bus_status *status = &session->bus.status;
    printf("{\"steps\": %u, \"falls\": %u, \"last_fall\": \"%s\", \"sync_ticks\": %llu, "
           "\"clock_ticks\": %llu, \"silences\": %llu, \"unanswered\": %llu, "
           "\"rx_frames\": %u, \"tx_frames\": %u, "
           "\"tx_refused\": %u, \"rx_overflow\": %u, \"error_frames\": %u, \"bus_off\": %u, "
           "\"kernel_full\": %u, \"went_down\": %u, \"apex_speed_rad_s\": [",
           session->apexes, session->falls, session->last_fall,
           (unsigned long long)session->sync_ticks, (unsigned long long)session->clock_ticks,
           (unsigned long long)session->silences, (unsigned long long)session->unanswered,
           status->rx_frames, status->tx_frames, status->tx_refused, status->rx_overflow,
           status->error_frames, status->bus_off_count, session->bus.counters.kernel_full,
           session->bus.counters.went_down);
    for (unsigned i = 0; i < session->apexes; i++) {
        printf("%s%.9g", i > 0 ? ", " : "", session->apex_speed_rad_s[i]);
    }
    puts("]}");
}

static void report_text(const struct session *session)
{
    const struct can_bus_status *status = &session->bus.status;
    printf("%u steps, %u falls%s%s\n", session->apexes, session->falls,
           session->falls > 0 ? ", last: " : "", session->last_fall);
    if (session->apexes > 0) {
        printf("last apex speed %.4f rad/s\n", session->apex_speed_rad_s[session->apexes - 1]);
    }
    printf("%llu ticks by SYNC (%llu heard too late to be answered), %llu by the clock in %llu "
           "silences\n",
           (unsigned long long)session->sync_ticks, (unsigned long long)session->unanswered,
           (unsigned long long)session->clock_ticks, (unsigned long long)session->silences);
    printf("%s: %u frames received, %u sent, %u refused, %u lost in the queue, %u error frames, "
           "%u times bus-off, %u times down\n",
           session->options.bus.interface, status->rx_frames, status->tx_frames, status->tx_refused,
           status->rx_overflow, status->error_frames, status->bus_off_count,
           session->bus.counters.went_down);
}

int main(int argc, char **argv)
{
    static struct session session;
    bus_program_catch_signals();
    parse_options(&session.options, argc, argv);
    if (prepare(&session) != 0) {
        return EXIT_USAGE;
    }
    serve(&session);
    walker_nodes_free(&session.nodes);
    socketcan_bus_close(&session.bus);
    if (session.options.bus.json) {
        report_json(&session);
    } else if (!session.options.bus.quiet) {
        report_text(&session);
    }
    if (output_standard_done("afo-walker") != 0) {
        return EXIT_USAGE;
    }
    return session.falls > 0 ? EXIT_FELL : EXIT_WALKED;
}
