#include "sim_host/nodes/walker_nodes.h"

#include <stdio.h>
#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/nodes/drive_state.h"

enum { TICK_NS = TICK_PERIOD_US * 1000 };

static bool is_vendor(const struct walker_nodes *nodes, enum side side)
{
    const int32_t protocol = nodes->device.leg[side].protocol;
    return protocol == DEVICE_CANSIMPLE || protocol == DEVICE_MIT;
}

static bool is_cia402(const struct walker_nodes *nodes, enum side side)
{
    return nodes->device.leg[side].protocol == DEVICE_CIA402;
}

static bool has_board(const struct walker_nodes *nodes, enum side side)
{
    const struct device_leg *leg = &nodes->device.leg[side];
    return device_leg_is_driven(leg) && leg->latch == DEVICE_LATCH_BOARD;
}

static bool has_ankle_node(const struct walker_nodes *nodes, enum side side)
{
    return device_leg_ankle_is_apart(&nodes->device.leg[side]);
}

static int init_vendor_drive(struct walker_nodes *nodes, enum side side, struct can_bus bus,
                             uint64_t now_ns)
{
    const struct device_leg *leg = &nodes->device.leg[side];
    const bool mit = leg->protocol == DEVICE_MIT;
    const struct vendor_drive_config vendor = {
        .protocol = (enum device_protocol)leg->protocol,
        .drive_id = (uint8_t)leg->drive_node,
        .answer_id = (uint16_t)leg->answer_id,
        .units_per_m = (double)(mit ? leg->rad_per_m : leg->turns_per_m),
        .zero_units = (double)(mit ? leg->zero_rad : leg->zero_turns),
        .inverted = leg->direction < 0,
        .stroke_m = nodes->plant.config.sea[side].stroke_max_m,
        .ranges = {(double)leg->position_range_rad, (double)leg->velocity_range_rad_s,
                   (double)leg->torque_range_Nm},
        .watchdog_ms = FOREIGN_WATCHDOG_MS,
    };
    return vendor_drive_init(&nodes->vendor[side], &vendor, bus, now_ns);
}

static int init_drive(struct walker_nodes *nodes, enum side side, struct can_bus bus,
                      uint64_t now_ns)
{
    const struct sea_params *sea = &nodes->plant.config.sea[side];
    const struct device_leg *leg = &nodes->device.leg[side];
    if (has_board(nodes, side) &&
        latch_node_init(&nodes->latch[side], (uint8_t)leg->latch_node, bus, now_ns) != 0) {
        return -1;
    }
    if (is_vendor(nodes, side)) {
        return init_vendor_drive(nodes, side, bus, now_ns);
    }
    if (!device_leg_is_driven(leg)) {
        return 0;
    }
    const struct drive_node_config drive = {
        .side = side,
        .node_id = (uint8_t)leg->drive_node,
        .counts_per_m = (uint32_t)sea->counts_per_m,
        .zero_counts = leg->zero_counts,
        .inverted = leg->direction < 0,
        .stroke_m = sea->stroke_max_m,
        .max_speed_m_per_s = sea->speed_limit_m_s,
        .rated_force_N = sea->rated_force_N,
        .following_error_m = 0.1 * nodes->plant.config.walk.body.leg_length_m,
        .unload_rate_m_per_s = sea->unload_rate_m_s,
        .interpolated = leg->mode == DEVICE_MODE_INTERPOLATED,
        .rated_torque_mNm = (uint32_t)((double)leg->rated_torque_Nm * 1000.0 + 0.5),
    };
    return drive_node_init(&nodes->drive[side], &drive, bus, now_ns);
}

static int init_side(struct walker_nodes *nodes, enum side side,
                     const struct can_bus bus[WALKER_NODES], uint64_t now_ns)
{
    const struct device_leg *leg = &nodes->device.leg[side];
    const int first = side == SIDE_LEFT ? WALKER_DRIVE_LEFT : WALKER_DRIVE_RIGHT;
    const bool lever = nodes->plant.config.sensors[side].ankle_is_lever;
    const struct leg_sensor_node_config sensor = {
        .side = side,
        .node_id = (uint8_t)leg->leg_sensor_node,
        .ankle_is_lever = lever,
        .leg_counts_per_turn = (double)leg->leg_counts_per_turn,
        .leg_zero_rad = (double)leg->leg_zero_rad,
        .leg_reversed = leg->leg_direction < 0,
        .ankle_counts_per_unit =
            (double)(lever ? leg->ankle_counts_per_turn : leg->ankle_counts_per_m),
        .ankle_zero = lever ? 0.0 : (double)leg->ankle_zero_m,
        .ankle_reversed = leg->ankle_direction < 0,
        .has_foot_switch = nodes->plant.config.foot_switch[side].present,
    };
    nodes->drive_bus[side] = bus[first];
    nodes->sensor_bus[side] = bus[first + 1];
    struct leg_sensor_node_config ankle = sensor;
    ankle.node_id = (uint8_t)leg->ankle_sensor_node;
    ankle.has_foot_switch = false;
    if (has_ankle_node(nodes, side) &&
        leg_sensor_node_init(&nodes->ankle[side], &ankle, bus[first + 1], now_ns) != 0) {
        return -1;
    }
    return init_drive(nodes, side, bus[first], now_ns) == 0 &&
                   leg_sensor_node_init(&nodes->sensor[side], &sensor, bus[first + 1], now_ns) == 0
               ? 0
               : -1;
}

int walker_nodes_init(struct walker_nodes *nodes, const struct plant_config *plant,
                      const struct device_description *device,
                      const struct can_bus bus[WALKER_NODES], uint64_t now_ns, char *message)
{
    memset(nodes, 0, sizeof *nodes);
    nodes->device = *device;
    for (int side = 0; side < SIDE_COUNT; side++) {
        nodes->assembly.leg_gain[side] = nodes->assembly.ankle_gain[side] = 1.0;
        nodes->assembly.motor_scale[side] = 1.0;
    }
    if (plant_init(&nodes->plant, plant, message) != PLANT_OK) {
        return -1;
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (init_side(nodes, (enum side)side, bus, now_ns) != 0) {
            snprintf(message, PLANT_ERROR_MAX, "a virtual node refuses its configuration");
            plant_free(&nodes->plant);
            return -1;
        }
    }
    walker_nodes_measure(nodes);
    return 0;
}

void walker_nodes_free(struct walker_nodes *nodes)
{
    plant_free(&nodes->plant);
}

/* Whether the gate answered a request in the drive's place. */
static bool is_refused(const struct walker_nodes *nodes, enum side side,
                       const struct can_msg *message)
{
    const struct walker_gate *gate = &nodes->gate[side];
    const uint32_t request = FRAME_SDO_REQUEST_DRIVE_LEFT - NODE_DRIVE_LEFT +
                             (uint32_t)nodes->device.leg[side].drive_node;
    struct can_msg answer;
    if (gate->refuses == NULL || message->id != request ||
        !gate->refuses(gate->context, message, &answer)) {
        return false;
    }
    (void)can_bus_send(&nodes->drive_bus[side], &answer);
    return true;
}

/* One frame for what is at a drive's place: the drive and its latch board. */
static bool receive_drive(struct walker_nodes *nodes, enum side side, const struct can_msg *message,
                          uint64_t now_ns)
{
    bool sync = false;
    if (is_vendor(nodes, side)) {
        vendor_drive_receive(&nodes->vendor[side], message, now_ns);
    } else if (is_cia402(nodes, side) && !is_refused(nodes, side, message)) {
        sync = drive_node_receive(&nodes->drive[side], message, now_ns);
    }
    if (has_board(nodes, side)) {
        latch_node_receive(&nodes->latch[side], message, now_ns);
    }
    return sync;
}

static void process_drive(struct walker_nodes *nodes, enum side side, uint64_t now_ns)
{
    if (is_vendor(nodes, side)) {
        vendor_drive_process(&nodes->vendor[side], now_ns);
    } else if (is_cia402(nodes, side)) {
        nodes->drive[side].now_ns = now_ns;
        co_device_process(&nodes->drive[side].device, now_ns);
    }
    if (has_board(nodes, side)) {
        latch_node_process(&nodes->latch[side], now_ns);
    }
}

static void receive_sensor(struct walker_nodes *nodes, enum side side,
                           const struct can_msg *message, uint64_t now_ns)
{
    (void)leg_sensor_node_receive(&nodes->sensor[side], message, now_ns);
    if (has_ankle_node(nodes, side)) {
        (void)leg_sensor_node_receive(&nodes->ankle[side], message, now_ns);
    }
}

static void process_sensor(struct walker_nodes *nodes, enum side side, uint64_t now_ns)
{
    co_device_process(&nodes->sensor[side].device, now_ns);
    if (has_ankle_node(nodes, side)) {
        co_device_process(&nodes->ankle[side].device, now_ns);
    }
}

/* Two nodes on one bus of theirs. */
static bool poll_sensors(struct walker_nodes *nodes, enum side side, uint64_t now_ns)
{
    struct can_msg message;
    bool sync = false;
    while (can_bus_receive(&nodes->sensor_bus[side], &message, NULL) == CAN_OK) {
        sync = sync || (message.id == FRAME_SYNC && message.flags == 0);
        receive_sensor(nodes, side, &message, now_ns);
    }
    process_sensor(nodes, side, now_ns);
    return sync;
}

bool walker_nodes_receive(struct walker_nodes *nodes, const struct can_msg *message,
                          uint64_t now_ns)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        (void)receive_drive(nodes, (enum side)side, message, now_ns);
        receive_sensor(nodes, (enum side)side, message, now_ns);
    }
    return message->id == FRAME_SYNC && message->flags == 0;
}

void walker_nodes_process(struct walker_nodes *nodes, uint64_t now_ns)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        process_drive(nodes, (enum side)side, now_ns);
        process_sensor(nodes, (enum side)side, now_ns);
    }
}

/* Time by a node's own clock. */
static uint64_t own_time_ns(const struct walker_nodes *nodes, enum walker_node node,
                            uint64_t now_ns)
{
    const double skew = nodes->assembly.clock_skew[node];
    const uint64_t since_ns = nodes->assembly.skewed_ns[node];
    return skew == 0.0 || now_ns < since_ns
               ? now_ns
               : since_ns + (uint64_t)((1.0 + skew) * (double)(now_ns - since_ns));
}

bool walker_nodes_poll(struct walker_nodes *nodes, enum walker_node node, uint64_t bus_ns)
{
    const uint64_t now_ns = own_time_ns(nodes, node, bus_ns);
    const enum side side = node < WALKER_DRIVE_RIGHT ? SIDE_LEFT : SIDE_RIGHT;
    struct can_msg message;
    bool sync = false;
    if (node == WALKER_SENSOR_LEFT || node == WALKER_SENSOR_RIGHT) {
        return has_ankle_node(nodes, side) ? poll_sensors(nodes, side, now_ns)
                                           : leg_sensor_node_poll(&nodes->sensor[side], now_ns);
    }
    if (is_cia402(nodes, side) && !has_board(nodes, side) && nodes->gate[side].refuses == NULL) {
        return drive_node_poll(&nodes->drive[side], now_ns);
    }
    while (can_bus_receive(&nodes->drive_bus[side], &message, NULL) == CAN_OK) {
        if (is_cia402(nodes, side)) {
            nodes->drive[side].now_ns = now_ns;
        }
        sync = receive_drive(nodes, side, &message, now_ns) || sync;
    }
    process_drive(nodes, side, now_ns);
    return sync;
}

/* The leg at which a side's drive is. */
static enum side leg_of_drive(const struct walker_nodes *nodes, enum side side)
{
    return nodes->assembly.drives_crossed ? side_other(side) : side;
}

/* The drives know: their input of the safe torque off has fallen. */
static void take_torque(struct walker_nodes *nodes, enum side side)
{
    if (is_vendor(nodes, side)) {
        vendor_drive_lose_torque(&nodes->vendor[side]);
    } else if (is_cia402(nodes, side)) {
        drive_state_lose_torque(&nodes->drive[side]);
    }
}

void walker_nodes_advance(struct walker_nodes *nodes)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct drive_axis_command axis = {.powered = false};
        if (nodes->torque_is_off) {
            take_torque(nodes, (enum side)side);
        }
        if (is_vendor(nodes, (enum side)side)) {
            vendor_drive_command(&nodes->vendor[side], &axis);
        } else if (is_cia402(nodes, (enum side)side)) {
            drive_node_command(&nodes->drive[side], TICK_NS, &axis);
        }
        if (has_board(nodes, (enum side)side)) {
            axis.latch_armed = axis.powered && latch_node_armed(&nodes->latch[side]);
        }
        axis.powered = axis.powered && !nodes->torque_is_off;
        axis.latch_armed = axis.latch_armed && !nodes->torque_is_off;
        const struct sea_command command = {
            .mode = axis.powered ? SEA_POSITION : SEA_TORQUE_OFF,
            .target_position_m = axis.target_m / nodes->assembly.motor_scale[side],
            .latch_armed = axis.latch_armed,
        };
        plant_set_command(&nodes->plant, leg_of_drive(nodes, (enum side)side), &command);
    }
    plant_advance(&nodes->plant);
}

double walker_nodes_ankle(const struct walker_nodes *nodes, enum side side, double extension_m)
{
    const struct sensor_params *params = &nodes->plant.config.sensors[side];
    return params->ankle_is_lever ? extension_m / params->ankle_lever_m : extension_m;
}

/* What a side's leg sensor reads, as it is mounted and as late as it is. */
static void measure_leg(struct walker_nodes *nodes, enum side side)
{
    static const double lever_count_rad = 6.283185307179586 / ANKLE_COUNTS_PER_TURN;
    const struct assembly *assembly = &nodes->assembly;
    const enum side from = assembly->legs_swapped ? side_other(side) : side;
    const enum side foot = assembly->feet_swapped ? side_other(side) : side;
    const struct sensor_sample *sample = &nodes->sample[from];
    const bool lever = nodes->plant.config.sensors[side].ankle_is_lever;
    const double ankle = assembly->ankle_stuck[side]
                             ? walker_nodes_ankle(nodes, side, assembly->ankle_stuck_m[side])
                         : lever ? (double)sample->ankle_counts * lever_count_rad
                                 : sample->ankle_extension_m;
    nodes->reading[side][nodes->readings % (ASSEMBLY_LATE_MOST + 1)] = (struct walker_reading){
        .leg_angle_rad = assembly->leg_gain[side] * sample->leg_angle_rad,
        .ankle = assembly->ankle_gain[side] * ankle +
                 walker_nodes_ankle(nodes, side, assembly->ankle_slip_m[side]),
        .sent = sample->sent,
    };
    const uint32_t late =
        assembly->late_ticks[side] < nodes->readings ? assembly->late_ticks[side] : nodes->readings;
    const struct walker_reading *reading =
        &nodes->reading[side][(nodes->readings - late) % (ASSEMBLY_LATE_MOST + 1)];
    leg_sensor_node_silence(&nodes->sensor[side], !reading->sent);
    leg_sensor_node_measure(&nodes->sensor[side], reading->leg_angle_rad, reading->ankle);
    if (has_ankle_node(nodes, side)) {
        leg_sensor_node_silence(&nodes->ankle[side], !reading->sent);
        leg_sensor_node_measure(&nodes->ankle[side], reading->leg_angle_rad, reading->ankle);
    }
    leg_sensor_node_measure_foot(&nodes->sensor[side], nodes->plant.foot[foot]);
}

void walker_nodes_measure(struct walker_nodes *nodes)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct sea_output out;
        const enum side place = leg_of_drive(nodes, (enum side)side);
        plant_sea_output(&nodes->plant, place, &out);
        const double scale = nodes->assembly.motor_scale[side];
        const struct drive_axis_feedback feedback = {
            .position_m = scale * out.reported_position_m,
            .velocity_m_per_s = scale * out.speed_m_s,
            .force_N = out.motor_force_N,
            .temperature_degC = out.temperature_degC,
            .dc_link_V = out.dc_link_V,
            .latch_holds = out.latch == SEA_LATCH_CLOSED,
            .contact = nodes->plant.config.foot_switch[side_other(place)].present &&
                       nodes->plant.other_foot[place].down,
        };
        if (is_vendor(nodes, (enum side)side)) {
            vendor_drive_measure(&nodes->vendor[side], &feedback);
        } else if (is_cia402(nodes, (enum side)side)) {
            drive_node_measure(&nodes->drive[side], &feedback);
        }
        if (has_board(nodes, (enum side)side)) {
            latch_node_measure(&nodes->latch[side], feedback.latch_holds);
        }
        plant_sample(&nodes->plant, (enum side)side, &nodes->sample[side]);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        measure_leg(nodes, (enum side)side);
    }
    nodes->readings++;
}

/* ---- what the nodes listen to ---------------------------------------------- */

static unsigned add(uint16_t *ids, unsigned count, uint32_t id)
{
    if (id > CAN_ID_STANDARD_MAX || count == WALKER_NODES_IDS_MAX) {
        return count; /* an invalid PDO has bit 31 */
    }
    for (unsigned i = 0; i < count; i++) {
        if (ids[i] == id) {
            return count;
        }
    }
    ids[count] = (uint16_t)id;
    return count + 1;
}

static unsigned add_device(uint16_t *ids, unsigned count, const struct co_device *device)
{
    const struct co_comm *comm = &device->comm;
    count = add(ids, count, CO_COB_NMT);
    count = add(ids, count, comm->sync_cob_id);
    count = add(ids, count, comm->sdo_request_id);
    for (unsigned i = 0; i < comm->rpdo_count; i++) {
        count = add(ids, count, comm->rpdo[i].cob_id);
    }
    for (unsigned i = 0; i < CO_HEARTBEATS_MAX; i++) {
        if ((comm->consumer[i] & 0xFFFFU) != 0) {
            count = add(ids, count, CO_COB_HEARTBEAT + (comm->consumer[i] >> 16 & 0x7FU));
        }
    }
    return count;
}

unsigned walker_nodes_ids(const struct walker_nodes *nodes, uint16_t *ids)
{
    unsigned count = 0;
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (is_vendor(nodes, (enum side)side)) {
            count = vendor_drive_ids(&nodes->vendor[side], ids, count);
        } else if (is_cia402(nodes, (enum side)side)) {
            count = add_device(ids, count, &nodes->drive[side].device);
        }
        if (has_board(nodes, (enum side)side)) {
            count = add_device(ids, count, &nodes->latch[side].device);
        }
        count = add_device(ids, count, &nodes->sensor[side].device);
        if (has_ankle_node(nodes, (enum side)side)) {
            count = add_device(ids, count, &nodes->ankle[side].device);
        }
    }
    return count;
}

uint32_t walker_nodes_sdo_requests(const struct walker_nodes *nodes)
{
    uint32_t requests = 0;
    for (int side = 0; side < SIDE_COUNT; side++) {
        requests += nodes->drive[side].device.counters.sdo_requests;
        requests += nodes->latch[side].device.counters.sdo_requests;
        requests += nodes->sensor[side].device.counters.sdo_requests;
        requests += nodes->ankle[side].device.counters.sdo_requests;
    }
    return requests;
}
