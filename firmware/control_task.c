#include "firmware/control_task.h"

#include <assert.h>

#include "firmware/commissioning_objects.h"
#include "firmware/input_digest.h"
#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/contract.h"
#include "hal/devices/duplicate_id.h"

static_assert(sizeof(real) == sizeof(float), "the flown controller is float32");

static void count(uint32_t *counter)
{
    if (*counter < UINT32_MAX) {
        (*counter)++;
    }
}

static uint32_t saturating_sum(uint32_t a, uint32_t b)
{
    return a > UINT32_MAX - b ? UINT32_MAX : a + b;
}

static void show_counters(struct control_task *task)
{
    struct controller_counters *counters = &task->node.objects.counters;
    struct can_bus_status status;
    can_bus_get_status(&task->config.bus, &status);
    counters->ticks = task->tick;
    counters->rx_malformed = saturating_sum(
        saturating_sum(task->sensors.rx_malformed, *task->config.drives.rx_malformed),
        task->node.device.counters.malformed);
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct push_leg *push = &task->controller.springs.watch.leg[leg];
        for (int outcome = 0; outcome < PUSH_OUTCOMES; outcome++) {
            counters->pushes[leg][outcome] = push->count[outcome];
        }
        counters->behind_ticks[leg] = push->behind_ticks;
    }
    counters->tx_refused = status.tx_refused;
    counters->rx_overflow = status.rx_overflow;
    counters->bus_off_count = status.bus_off_count;
}

/* All of it at once would be much beside a tick's own work. */
static void show(void *context, uint16_t index)
{
    struct control_task *task = (struct control_task *)context;
    switch (index) {
    case CONTROLLER_INDEX_COUNTERS:
        show_counters(task);
        break;
    case CONTROLLER_INDEX_DRIVES:
        drive_care_show(&task->node.objects, &task->controller.derate, &task->config.drives);
        break;
    case CONTROLLER_INDEX_STATE:
        task->node.objects.cue = (uint8_t)controller_cue(&task->controller);
        break;
    default:
        commissioning_show(&task->node.objects, &task->controller.motion, &task->sensors,
                           &task->config.drives);
        break;
    }
}

static bool has_numbers(const struct node_setup_config *setup)
{
    unsigned sum = 0;
    for (int role = 0; role < NETWORK_NODES; role++) {
        sum += setup->node[role];
    }
    return sum > 0;
}

int control_task_init(struct control_task *task, const struct control_task_config *config)
{
    const int verdict = control_params_validate(config->params);
    *task = (struct control_task){.config = *config};
    if (verdict != CONTROL_PARAMS_OK) {
        return verdict;
    }
    task->emergency_stop = true; /* unknown until read */
    network_init(&task->network);
    if (has_numbers(&config->setup)) {
        network_set_nodes(&task->network, config->setup.node);
    }
    leg_sensors_init(&task->sensors, config->leg_sensor);
    const int node = controller_node_init(&task->node, config->params, config->desired_speed_rad_s,
                                          config->walk_requested, config->bus);
    HAL_ASSERT(node == 0); /* the dictionary is a constant of the build */
    (void)node;
    task->node.rules.show = show;
    task->node.rules.show_context = task;
    task->config.params = &task->node.objects.params;
    return controller_init(&task->controller, task->config.params);
}

void control_task_describe(struct control_task *task, const struct device_description *device)
{
    task->node.objects.device = *device;
    drive_care_init(task->config.limits, &task->node.objects, device);
}

/* Off the bus, what waited to be sent is lost: also a SYNC. */
static bool bus_is_off(const struct control_task *task)
{
    struct can_bus_status status;
    can_bus_get_status(&task->config.bus, &status);
    return status.error_state == CAN_BUS_OFF;
}

enum can_result control_task_start_cycle(struct control_task *task)
{
    const struct can_msg sync = {.id = FRAME_SYNC, .length = FRAME_BYTES_SYNC};
    if (task->sync_waits > 0 && task->sync_waits < CONTROL_TASK_SYNC_WAIT && !bus_is_off(task)) {
        task->sync_waits++;
        count(&task->node.objects.counters.syncs_refused);
        return CAN_FULL;
    }
    const enum can_result result = can_bus_send(&task->config.bus, &sync);
    task->sync_waits = result == CAN_OK ? 1 : 0;
    count(result == CAN_OK ? &task->node.objects.counters.syncs_sent
                           : &task->node.objects.counters.syncs_refused);
    return result;
}

/* The tick wraps after 49 days, the time does not; a task that goes on from a snapshot has
 * the tick but a new time. */
static bool may_start(const struct control_task *task)
{
    return task->tick >= CONTROL_TASK_START_TICK ||
           task->now_ns >= (uint64_t)CONTROL_TASK_START_TICK * TICK_PERIOD_US * 1000u;
}

/* Pure: what this tick shows the controller. */
static void collect_input(const struct control_task *task, struct controller_input *input)
{
    *input = (struct controller_input){
        .tick = task->tick,
        .desired_speed_rad_s = task->node.objects.desired_speed_rad_s,
        .nodes_operational = network_all_operational(&task->network),
        .node_error = network_has_error(&task->network),
        .emergency_stop = task->emergency_stop,
        .foreign_node = task->foreign,
        .node_written = tool_watch_is_written(&task->tools),
        .node_changed = task->audit.memory.deviates != 0,
        .parameters_corrupt = task->node.guard.corrupt,
        .walk_requested = task->node.objects.walk_requested != 0 && may_start(task),
        .wearer_pressed = (task->node.objects.wearer_pin | task->node.objects.wearer_button) != 0,
        .reset_requested = task->node.objects.reset_requested != 0,
        .zero_requested = task->node.objects.zero_requested != 0,
        .motion = commissioning_request(&task->node.objects)};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct leg_sensor_reading *reading = &task->sensors.reading[leg];
        struct sea_drive_reading drive;
        sea_drives_read(&task->config.drives, (enum side)leg, &drive);
        input->leg[leg] = (struct leg_measurement){
            reading->leg_angle_rad, reading->ankle_extension_m, reading->age_ticks, reading->foot};
        input->sea[leg] = (struct sea_measurement){
            drive.precompression_m, drive.state,           drive.age_ticks, drive.latch,
            drive.force_N,          drive.force_age_ticks, drive.absent,    drive.contact};
        input->foreign_node = input->foreign_node || drive.foreign ||
                              reading->duplicate_id_count >= DUPLICATE_ID_LIMIT;
    }
}

static void count_late_answers(struct controller_counters *counters,
                               const struct controller_input *input)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if (input->nodes_operational &&
            (input->leg[leg].age_ticks != 0 || input->sea[leg].age_ticks != 0)) {
            count(&counters->late_answers);
        }
    }
}

/* Returns true when the bus took them all. */
static bool send_commands(struct control_task *task)
{
    struct sea_drive_command command[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct sea_request *request = &task->output.sea[leg];
        const unsigned index = NETWORK_DRIVE_LEFT + (unsigned)leg;
        command[leg] = (struct sea_drive_command){
            .precompression_m = request->precompression_m,
            .enable = request->enable && (task->tools.shut_down & (1u << leg)) == 0,
            .latch_armed = request->latch_armed,
            .clear_fault = task->node.objects.reset_requested != 0,
            .repeat = tool_watch_is_written(&task->tools),
            .unconfigured = task->network.node[index].id != 0 &&
                            !bring_up_is_configured(&task->bring_up, index),
            .operational = task->network.node[index].state == NMT_OPERATIONAL};
    }
    if (task->output.cut_off) {
        return true; /* what was meant to be sent: nothing */
    }
    const bool sent =
        sea_drives_command(&task->config.drives, command, &task->config.bus) == CAN_OK;
    if (!sent) {
        count(&task->node.objects.counters.send_failures);
    }
    return sent;
}

/* A drive of another protocol cannot be stopped so: then its latch board is. */
static void stop_leg(struct control_task *task, unsigned leg)
{
    const struct network_node *node = task->network.node;
    const uint8_t drive = node[NETWORK_DRIVE_LEFT + leg].id;
    const uint8_t stopped = drive != 0 ? drive : node[NETWORK_LATCH_LEFT + leg].id;
    if (stopped != 0) {
        (void)network_command(&task->config.bus, NMT_STOP, stopped);
    }
}

static void stop_by_nmt(struct control_task *task, unsigned legs)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        if ((legs & (1u << leg)) != 0) {
            count(&task->node.objects.counters.forced_stops);
            stop_leg(task, (unsigned)leg);
        }
    }
    /* Whoever speaks with our identifiers is heard by the drives as we are: no command of
     * ours could outdo theirs, and no answer is safe to use. Stopped, a drive obeys no PDO. */
    if (task->foreign) {
        count(&task->node.objects.counters.forced_stops);
        (void)network_stop_all(&task->network, &task->config.bus);
    }
}

static void bring_nodes_up(struct control_task *task)
{
    if (!task->config.configure_nodes) {
        bring_up_skip(&task->bring_up);
        return;
    }
    struct controller_node *node = &task->node;
    const struct bring_up_result result = bring_up_update(
        &task->bring_up, &task->network, &task->config.setup, &task->config.bus, task->now_ns);
    if (result.verdict == SETUP_DONE) {
        telemetry_clear_refused_node(&node->objects, &node->device, result.node);
    } else if (result.verdict < SETUP_DONE) {
        telemetry_report_refused_node(&node->objects, &node->device, &task->bring_up.setup.failure);
    }
}

/* A drive that is no longer as it was set up is treated like one that somebody wrote to. */
static void audit_drives(struct control_task *task, bool busy)
{
    struct setup_failure found;
    struct controller_node *node = &task->node;
    if (drive_audit_update(&task->audit, &task->bring_up, &task->network, &task->config.bus,
                           task->tick, busy, task->now_ns, &found,
                           &node->objects.counters.audits_unanswered)) {
        telemetry_report_refused_node(&node->objects, &node->device, &found);
        tool_watch_distrust(&task->tools, network_index(&task->network, found.node), found.index);
    }
}

static unsigned run_tick(struct control_task *task)
{
    struct controller_input input;
    task->tick++;
    task->sync_waits = 0;
    task->now_ns += TICK_PERIOD_US * UINT64_C(1000);
    task->emergency_stop = emergency_stop_is_pressed(&task->config.stop);
    params_guard_scan(&task->node.guard, &task->node.objects.params, task->node.objects.params_crc);
    collect_input(task, &input);
    count_late_answers(&task->node.objects.counters, &input);
    task->foreign = input.foreign_node;
    controller_update(&task->controller, &input, &task->output);
    const unsigned stuck =
        task->output.state == SUPERVISOR_UNLOADING
            ? tool_watch_find_stuck(&task->tools, &task->config.drives, task->output.sea,
                                    task->node.objects.params.leg_length_m)
            : 0;
    const bool sent = send_commands(task);
    stop_by_nmt(task,
                stuck | drive_watch_update(&task->watch, &task->config.drives, task->output.state,
                                           task->output.sea, &task->node.objects.params));
    tool_watch_end_tick(&task->tools, &task->bring_up, &task->config.drives,
                        supervisor_may_enable(task->output.state));
    task->node.objects.reset_requested = 0;
    task->node.objects.zero_requested = 0;
    input_digest_end_tick(&task->node.objects.input_digest);
    bring_nodes_up(task);
    const bool busy = control_task_was_busy(task);
    if (task->config.configure_nodes) {
        audit_drives(task, busy);
    }
    drive_care_update(&task->controller, task->config.limits, &task->config.drives, task->tick,
                      busy || task->audit.under_way, &task->node.device);
    network_update(&task->network, &task->config.bus, task->bring_up.configured);
    controller_node_update(&task->node, &task->controller, &task->output, task->emergency_stop,
                           task->now_ns);
    task->foreign = false;
    sea_drives_age(&task->config.drives);
    leg_sensors_age(&task->sensors);
    const struct supervisor *supervisor = &task->controller.supervisor;
    return CONTROL_TASK_TICKED | (sent ? (unsigned)CONTROL_TASK_COMMANDED : 0u) |
           (supervisor->updated_tick == task->tick ? (unsigned)CONTROL_TASK_SUPERVISED : 0u) |
           (task->output.new_step ? (unsigned)CONTROL_TASK_NEW_STEP : 0u);
}

static bool hear_tool(struct control_task *task, const struct can_msg *message)
{
    const bool heard = tool_watch_receive(&task->tools, &task->network, &task->bring_up, message,
                                          &task->node.objects);
    if (heard) {
        drive_audit_give_way(&task->audit);
    }
    return heard;
}

static void deliver_frame(struct control_task *task, const struct can_msg *message)
{
    const bool masters = frame_is_masters(message->id);
    task->foreign = task->foreign || masters;
    if (!masters &&
        (leg_sensors_receive(&task->sensors, message) ||
         sea_drives_receive(&task->config.drives, message) || hear_tool(task, message) ||
         drive_audit_receive(&task->audit, &task->bring_up, message, task->now_ns) ||
         network_receive(&task->network, message) ||
         node_setup_receive(&task->bring_up.setup, message, task->now_ns) ||
         controller_node_receive(&task->node, message, task->now_ns))) {
        input_digest_add(&task->node.objects.input_digest, message);
        return;
    }
    count(&task->node.objects.counters.foreign_frames);
    if (masters) {
        input_digest_add(&task->node.objects.input_digest, message);
    }
}

unsigned control_task_poll(struct control_task *task)
{
    unsigned progress = 0;
    struct can_msg message;

    for (int i = 0; i < CONTROL_TASK_POLL_FRAMES; i++) {
        if (can_bus_receive(&task->config.bus, &message, NULL) != CAN_OK) {
            break;
        }
        if (message.flags & CAN_FRAME_ERROR) {
            count(&task->node.objects.counters.error_frames);
        } else if ((message.flags & CAN_FRAME_OWN) != 0) {
            if (message.id == FRAME_SYNC) {
                progress |= CONTROL_TASK_BUS_ALIVE | run_tick(task);
            }
        } else {
            deliver_frame(task, &message);
        }
    }
    return progress;
}

bool control_task_cycle_complete(const struct control_task *task)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive;
        sea_drives_read(&task->config.drives, (enum side)leg, &drive);
        if (task->sensors.reading[leg].age_ticks != 0 || drive.age_ticks != 0) {
            return false;
        }
    }
    return true;
}

bool control_task_was_busy(const struct control_task *task)
{
    const struct gait_observer *observer = &task->controller.observer;
    const struct gait_event *event = observer->state.event;

    return task->output.new_step || event[GAIT_APEX].happened || event[GAIT_HEEL_STRIKE].happened ||
           event[GAIT_LIFT_OFF].happened || observer->apex.work.busy ||
           task->bring_up.setup.under_way || task->audit.under_way ||
           task->controller.derate.tick == task->tick || observer->model.since_tick == task->tick;
}

void control_task_show_cycles(struct control_task *task, uint32_t cycles)
{
    struct controller_counters *counters = &task->node.objects.counters;

    counters->worst_cycles = cycles > counters->worst_cycles ? cycles : counters->worst_cycles;
}
