/* afo host: the control task on Linux, on a real CAN interface. */
#include <stdio.h>

#include "firmware/version.h"
#include "hal/bus/frame_table.h"
#include "sim_host/bus/bus_budget.h"
#include "sim_host/cli/exit_status.h"
#include "sim_host/cli/program.h"
#include "sim_host/programs/commands.h"
#include "sim_host/programs/host_session.h"

/* ---- opening --------------------------------------------------------------- */

#define SENDER(name, id, bytes, period_us, deadline_us, node, kind) {id, node},
static const struct {
    uint16_t id;
    uint8_t sender;
} table[] = {FRAME_TABLE(SENDER)};
#undef SENDER

/* Nodes of other numbers, and latch boards, answer with identifiers that the table does not have. */
static bool has_numbers_of_the_table(const struct subject *subject)
{
    static const int32_t drives[SIDE_COUNT] = {NODE_DRIVE_LEFT, NODE_DRIVE_RIGHT};
    static const int32_t sensors[SIDE_COUNT] = {NODE_SENSOR_LEFT, NODE_SENSOR_RIGHT};
    bool same = true;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &subject->device.description.leg[leg];
        same = same && own->drive_node == drives[leg] && own->leg_sensor_node == sensors[leg] &&
               own->latch != DEVICE_LATCH_BOARD && !device_leg_ankle_is_apart(own);
    }
    return same;
}

static int open_bus(struct host *host)
{
    const struct socketcan_filter answers = {FRAME_SDO_ANSWER_CONTROLLER, CAN_ID_STANDARD_MAX};
    struct socketcan_filter filters[SOCKETCAN_FILTERS_MAX];
    unsigned count = 0;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        const bool heard = table[i].sender != NODE_CONTROLLER || frame_is_masters(table[i].id) ||
                           frame_is_node_request(table[i].id);
        if (heard && table[i].id != FRAME_SYNC && count < SOCKETCAN_FILTERS_MAX) {
            filters[count++] = (struct socketcan_filter){table[i].id, CAN_ID_STANDARD_MAX};
        }
    }
    if (!host_task_configures(&host->subject) || !has_numbers_of_the_table(&host->subject)) {
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
    bus_program_no_interface(host->options.bus.interface, error);
    return -1;
}

static void close_bus(struct host *host)
{
    socketcan_bus_close(&host->operator_socket);
    socketcan_bus_close(&host->socket);
}

/* The bus, with the black box before it. */
static struct can_bus recorded_bus(struct host *host)
{
    const struct can_bus bus = socketcan_bus_interface(&host->socket);
    const struct snapshot_source source = {&host->rig.task, &host->rig.drives};
    black_box_start(&host->black_box, version_build_id(), params_guard_crc(&host->params));
    bus_recorder_init(&host->recorder, &bus, &host->black_box, &source);
    return bus_recorder_interface(&host->recorder);
}

int afo_host(int argc, char **argv)
{
    static struct host host;
    char message[SUBJECT_MESSAGE_MAX] = "";

    host_options_parse(&host.options, argc, argv);
    bus_program_catch_signals();
    if (walk_options_resolve(&host.options.walk, &host.subject, &host.params, &host.speed_rad_s,
                             message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    if (bus_budget_check_build(message, sizeof message) != 0) {
        program_complain("%s", message);
        return EXIT_USAGE;
    }
    if (open_bus(&host) != 0) {
        return EXIT_USAGE;
    }
    if (host_task_init(&host.rig, &host.subject, &host.params, recorded_bus(&host),
                       host.speed_rad_s, !host.options.standby) != CONTROL_PARAMS_OK) {
        program_complain("the control task refuses these parameters");
        close_bus(&host);
        return EXIT_USAGE;
    }
    if (host.recorder.box != NULL) {
        controller_node_attach(&host.rig.task.node, NULL, NULL, host.recorder.box, NULL, NULL);
    }
    host_session_run(&host);
    host.figures.went_down = host.socket.counters.went_down;
    if (host.options.bus.json) {
        host_report_json(&host.rig.task, &host.figures, &host.pacer);
    } else if (!host.options.bus.quiet) {
        host_report_text(&host.rig.task, &host.figures,
                         host.options.real_time ? &host.pacer : NULL);
    }
    const enum supervisor_fault fault = host.rig.task.output.fault;
    if (fault != SUPERVISOR_FAULT_NONE) {
        program_complain("stopped by a fault: %s", supervisor_fault_name(fault));
    }
    const bool faulty = fault != SUPERVISOR_FAULT_NONE || host_report_is_refused(&host.rig.task);
    close_bus(&host);
    if (program_output_done() != 0) {
        return EXIT_USAGE;
    }
    return faulty ? EXIT_BAD : EXIT_GOOD;
}
