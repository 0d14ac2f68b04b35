#include "sim_host/nodes/drive_node.h"

#include <string.h>

#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "sim_host/nodes/drive_state.h"
#include "sim_host/nodes/node_numbers.h"

enum {
    MODE_INTERPOLATED_POSITION = 7,
    MODE_CYCLIC_SYNCHRONOUS_POSITION = 8,
    SUPPORTS_INTERPOLATED_POSITION = 1 << 6,
    SUPPORTS_CYCLIC_SYNCHRONOUS_POSITION = 1 << 7,
    ENCODER_INCREMENTS = 65536,
    COARSE_ENCODER_INCREMENTS = 1024, /* below ENCODER_INCREMENTS counts a metre */
    FOLLOWING_TIMEOUT_MS = 100,
    TARGET_TIMEOUT_MS = 50,
    OPTION_UNLOAD = 1,
    OPTION_QUICK_STOP_RAMP = 2,
    OPTION_ABORT_IS_FAULT = 1,
    PROFILE_DRIVE = 402,
    SERVO_DRIVE = 2
};

static const double NS_PER_S = 1e9;

static const uint32_t OUTPUT_BRAKE = 1U << 0;
static const uint32_t INPUT_LATCH_CLOSED = 1U << 16;

/* The count at which the motor stands at `metres` of spring, and back. */
static int32_t counts_at(const struct drive_node_config *config, double metres)
{
    const int32_t travel = node_round_i32(metres * (double)config->counts_per_m);
    return config->zero_counts + (config->inverted ? -travel : travel);
}

static double metres_at(const struct drive_node_config *config, int32_t counts)
{
    const double travel = (double)counts - (double)config->zero_counts;
    return (config->inverted ? -travel : travel) / (double)config->counts_per_m;
}

/* mNm at the motor for a force of the spring: its work a metre is that of the motor's turns. */
static uint32_t rated_torque_mNm(const struct drive_node_config *config, uint32_t counts_per_turn)
{
    const double turns_per_m = (double)config->counts_per_m / (double)counts_per_turn;
    return (uint32_t)node_round_i32(config->rated_force_N * 1000.0 /
                                    (6.283185307179586 * turns_per_m));
}

static void default_pdos(const struct drive_node *node, struct co_comm *comm)
{
    const uint32_t id = node->config.node_id;
    const uint32_t dummy = UINT32_C(0x00040020);
    const uint32_t target = UINT32_C(0x607A0020);
    const bool left = node->config.side == SIDE_LEFT;
    comm->rpdo[0].cob_id = FRAME_DRIVE_TARGETS;
    comm->rpdo[0].type = 1;
    comm->rpdo[0].event_ms = TARGET_TIMEOUT_MS;
    comm->rpdo[0].map[0] = left ? target : dummy;
    comm->rpdo[0].map[1] = left ? dummy : target;
    comm->rpdo[0].map_count = 2;
    comm->rpdo[1].cob_id = 0x300 + id;
    comm->rpdo[1].type = CO_EVENT_PROFILE;
    comm->rpdo[1].map[0] = UINT32_C(0x60400010);
    comm->rpdo[1].map[1] = UINT32_C(0x60FE0120);
    comm->rpdo[1].map_count = 2;
    comm->tpdo[0].cob_id = 0x180 + id;
    comm->tpdo[0].type = 1;
    comm->tpdo[0].map[0] = UINT32_C(0x60410010);
    comm->tpdo[0].map[1] = UINT32_C(0x60640020);
    comm->tpdo[0].map_count = 2;
    comm->tpdo[2].cob_id = 0x380 + id;
    comm->tpdo[2].type = SLOW_PDO_TICKS;
    comm->tpdo[2].map[0] = UINT32_C(0x60770010);
    comm->tpdo[2].map[1] = UINT32_C(0x21000010);
    comm->tpdo[2].map[2] = UINT32_C(0x60790020);
    comm->tpdo[2].map_count = 3;
}

static void defaults(void *context, struct co_comm *comm)
{
    const struct drive_node *node = context;
    comm->device_type = (uint32_t)SERVO_DRIVE << 16 | PROFILE_DRIVE;
    strcpy(comm->name, "AFO virtual SEA drive");
    strcpy(comm->hardware_version, "1");
    strcpy(comm->software_version, "1");
    comm->product = 0x402;
    comm->revision = 0x00010000;
    comm->serial = node->config.node_id;
    comm->heartbeat_ms = HEARTBEAT_PERIOD_MS;
    comm->consumer[0] = (uint32_t)NODE_CONTROLLER << 16 | HEARTBEAT_TIMEOUT_MS;
    comm->emcy_inhibit_100us = 100;
    comm->communication_error_behaviour = 1; /* stays visible; the axis reacts itself */
    default_pdos(node, comm);
}

static int8_t only_mode(const struct drive_node_config *config)
{
    return config->interpolated ? MODE_INTERPOLATED_POSITION : MODE_CYCLIC_SYNCHRONOUS_POSITION;
}

static void default_objects(struct drive_node *node)
{
    const struct drive_node_config *config = &node->config;
    struct drive_objects *objects = &node->objects;
    memset(objects, 0, sizeof *objects);
    objects->abort_connection_option = OPTION_ABORT_IS_FAULT;
    objects->quick_stop_option = OPTION_QUICK_STOP_RAMP;
    objects->shutdown_option = OPTION_UNLOAD;
    objects->disable_option = OPTION_UNLOAD;
    objects->fault_reaction_option = OPTION_QUICK_STOP_RAMP;
    objects->mode = only_mode(config);
    objects->mode_display = objects->mode;
    objects->data_count = 1;
    objects->following_window =
        (uint32_t)node_round_i32(config->following_error_m * (double)config->counts_per_m);
    objects->following_timeout_ms = FOLLOWING_TIMEOUT_MS;
    objects->unload_rate =
        (uint32_t)node_round_i32(config->unload_rate_m_per_s * (double)config->counts_per_m);
    objects->pair_count = 2;
    objects->limit_min = counts_at(config, config->inverted ? config->stroke_m : 0.0);
    objects->limit_max = counts_at(config, config->inverted ? 0.0 : config->stroke_m);
    objects->max_speed =
        (uint32_t)node_round_i32(config->max_speed_m_per_s * (double)config->counts_per_m);
    /* One turn is at most a metre or so, for the feed in nanometres to fit its object. */
    objects->encoder_increments =
        config->counts_per_m >= ENCODER_INCREMENTS ? ENCODER_INCREMENTS : COARSE_ENCODER_INCREMENTS;
    objects->encoder_revolutions = 1;
    objects->gear_motor = 1;
    objects->gear_shaft = 1;
    objects->feed =
        (uint32_t)node_round_i32(objects->encoder_increments * 1e9 / (double)config->counts_per_m);
    objects->feed_revolutions = 1;
    objects->rated_torque_mNm = config->rated_torque_mNm != 0
                                    ? config->rated_torque_mNm
                                    : rated_torque_mNm(config, objects->encoder_increments);
    objects->interpolation_value = 1; /* as delivered: 1 ms, until it is told */
    objects->interpolation_exponent = -3;
    objects->output_mask = DRIVE_OUTPUT_LATCH_ARMED | OUTPUT_BRAKE;
    objects->supported_modes = config->interpolated ? SUPPORTS_INTERPOLATED_POSITION
                                                    : SUPPORTS_CYCLIC_SYNCHRONOUS_POSITION;
}

/* ---- reactions of the device -------------------------------------------- */

static uint32_t writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                        unsigned length)
{
    const struct drive_node *node = context;
    const int64_t value = co_od_number(entry, bytes);
    (void)length;
    switch (entry->index) {
    case 0x6060: /* a mode it does not have is refused, not ignored */
        return value == only_mode(&node->config) ? CO_ABORT_NONE : CO_ABORT_VALUE;
    case 0x605A: /* 3, 4: current and voltage limit ramps, which it does not have */
        return value == 3 || value == 4 ? CO_ABORT_VALUE : CO_ABORT_NONE;
    case 0x607D:
        if (entry->sub == 1) {
            return value > node->objects.limit_max ? CO_ABORT_TOO_HIGH : CO_ABORT_NONE;
        }
        return value < node->objects.limit_min ? CO_ABORT_TOO_LOW : CO_ABORT_NONE;
    default:
        return CO_ABORT_NONE;
    }
}

static void written(void *context, const struct co_entry *entry)
{
    struct drive_node *node = context;
    if (entry->index == 0x6040) {
        drive_state_controlword(node);
    }
    node->objects.mode_display = node->objects.mode;
}

static uint32_t reading(void *context, const struct co_entry *entry)
{
    struct drive_node *node = context;
    (void)entry;
    drive_state_update_statusword(node);
    return CO_ABORT_NONE;
}

static void on_sync(void *context, uint64_t now_ns)
{
    struct drive_node *node = context;
    node->last_sync_ns = now_ns;
    node->sync_seen = true;
    drive_state_update_statusword(node);
}

static void on_state(void *context, enum co_nmt_state state, uint64_t now_ns)
{
    (void)now_ns;
    if (state != CO_STATE_OPERATIONAL) {
        drive_state_connection_lost(context, CO_EMCY_HEARTBEAT);
    }
}

static void on_heartbeat(void *context, uint8_t other, bool alive, uint64_t now_ns)
{
    (void)other;
    (void)now_ns;
    if (!alive) {
        drive_state_connection_lost(context, CO_EMCY_HEARTBEAT);
    }
}

static void on_rpdo_timeout(void *context, unsigned number, bool timed_out, uint64_t now_ns)
{
    (void)number;
    (void)now_ns;
    if (timed_out) {
        drive_state_connection_lost(context, CO_EMCY_RPDO_TIMEOUT);
    }
}

static void on_bus_off(void *context, bool is_off, uint64_t now_ns)
{
    (void)now_ns;
    if (is_off) {
        drive_state_connection_lost(context, CO_EMCY_BUS_OFF_RECOVERED);
    }
}

static void on_reset(void *context, bool whole_node, uint64_t now_ns)
{
    struct drive_node *node = context;
    (void)now_ns;
    if (whole_node) {
        default_objects(node);
        drive_state_power_on(node);
    } else {
        drive_state_connection_lost(node, CO_EMCY_HEARTBEAT);
    }
}

static const struct co_device_ops device_ops = {
    .access = {.writing = writing, .written = written, .reading = reading},
    .sync = on_sync,
    .state_changed = on_state,
    .heartbeat = on_heartbeat,
    .rpdo_timeout = on_rpdo_timeout,
    .reset = on_reset,
    .bus_off = on_bus_off};

/* ---- public ------------------------------------------------------------- */

static bool is_config_valid(const struct drive_node_config *config)
{
    const double travel = config->stroke_m * (double)config->counts_per_m;
    const double zero = (double)config->zero_counts, span = travel + (zero < 0.0 ? -zero : zero);
    return config->counts_per_m > 0 && config->stroke_m > 0.0 && span < 2147483647.0 &&
           config->max_speed_m_per_s >= 0.0 && config->following_error_m > 0.0 &&
           config->rated_force_N > 0.0 && config->unload_rate_m_per_s > 0.0 &&
           config->temperature_limit_degC >= 0.0 && config->dc_link_minimum_V >= 0.0 &&
           (config->side == SIDE_LEFT || config->side == SIDE_RIGHT);
}

int drive_node_init(struct drive_node *node, const struct drive_node_config *config,
                    struct can_bus bus, uint64_t now_ns)
{
    if (!is_config_valid(config)) {
        return -1;
    }
    memset(node, 0, sizeof *node);
    node->config = *config;
    node->now_ns = now_ns;
    node->dictionary =
        (struct co_dictionary){drive_object_table, drive_object_count, &node->objects};
    default_objects(node);
    drive_state_power_on(node);
    const struct co_device_config device = {.node_id = config->node_id,
                                            .application = &node->dictionary,
                                            .ops = &device_ops,
                                            .context = node,
                                            .pdos = co_pdo_four_init(&node->pdos),
                                            .defaults = defaults};
    return co_device_init(&node->device, &device, bus, now_ns);
}

void drive_node_measure(struct drive_node *node, const struct drive_axis_feedback *feedback)
{
    struct drive_objects *objects = &node->objects;
    const double counts_per_m = (double)node->config.counts_per_m;
    node->feedback = *feedback;
    const double sign = node->config.inverted ? -1.0 : 1.0;
    objects->position_actual = counts_at(&node->config, feedback->position_m);
    objects->velocity_actual = node_round_i32(sign * feedback->velocity_m_per_s * counts_per_m);
    objects->torque_actual =
        node_round_i16(sign * feedback->force_N / node->config.rated_force_N * 1000.0);
    objects->temperature_0_1_degC = node_round_i16(feedback->temperature_degC * 10.0);
    const double dc_link_mV = feedback->dc_link_V * 1000.0;
    objects->dc_link_mV = dc_link_mV > 0.0 ? (uint32_t)node_round_i32(dc_link_mV) : 0;
    objects->latch_closed = feedback->latch_holds ? 1 : 0;
    objects->digital_inputs = feedback->latch_holds ? INPUT_LATCH_CLOSED : 0;
    objects->following_error =
        node_round_i32(node->demand_counts - (double)objects->position_actual);
}

bool drive_node_receive(struct drive_node *node, const struct can_msg *message, uint64_t now_ns)
{
    node->sync_seen = false;
    node->now_ns = now_ns;
    if (co_device_receive(&node->device, message, now_ns)) {
        co_device_process(&node->device, now_ns);
    }
    return node->sync_seen;
}

bool drive_node_poll(struct drive_node *node, uint64_t now_ns)
{
    struct can_msg message;
    bool sync = false;
    node->now_ns = now_ns;
    while (can_bus_receive(&node->device.bus, &message, NULL) == CAN_OK) {
        sync = drive_node_receive(node, &message, now_ns) || sync;
    }
    co_device_process(&node->device, now_ns);
    return sync;
}

/* Moves the demand towards `target` by at most `rate` counts/s (0: at once). */
static void move_demand(struct drive_node *node, double target, uint32_t rate, uint32_t period_ns)
{
    if (rate != 0) {
        const double reach = (double)rate * (double)period_ns / NS_PER_S;
        const double low = node->demand_counts - reach;
        const double high = node->demand_counts + reach;
        target = target < low ? low : (target > high ? high : target);
    }
    node->demand_counts = target;
}

static double limited_target(const struct drive_objects *objects)
{
    const int32_t target = objects->target_position;
    if (target < objects->limit_min) {
        return (double)objects->limit_min;
    }
    return (double)(target > objects->limit_max ? objects->limit_max : target);
}

void drive_node_command(struct drive_node *node, uint32_t period_ns,
                        struct drive_axis_command *command)
{
    struct drive_objects *objects = &node->objects;
    drive_state_supervise(node, node->now_ns);
    const uint32_t outputs = objects->outputs & objects->output_mask;
    *command = (struct drive_axis_command){.brake = (outputs & OUTPUT_BRAKE) != 0};
    if (node->unloading) {
        command->powered = true;
        move_demand(node, (double)node->config.zero_counts, objects->unload_rate, period_ns);
    } else if (node->state == DRIVE_OPERATION_ENABLED && !drive_state_follows(node)) {
        command->powered = true; /* it stands where it is until the interpolation runs */
    } else if (node->state == DRIVE_OPERATION_ENABLED) {
        command->powered = true;
        command->latch_armed = (outputs & DRIVE_OUTPUT_LATCH_ARMED) != 0;
        move_demand(node, limited_target(objects), objects->max_speed, period_ns);
    } else if (node->state == DRIVE_QUICK_STOP_ACTIVE) {
        command->powered = true; /* stays at zero spring until told otherwise */
    } else {
        node->demand_counts = (double)objects->position_actual;
    }
    objects->position_demand = node_round_i32(node->demand_counts);
    command->target_m = metres_at(&node->config, objects->position_demand);
    co_device_process(&node->device, node->now_ns);
}

void drive_node_inject_fault(struct drive_node *node, uint16_t error_code)
{
    node->injected_fault = error_code;
}
