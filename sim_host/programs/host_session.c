#include "sim_host/programs/host_session.h"

#include <errno.h>
#include <stdio.h>
#include <unistd.h>

#include "firmware/version.h"
#include "hal/bus/frame_table.h"
#include "model/tick.h"
#include "sim_host/cli/program.h"
#include "sim_host/loop/lock_step.h"

#define TICK_NS ((uint64_t)TICK_PERIOD_US * 1000u)
#define LISTEN_NS UINT64_C(1000000000)
#define RECOVERY_NS UINT64_C(100000000)
/* Waking up from the wait for frames may take so long. What comes later is not lost: it waits
 * in the kernel, in its place before the next SYNC. */
#define REAL_TIME_MARGIN_NS (3 * TICK_NS / 10)
/* A stop that was asked for must have unloaded the springs by then; what the bus does not
 * take is set directly. */
enum { STOP_TICKS = TICKS_OF_MS(3000), STOP_ASK_TICKS = TICKS_OF_MS(100), SILENT_CYCLES = 40 };
/* So many answers in a row that did not come, and nobody is waited for any more. */
enum { PATIENT_CYCLES = 3 };
/* After the last step asked for its telemetry has still to come out. */
enum { LAST_FRAMES_TICKS = 3 };
/* Between two resets of --auto-reset: the drives take theirs at a rising edge. */
enum { RESET_TICKS = TICKS_OF_MS(50) };
/* A log that names its build early is known by its beginning. */
enum { IDENTITY_TICK = 10 };

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

static void tell_interface(struct host *host)
{
    const struct socketcan_counters *counters = &host->socket.counters;
    const char *name = host->options.bus.interface;
    if (counters->went_down != host->told_down) {
        program_complain("%s is down, nothing is sent or heard", name);
        host->told_down = counters->went_down;
    }
    if (counters->came_back != host->told_up) {
        program_complain("%s is up again", name);
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
        program_complain("%s is bus-off: the controller chip took itself off the bus", name);
    }
    if (host->is_bus_off && status->error_state != CAN_BUS_OFF) {
        host->is_bus_off = false;
        program_complain("%s is on the bus again", name);
    }
    if (socketcan_bus_advice(&host->socket, advice, sizeof advice)) {
        program_complain("%s", advice);
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
    return start_ns + (awaited && host->unanswered < PATIENT_CYCLES
                           ? host->options.answer_timeout_ns
                           : TICK_NS);
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
        host->options.answer_timeout_ns < LISTEN_NS ? host->options.answer_timeout_ns : LISTEN_NS;
    const uint64_t end_ns = socketcan_now_ns() + limit_ns;
    do {
        (void)control_task_poll(&host->rig.task);
        (void)socketcan_bus_wait(&host->socket, end_ns);
    } while (!lock_step_knows_all(&host->rig.task) && socketcan_now_ns() < end_ns &&
             !bus_program_is_to_end());
}

void host_session_run(struct host *host)
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
