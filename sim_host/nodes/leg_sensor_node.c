#include "sim_host/nodes/leg_sensor_node.h"

#include <string.h>

#include "hal/bus/frame_table.h"
#include "sim_host/nodes/node_numbers.h"

enum {
    PROFILE_ENCODER = 406,
    ABSOLUTE_MULTI_SENSOR = 0x000A, /* CiA 406: multi-sensor encoder interface */
    CODE_SEQUENCE = 1 << 0,
    ALARM_POSITION = 1 << 0,
    EMCY_DEVICE_HARDWARE = 0x5000,
    ANGLE_MAX = 0x7FFFFF,
    ANGLE_MIN = -0x800000,
    CYCLIC_TPDO = 0,
    SYNC_TPDO = 1,
    FOOT_TPDO = 2
};

static const double TWO_PI = 6.283185307179586;

static void defaults(void *context, struct co_comm *comm)
{
    const struct leg_sensor_node *node = context;
    const uint32_t id = node->config.node_id;
    comm->device_type = (uint32_t)ABSOLUTE_MULTI_SENSOR << 16 | PROFILE_ENCODER;
    strcpy(comm->name, "AFO virtual leg sensor");
    strcpy(comm->hardware_version, "1");
    strcpy(comm->software_version, "1");
    comm->product = 0x406;
    comm->revision = 0x00010000;
    comm->serial = id;
    comm->heartbeat_ms = HEARTBEAT_PERIOD_MS;
    comm->emcy_inhibit_100us = 100;
    comm->communication_error_behaviour = 1;
    /* TPDO1 is the cyclic timer's (0x6200), off at power-on; TPDO2 the SYNC's. */
    comm->tpdo[CYCLIC_TPDO].cob_id = 0x180 + id;
    comm->tpdo[CYCLIC_TPDO].type = CO_EVENT_MANUFACTURER;
    comm->tpdo[CYCLIC_TPDO].cob_id |= CO_PDO_INVALID;
    comm->tpdo[CYCLIC_TPDO].map[0] = UINT32_C(0x60040020);
    comm->tpdo[CYCLIC_TPDO].map_count = 1;
    comm->tpdo[SYNC_TPDO].cob_id = 0x280 + id;
    comm->tpdo[SYNC_TPDO].type = 1;
    comm->tpdo[SYNC_TPDO].map[0] = UINT32_C(0x20200118);
    comm->tpdo[SYNC_TPDO].map[1] = UINT32_C(0x20200210);
    comm->tpdo[SYNC_TPDO].map_count = 2;
    if (node->config.has_foot_switch) {
        comm->tpdo[FOOT_TPDO].cob_id = 0x380 + id;
        comm->tpdo[FOOT_TPDO].type = CO_EVENT_MANUFACTURER;
        comm->tpdo[FOOT_TPDO].inhibit_100us = FOOT_INHIBIT_TICKS * TICK_PERIOD_US / 100;
        comm->tpdo[FOOT_TPDO].event_ms = FOOT_REPEAT_MS;
        comm->tpdo[FOOT_TPDO].map[0] = UINT32_C(0x20220008);
        comm->tpdo[FOOT_TPDO].map_count = 1;
    }
}

static void default_objects(struct leg_sensor_node *node)
{
    struct leg_sensor_objects *objects = &node->objects;
    memset(objects, 0, sizeof *objects);
    objects->channel_count = 2;
    objects->speed_count = 1;
    objects->ankle_is_lever = node->config.ankle_is_lever ? 1 : 0;
    objects->foot_contact = FOOT_HAS_FAULT;
    objects->steps_per_turn = (uint32_t)node->config.leg_counts_per_turn;
    objects->total_range = objects->steps_per_turn;
    objects->resolution = objects->steps_per_turn;
    objects->turns = 1;
    objects->supported_alarms = ALARM_POSITION;
    objects->profile_version = 0x00010302; /* software 0.1, profile 3.2 */
    objects->operating_time = UINT32_MAX;
    node->ankle_offset = 0;
}

static int32_t clamp(int64_t value, int32_t low, int32_t high)
{
    return value < low ? low : (value > high ? high : (int32_t)value);
}

static int64_t directed_angle(const struct leg_sensor_node *node)
{
    const bool reversed = (node->objects.operating_parameters & CODE_SEQUENCE) != 0;
    return reversed ? -(int64_t)node->raw_angle : node->raw_angle;
}

static void update_positions(struct leg_sensor_node *node)
{
    struct leg_sensor_objects *objects = &node->objects;
    objects->leg_angle = clamp(directed_angle(node) + objects->offset, ANGLE_MIN, ANGLE_MAX);
    objects->position = objects->leg_angle;
    objects->ankle_wide =
        clamp((int64_t)node->raw_ankle + node->ankle_offset, INT16_MIN, INT16_MAX);
    objects->ankle = (int16_t)objects->ankle_wide;
}

/* A preset shifts the scale so that the position now is the preset (CiA 406). */
static void written(void *context, const struct co_entry *entry)
{
    struct leg_sensor_node *node = context;
    struct leg_sensor_objects *objects = &node->objects;
    if (entry->index == 0x6010 && entry->sub == 2) {
        node->ankle_offset =
            clamp((int64_t)objects->ankle_preset - node->raw_ankle, INT32_MIN / 2, INT32_MAX / 2);
    } else if (entry->index == 0x6003 || entry->index == 0x6010) {
        objects->offset =
            clamp(objects->preset - directed_angle(node), INT32_MIN / 2, INT32_MAX / 2);
    } else if (entry->index == 0x6200) {
        node->device.comm.tpdo[CYCLIC_TPDO].event_ms = objects->cyclic_timer_ms;
    } else if (entry->index == 0x6000) {
        objects->operating_status = objects->operating_parameters;
    }
    update_positions(node);
}

static void on_sync(void *context, uint64_t now_ns)
{
    struct leg_sensor_node *node = context;
    (void)now_ns;
    node->sync_seen = true;
    const int64_t moved = (int64_t)node->objects.leg_angle - node->last_angle;
    node->last_angle = node->objects.leg_angle;
    node->objects.speed = node_round_i16((double)moved / 256.0);
}

static void on_reset(void *context, bool whole_node, uint64_t now_ns)
{
    (void)now_ns;
    if (whole_node) {
        default_objects(context);
        update_positions(context);
    }
}

static const struct co_device_ops device_ops = {
    .access = {.written = written}, .sync = on_sync, .reset = on_reset};

static void fill_in(struct leg_sensor_node_config *config)
{
    if (config->leg_counts_per_turn == 0.0) {
        config->leg_counts_per_turn = LEG_ANGLE_COUNTS_PER_TURN;
    }
    if (config->ankle_counts_per_unit == 0.0) {
        config->ankle_counts_per_unit =
            config->ankle_is_lever ? ANKLE_COUNTS_PER_TURN : ANKLE_COUNTS_PER_METRE;
    }
}

int leg_sensor_node_init(struct leg_sensor_node *node, const struct leg_sensor_node_config *config,
                         struct can_bus bus, uint64_t now_ns)
{
    if (config->side != SIDE_LEFT && config->side != SIDE_RIGHT) {
        return -1;
    }
    memset(node, 0, sizeof *node);
    node->config = *config;
    fill_in(&node->config);
    node->dictionary =
        (struct co_dictionary){leg_sensor_object_table, leg_sensor_object_count, &node->objects};
    default_objects(node);
    const struct co_device_config device = {.node_id = config->node_id,
                                            .application = &node->dictionary,
                                            .ops = &device_ops,
                                            .context = node,
                                            .pdos = co_pdo_four_init(&node->pdos),
                                            .defaults = defaults};
    return co_device_init(&node->device, &device, bus, now_ns);
}

/* Into the one turn that the count has. */
static double wrap_turn(double angle_rad)
{
    if (angle_rad > 0.5 * TWO_PI) {
        return angle_rad - TWO_PI;
    }
    return angle_rad < -0.5 * TWO_PI ? angle_rad + TWO_PI : angle_rad;
}

void leg_sensor_node_measure(struct leg_sensor_node *node, double leg_angle_rad, double ankle)
{
    const bool is_finite = leg_angle_rad - leg_angle_rad == 0.0 && ankle - ankle == 0.0;
    if (!is_finite) {
        node->objects.alarms = ALARM_POSITION;
        co_device_raise(&node->device, EMCY_DEVICE_HARDWARE, CO_ERROR_PROFILE, NULL);
        return;
    }
    if (node->objects.alarms != 0) {
        node->objects.alarms = 0;
        co_device_clear(&node->device, EMCY_DEVICE_HARDWARE);
    }
    const struct leg_sensor_node_config *config = &node->config;
    const double mounted_ankle = (config->ankle_reversed ? -ankle : ankle) + config->ankle_zero;
    const double mounted_angle =
        (config->leg_reversed ? -leg_angle_rad : leg_angle_rad) + config->leg_zero_rad;
    const double ankle_counts = config->ankle_is_lever
                                    ? mounted_ankle / TWO_PI * config->ankle_counts_per_unit
                                    : mounted_ankle * config->ankle_counts_per_unit;
    /* One that is mounted straight saturates, as the profile has it. */
    const double angle = config->leg_zero_rad != 0.0 ? wrap_turn(mounted_angle) : mounted_angle;
    node->raw_angle = node_round_i32(angle / TWO_PI * config->leg_counts_per_turn);
    node->raw_ankle = node_round_i16(ankle_counts);
    update_positions(node);
}

void leg_sensor_node_measure_foot(struct leg_sensor_node *node, enum foot_contact foot)
{
    const uint8_t bits = foot == FOOT_UNKNOWN ? FOOT_HAS_FAULT
                         : foot == FOOT_DOWN  ? FOOT_IS_DOWN
                                              : 0;
    if (node->config.has_foot_switch && bits != node->objects.foot_contact) {
        node->objects.foot_contact = bits;
        co_device_trigger_tpdo(&node->device, FOOT_TPDO);
    }
}

bool leg_sensor_node_receive(struct leg_sensor_node *node, const struct can_msg *message,
                             uint64_t now_ns)
{
    const bool is_sync = message->id == FRAME_SYNC && message->flags == 0;
    node->sync_seen = false;
    if (is_sync && node->silent) {
        return true; /* no sample, no answer */
    }
    if (co_device_receive(&node->device, message, now_ns)) {
        co_device_process(&node->device, now_ns);
    }
    return node->sync_seen;
}

bool leg_sensor_node_poll(struct leg_sensor_node *node, uint64_t now_ns)
{
    struct can_msg message;
    bool sync = false;
    while (can_bus_receive(&node->device.bus, &message, NULL) == CAN_OK) {
        sync = leg_sensor_node_receive(node, &message, now_ns) || sync;
    }
    co_device_process(&node->device, now_ns);
    return sync;
}

void leg_sensor_node_silence(struct leg_sensor_node *node, bool silent)
{
    node->silent = silent;
}
