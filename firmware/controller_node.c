#include "firmware/controller_node.h"

#include <string.h>

#include "firmware/version.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"

static const struct co_dictionary dictionary_template = {controller_object_table, 0, NULL};

/* ---- set-up ---------------------------------------------------------------- */

/* As much of the text as the object holds; the rest of it is 0 already. */
static void put_text(char *object, size_t size, const char *text)
{
    for (size_t i = 0; i + 1 < size && text[i] != '\0'; i++) {
        object[i] = text[i];
    }
}

static void defaults(void *context, struct co_comm *comm)
{
    (void)context;
    comm->device_type = 0; /* no standard profile */
    comm->heartbeat_ms = HEARTBEAT_PERIOD_MS;
    telemetry_default_pdos(comm);
    comm->sync_cob_id |= CO_SYNC_PRODUCER;
    comm->sync_period_us = TICK_PERIOD_US;
    put_text(comm->name, sizeof comm->name, "AFO controller");
    put_text(comm->hardware_version, sizeof comm->hardware_version, CONTROLLER_HARDWARE_VERSION);
    put_text(comm->software_version, sizeof comm->software_version, version_text());
}

static void default_objects(struct controller_objects *objects, const struct control_params *params)
{
    /* Field by field: a whole struct on the stack is more than the device has to spare. */
    memset(objects, 0, sizeof *objects);
    objects->command_count = 7;
    objects->state_count = 10;
    objects->step_count = 5;
    objects->record_count = 4;
    objects->change_count = 5;
    objects->log_count = 2;
    objects->param_count = CONTROL_PARAM_COUNT;
    objects->counter_count = 29;
    objects->drive_count = 12;
    objects->tool_count = 3;
    objects->identity_count = 3;
    objects->setup_count = 6;
    objects->crash_count = 3;
    objects->board_count = 9;
    objects->black_box_count = 3;
    objects->device_common_count = DEVICE_COMMON_COUNT;
    objects->device_leg_count = DEVICE_LEG_COUNT;
    objects->device_refusal_count = 3;
    device_description_default(&objects->device);
    objects->commissioning_count = 15;
    objects->measured_count = 12;
    objects->sample_count = 6;
    objects->motion_seconds = objects->motion_frequency_Hz = 1.0f;
    objects->params = *params;
    objects->build_id = version_build_id();
    put_text(objects->version, sizeof objects->version, version_text());
    objects->params_crc = params_guard_crc(&objects->params);
}

static const struct co_device_ops device_ops = {.access = {.writing = write_rules_writing,
                                                           .written = write_rules_written,
                                                           .reading = write_rules_reading,
                                                           .begin = write_rules_begin,
                                                           .take = write_rules_take}};

int controller_node_init(struct controller_node *node, const struct control_params *params,
                         float desired_speed_rad_s, bool walk_requested, struct can_bus bus)
{
    struct co_dictionary dictionary = dictionary_template;
    *node = (struct controller_node){0};
    default_objects(&node->objects, params);
    node->objects.desired_speed_rad_s = desired_speed_rad_s;
    node->objects.walk_requested = walk_requested ? 1 : 0;
    dictionary.count = controller_object_count;
    dictionary.base = &node->objects;
    node->comm.subs = CO_PDO_SUBS;
    node->comm.store_count = node->comm.restore_count = node->comm.program_count = 1;
    node->rules.objects = &node->objects;
    node->rules.comm = &node->comm;
    telemetry_init(&node->telemetry);
    const struct co_device_config config = {
        .node_id = NODE_CONTROLLER,
        .application = &dictionary,
        .ops = &device_ops,
        .context = &node->rules,
        .pdos = {.objects = {controller_comm_table, controller_comm_count, &node->comm},
                 .tpdo = node->comm.tpdo,
                 .tpdo_count = TELEMETRY_TPDOS},
        .defaults = defaults};
    if (co_device_init(&node->device, &config, bus, 0) != 0) {
        return -1;
    }
    /* The master starts itself (CiA 301: a self-starting device). */
    const struct can_msg start = {
        .id = FRAME_NMT, .length = 2, .data = {CO_NMT_START, NODE_CONTROLLER}};
    (void)co_device_receive(&node->device, &start, 0);
    return 0;
}

void controller_node_attach(struct controller_node *node,
                            const struct controller_settings_store_ops *settings_store,
                            void *settings_store_context, struct black_box *black_box,
                            struct crash_record *crash, struct program_update *update)
{
    node->rules.settings_store = settings_store;
    node->rules.settings_store_context = settings_store_context;
    node->rules.black_box = black_box;
    node->rules.crash = crash;
    node->rules.update = update;
    write_rules_show_attached(&node->rules);
}

/* ---- running --------------------------------------------------------------- */

bool controller_node_receive(struct controller_node *node, const struct can_msg *message,
                             uint64_t now_ns)
{
    if (message->id == FRAME_NMT || message->id == FRAME_SYNC) {
        return true; /* it is the master: nobody else's word on either */
    }
    return co_device_receive(&node->device, message, now_ns);
}

/* By the device itself, as a tool asked for; a parameter's offset tells its place in the table. */
static void change(struct controller_node *node, size_t offset, float value)
{
    struct controller_objects *objects = &node->objects;
    const float before = *(const float *)(const void *)((const char *)&objects->params + offset);
    params_guard_change(&objects->params, &objects->params_crc, offset, value);
    settings_lock_note(&node->rules.lock, objects, 0x2010, (uint8_t)(offset / sizeof(real) + 1u),
                       before, value);
}

/* The found offsets become parameters, to be stored like the others. */
static void adopt_zero(struct controller_node *node, const struct zero_offsets *found)
{
    change(node, offsetof(struct control_params, angle_zero_left_rad), found->angle_rad[SIDE_LEFT]);
    change(node, offsetof(struct control_params, angle_zero_right_rad),
           found->angle_rad[SIDE_RIGHT]);
    change(node, offsetof(struct control_params, ankle_zero_left_m), found->ankle_m[SIDE_LEFT]);
    change(node, offsetof(struct control_params, ankle_zero_right_m), found->ankle_m[SIDE_RIGHT]);
}

/* In these ticks the controller has the most to do: a gait event, or a state that begins. */
static bool is_busy(const struct controller *controller)
{
    const struct supervisor *supervisor = &controller->supervisor;
    const struct gait_event *event = controller->observer.state.event;
    return event[GAIT_APEX].happened || event[GAIT_HEEL_STRIKE].happened ||
           event[GAIT_LIFT_OFF].happened ||
           (supervisor->state == SUPERVISOR_ENGAGING &&
            supervisor->since_tick == supervisor->updated_tick);
}

void controller_node_update(struct controller_node *node, const struct controller *controller,
                            const struct controller_output *output, bool emergency_stop,
                            uint64_t now_ns)
{
    node->rules.powered = supervisor_may_enable(output->state);
    node->rules.standstill = checks_standstill(&controller->checks);
    settings_lock_tick(&node->rules.lock, &node->objects, !node->rules.powered);
    telemetry_update(&node->telemetry, &node->objects, &node->device, controller, output,
                     emergency_stop);
    if (output->new_zero) {
        adopt_zero(node, &controller->zeroing.mean);
    }
    /* Telegrams can wait for the next tick. While the drives are cut off there is no heartbeat, either. */
    if (!is_busy(controller) && !output->cut_off) {
        co_device_process(&node->device, now_ns);
    }
}
