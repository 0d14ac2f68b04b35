#include "firmware/control_task.h"

#include <assert.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/contract.h"
#include "hal/devices/duplicate_id.h"

static_assert(sizeof(real) == sizeof(float), "the flown controller is float32");

enum { FORCE_STOP_TICKS = 50 };

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

static void show_counters(void *context)
{
    struct control_task *task = (struct control_task *)context;
    struct controller_counters *counters = &task->node.objects.counters;
    struct can_bus_status status;
    can_bus_get_status(&task->config.bus, &status);
    counters->ticks = task->tick;
    counters->rx_malformed = saturating_sum(
        saturating_sum(task->sensors.rx_malformed, *task->config.drives.rx_malformed),
        task->node.device.counters.malformed);
    counters->tx_refused = status.tx_refused;
    counters->rx_overflow = status.rx_overflow;
    counters->bus_off_count = status.bus_off_count;
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
    leg_sensors_init(&task->sensors, config->leg_sensor);
    const int node = controller_node_init(&task->node, config->params, config->desired_speed_rad_s,
                                          config->walk_requested, config->bus);
    HAL_ASSERT(node == 0); /* the dictionary is a constant of the build */
    (void)node;
    task->node.show_counters = show_counters;
    task->node.show_context = task;
    task->config.params = &task->node.objects.params;
    return controller_init(&task->controller, task->config.params);
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

static void collect_input(struct control_task *task, struct controller_input *input)
{
    *input = (struct controller_input){
        .tick = task->tick,
        .desired_speed_rad_s = task->node.objects.desired_speed_rad_s,
        .nodes_operational = network_all_operational(&task->network),
        .node_error = network_has_error(&task->network),
        .emergency_stop = task->emergency_stop,
        .parameters_corrupt = controller_node_params_corrupt(&task->node),
        .walk_requested = task->node.objects.walk_requested != 0 && may_start(task),
        .reset_requested = task->node.objects.reset_requested != 0,
        .zero_requested = task->node.objects.zero_requested != 0};
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct leg_sensor_reading *reading = &task->sensors.reading[leg];
        struct sea_drive_reading drive;
        sea_drives_read(&task->config.drives, (enum side)leg, &drive);
        input->leg[leg] = (struct leg_measurement){reading->leg_angle_rad,
                                                   reading->ankle_extension_m, reading->age_ticks};
        input->sea[leg] =
            (struct sea_measurement){drive.precompression_m, (enum drive_state)drive.state,
                                     drive.age_ticks,        (enum latch_state)drive.latch,
                                     drive.force_N,          drive.force_age_ticks};
        if (input->nodes_operational && (reading->age_ticks != 0 || drive.age_ticks != 0)) {
            count(&task->node.objects.counters.late_answers);
        }
        task->foreign =
            task->foreign || drive.foreign || reading->duplicate_id_count >= DUPLICATE_ID_LIMIT;
    }
    input->foreign_node = task->foreign;
}

/* Returns true when the bus took them all. */
static bool send_commands(struct control_task *task)
{
    struct sea_drive_command wish[SIDE_COUNT];
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct sea_request *command = &task->output.sea[leg];
        wish[leg] = (struct sea_drive_command){command->precompression_m, command->enable,
                                               command->latch_armed,
                                               task->node.objects.reset_requested != 0};
    }
    const bool sent = sea_drives_command(&task->config.drives, wish, &task->config.bus) == CAN_OK;
    if (!sent) {
        count(&task->node.objects.counters.send_failures);
    }
    return sent;
}

/* A drive that still follows its target a while after the torque was to be off has not
 * understood its controlword: stopped (NMT) it unloads by itself (0x6007). */
static void force_stop(struct control_task *task)
{
    const bool stops =
        task->output.state == SUPERVISOR_UNLOADING || task->output.state == SUPERVISOR_FAULT;
    bool off = true;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        struct sea_drive_reading drive = {.state = DRIVE_DISABLED};
        if (stops) {
            sea_drives_read(&task->config.drives, (enum side)leg, &drive);
        }
        const bool heard = drive.age_ticks <= FORCE_STOP_TICKS;
        off = off && heard && (drive.state == DRIVE_DISABLED || drive.state == DRIVE_FAULT);
        /* What a silent one said last may be of before it was switched off and on. */
        const bool disobeys =
            heard && task->output.state == SUPERVISOR_FAULT && drive.state == DRIVE_ENABLED;
        /* One telegram that says otherwise does not outweigh the others. */
        if (disobeys) {
            task->disobeys[leg]++;
        } else if (task->disobeys[leg] > 0) {
            task->disobeys[leg]--;
        }
        if (task->disobeys[leg] >= FORCE_STOP_TICKS) {
            task->disobeys[leg] = 0;
            count(&task->node.objects.counters.forced_stops);
            (void)network_command(&task->config.bus, NMT_STOP, (uint8_t)(NODE_DRIVE_LEFT + leg));
        }
    }
    if (off) {
        task->powered_ticks = 0;
    } else if (task->powered_ticks < CONTROL_TASK_POWER_TICKS) {
        task->powered_ticks++;
    }
    /* Whoever speaks with our identifiers is heard by the drives as we are: no command of
     * ours could outdo theirs, and no answer be trusted. Stopped, a drive obeys no PDO. */
    if (task->foreign) {
        count(&task->node.objects.counters.forced_stops);
        (void)network_stop_all(&task->network, &task->config.bus);
    }
}

/* Sets up the nodes one after the other, as they appear, and keeps the bits of
 * those that may be started. A node that is silent or boots again starts over; one that is
 * stopped answers no SDO, and waits. */
static void configure_nodes(struct control_task *task)
{
    struct node_setup *setup = &task->setup;
    if (!task->config.configure_nodes) {
        task->configured = (1u << NETWORK_NODES) - 1u;
        return;
    }
    for (unsigned i = 0; i < NETWORK_NODES; i++) {
        const struct network_node *node = &task->network.node[i];
        const bool is_new = node->state == NMT_UNKNOWN || node->booted;
        if (is_new) {
            task->configured = (uint8_t)(task->configured & ~(1u << i));
        }
        if ((is_new || node->stop_pending) && setup->node == node->id) {
            setup->node = 0;
        }
    }
    network_clear_booted(&task->network);
    for (unsigned i = 0; i < NETWORK_NODES && setup->node == 0; i++) {
        const struct network_node *node = &task->network.node[i];
        if (node->state != NMT_UNKNOWN && !node->stop_pending &&
            (task->configured & (1u << i)) == 0) {
            node_setup_start(setup, &task->config.setup, node->id, task->now_ns);
            network_command(&task->config.bus, NMT_ENTER_PRE_OPERATIONAL, setup->node);
        }
    }
    if (setup->node == 0 || setup->failure.verdict != SETUP_DONE) {
        return;
    }
    const enum setup_verdict verdict = node_setup_poll(setup, &task->config.bus, task->now_ns);
    if (verdict == SETUP_DONE) {
        task->configured = (uint8_t)(task->configured | 1u << network_index(setup->node));
        controller_node_setup_done(&task->node, setup->node);
        setup->node = 0;
    } else if (verdict < SETUP_DONE) {
        controller_node_report_setup(&task->node, &setup->failure);
        if (verdict == SETUP_SILENT) {
            setup->node = 0; /* a frame may have been lost: from the start again */
        }
    }
}

static unsigned run_tick(struct control_task *task)
{
    struct controller_input input;
    task->tick++;
    task->sync_waits = 0;
    task->now_ns += TICK_PERIOD_US * UINT64_C(1000);
    task->emergency_stop = emergency_stop_is_pressed(&task->config.stop);
    collect_input(task, &input);
    controller_update(&task->controller, &input, &task->output);
    const bool sent = send_commands(task);
    force_stop(task);
    task->node.objects.reset_requested = 0;
    task->node.objects.zero_requested = 0;
    task->node.objects.input_digest = task->node.objects.input_digest * UINT32_C(16777619) + 1u;
    configure_nodes(task);
    network_update(&task->network, &task->config.bus, task->configured);
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

/* A sum over the frames of a tick, so that their order within it does not count
 * (a controller may sort them into several queues), of a hash that any changed bit
 * changes: FNV-1a's step (isthe.com/chongo/tech/comp/fnv) over words. */
static uint32_t frame_hash(const struct can_msg *message)
{
    const uint32_t prime = UINT32_C(16777619);
    uint32_t hash = (UINT32_C(2166136261) ^ (message->id << 4 | message->length)) * prime;
    hash = (hash ^ bytes_get_u32(message->data)) * prime;
    return (hash ^ bytes_get_u32(message->data + 4)) * prime;
}

static void take_frame(struct control_task *task, const struct can_msg *message)
{
    const bool masters = frame_is_masters(message->id);
    task->foreign = task->foreign || masters;
    if (!masters && (leg_sensors_receive(&task->sensors, message) ||
                     sea_drives_receive(&task->config.drives, message) ||
                     network_receive(&task->network, message) ||
                     node_setup_receive(&task->setup, message, task->now_ns) ||
                     controller_node_receive(&task->node, message, task->now_ns))) {
        task->node.objects.input_digest += frame_hash(message);
        return;
    }
    count(&task->node.objects.counters.foreign_frames);
    if (masters) {
        task->node.objects.input_digest += frame_hash(message);
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
            take_frame(task, &message);
        }
    }
    return progress;
}

bool control_task_power_must_go(const struct control_task *task)
{
    return task->powered_ticks >= CONTROL_TASK_POWER_TICKS;
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
