/* The control task at work on a real bus: its cycles in real time or lock-step, what an operator would
 * ask for, and the end. Opened and closed by host.c. */
#ifndef SIM_HOST_PROGRAMS_HOST_SESSION_H
#define SIM_HOST_PROGRAMS_HOST_SESSION_H

#include "firmware/bus_recorder.h"
#include "hal/port_socketcan/socketcan_bus.h"
#include "sim_host/cli/host_options.h"
#include "sim_host/cli/host_report.h"
#include "sim_host/cli/operator_line.h"
#include "sim_host/loop/pacer.h"
#include "sim_host/subjects/host_task.h"

struct host {
    struct host_options options;
    struct subject subject;
    struct control_params params;
    double speed_rad_s;
    struct socketcan_bus socket, operator_socket;
    struct operator_line operator_line;
    struct host_task rig;
    struct bus_recorder recorder;
    struct black_box black_box; /* read it with afo blackbox */
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

/* Runs the control task until it is to end, then until the drives are off or nobody answers. host: the
 * options parsed, the sockets open, the task set up. */
void host_session_run(struct host *host);

#endif
