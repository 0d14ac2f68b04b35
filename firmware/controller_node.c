#include "firmware/controller_node.h"

#include <string.h>

#include <assert.h>

#include "firmware/version.h"
#include "hal/bus/bytes.h"
#include "hal/bus/frame_table.h"
#include "hal/canopen/co_defs.h"
#include "hal/canopen/co_pdo_objects.h"
#include "hal/storage/crc.h"

enum { TPDO_STEP = 0, TPDO_STATE = 1, TPDO_COUNT = 2 };
enum {
    INDEX_STORE = 0x1010,
    INDEX_RESTORE = 0x1011,
    INDEX_COMMANDS = 0x2000,
    INDEX_PARAMS = 0x2010,
    INDEX_COUNTERS = 0x2020,
    INDEX_CRASH = 0x2032,
    INDEX_BLACK_BOX = 0x2040
};

/* What has to be written to 0x1010 and 0x1011 (CiA 301, clauses 7.5.2.13 and 7.5.2.14), and
 * what is read there: it does so on command. */
#define SIGNATURE_SAVE UINT32_C(0x65766173)
#define SIGNATURE_LOAD UINT32_C(0x64616F6C)
#define ON_COMMAND UINT32_C(1)

#define SPEED_UNITS_PER_RAD_S 10000.0f
#define R0_UNITS_PER_METRE 100000.0f
#define EMERGENCY_STOP_BIT 0x80u
#define RIGHT_BIT 0x80u
#define FELL_BACK_BIT 0x40u

static_assert(SUPERVISOR_FAULTS <= FELL_BACK_BIT,
              "a fault's number fits beside the bits of a step");
static_assert(CONTROLLER_PARAMS_BYTES ==
                      sizeof(float) * (CONTROL_PARAM_COUNT + 3 + SPEED_TABLE_MAX) &&
                  sizeof(struct gait_branch) ==
                      sizeof(float) * (5 + GAIT_BRANCH_MAX * (9 + GAIT_BRANCH_COSTS)),
              "the parameters' checksum covers no padding, whose bytes nobody defines");

static const struct co_dictionary dictionary_template = {controller_object_table, 0, NULL};

/* ---- what may be written --------------------------------------------------- */

/* Parameters that may change while a spring may be loaded: the law's, not the body's. */
static bool may_change_live(unsigned parameter)
{
    const size_t offset = control_param_descriptors[parameter].offset;
    return offset == offsetof(struct control_params, kp_m_s_rad) ||
           offset == offsetof(struct control_params, speed_ramp_rad_s) ||
           offset == offsetof(struct control_params, r0_min_m) ||
           offset == offsetof(struct control_params, r0_max_m) ||
           offset == offsetof(struct control_params, r0_change_max_m);
}

static uint32_t check_range(float value, float minimum, float maximum)
{
    if (value >= minimum && value <= maximum) {
        return CO_ABORT_NONE;
    }
    if (value > maximum) {
        return CO_ABORT_TOO_HIGH;
    }
    return value < minimum ? CO_ABORT_TOO_LOW : CO_ABORT_VALUE; /* the last: not a number */
}

static size_t covered_bytes(const struct control_params *params)
{
    return CONTROLLER_PARAMS_BYTES + (params->branch != NULL ? sizeof *params->branch : 0);
}

static uint32_t bits_of(float value)
{
    const union {
        float value;
        uint32_t bits;
    } number = {value};
    return number.bits;
}

/* Changes a parameter and its share of the checksum; the others are not read, so that what
 * a failing memory did to one of them is not taken for meant. */
static void change_parameter(struct controller_node *node, size_t offset, float value)
{
    struct controller_objects *objects = &node->objects;
    float *field = (float *)((char *)&objects->params + offset);
    objects->params_crc ^= crc32_change(bits_of(*field) ^ bits_of(value),
                                        covered_bytes(&objects->params) - offset - sizeof *field);
    *field = value;
}

static uint32_t check_parameter(struct controller_node *node, unsigned parameter, float value)
{
    const struct control_param_descriptor *d = &control_param_descriptors[parameter];
    const uint32_t verdict = check_range(value, d->minimum, d->maximum);
    if (verdict != CO_ABORT_NONE) {
        return verdict;
    }
    if (node->powered && !may_change_live(parameter)) {
        return CO_ABORT_DEVICE_STATE;
    }
    /* Tried in place, between two ticks: a copy of all is more than the stack has to spare. */
    float *field = (float *)((char *)&node->objects.params + d->offset);
    const float before = *field;
    *field = value;
    const int verdict_of_all = control_params_validate(&node->objects.params);
    *field = before;
    return verdict_of_all == CONTROL_PARAMS_OK ? CO_ABORT_NONE : CO_ABORT_VALUE;
}

static uint32_t keep(const struct controller_node *node, const struct co_entry *entry,
                     const uint8_t *bytes)
{
    const bool save = entry->index == INDEX_STORE;
    if (node->settings_store == NULL ||
        bytes_get_u32(bytes) != (save ? SIGNATURE_SAVE : SIGNATURE_LOAD)) {
        return CO_ABORT_NOT_STORED;
    }
    if (node->powered || !node->standstill) {
        return CO_ABORT_DEVICE_STATE;
    }
    return save ? node->settings_store->save_settings(node->settings_store_context)
                : node->settings_store->forget_settings(node->settings_store_context);
}

static uint32_t writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                        unsigned length)
{
    struct controller_node *node = (struct controller_node *)context;
    if (entry->index == INDEX_STORE || entry->index == INDEX_RESTORE) {
        return keep(node, entry, bytes);
    }
    if (entry->index == INDEX_CRASH) {
        return node->crash == NULL ? CO_ABORT_DEVICE_STATE : CO_ABORT_NONE;
    }
    if (entry->index == INDEX_BLACK_BOX) {
        return node->black_box == NULL || bytes[0] == BLACK_BOX_CLOSING ? CO_ABORT_DEVICE_STATE
                                                                        : CO_ABORT_NONE;
    }
    if (entry->type != CO_REAL32 || length != sizeof(float)) {
        return CO_ABORT_NONE; /* the dictionary's own limits decide */
    }
    const float value = bytes_get_f32(bytes);
    if (entry->index == INDEX_PARAMS && entry->sub >= 1 && entry->sub <= CONTROL_PARAM_COUNT) {
        const uint32_t verdict = check_parameter(node, entry->sub - 1u, value);
        if (verdict == CO_ABORT_NONE) { /* that the value is stored once more changes nothing */
            change_parameter(node, control_param_descriptors[entry->sub - 1u].offset, value);
        }
        return verdict;
    }
    if (entry->index == INDEX_COMMANDS) {
        float low_rad_s, high_rad_s;
        control_params_speeds(&node->objects.params, &low_rad_s, &high_rad_s);
        return check_range(value, low_rad_s, high_rad_s);
    }
    return CO_ABORT_NONE;
}

uint32_t controller_node_crc_of(const struct control_params *params)
{
    const uint32_t crc = crc32_update(CRC32_INIT, params, CONTROLLER_PARAMS_BYTES);
    return params->branch != NULL ? crc32_update(crc, params->branch, sizeof *params->branch) : crc;
}

static void show_settings_store(struct controller_node *node)
{
    node->comm.store = node->comm.restore = node->settings_store != NULL ? ON_COMMAND : 0;
}

/* The record is shown as long as nobody has said that it was seen. */
static void show_crash(struct controller_node *node)
{
    struct controller_objects *objects = &node->objects;
    const struct crash_record *record = node->crash;
    const bool left = record != NULL && crash_record_is_valid(record);
    objects->crash_cause = left ? (uint8_t)record->cause : (uint8_t)CRASH_NONE;
    objects->crash_image.bytes = (const uint8_t *)record;
    objects->crash_image.length = left ? sizeof *record : 0;
}

static void written(void *context, const struct co_entry *entry)
{
    struct controller_node *node = (struct controller_node *)context;
    struct controller_objects *objects = &node->objects;
    if (entry->index == INDEX_STORE || entry->index == INDEX_RESTORE) {
        show_settings_store(node);
    } else if (entry->index == INDEX_CRASH) {
        crash_record_acknowledge(node->crash);
        show_crash(node);
    } else if (entry->index == INDEX_BLACK_BOX && objects->black_box_state == BLACK_BOX_FROZEN) {
        black_box_freeze(node->black_box, 0);
    } else if (entry->index == INDEX_BLACK_BOX) {
        black_box_start(node->black_box, objects->build_id, objects->params_crc);
    }
}

/* Counters are fetched now; the image may be read while nothing writes it any more. */
static void reading(void *context, const struct co_entry *entry)
{
    struct controller_node *node = (struct controller_node *)context;
    struct controller_objects *objects = &node->objects;
    if (entry->index == INDEX_COUNTERS && node->show_counters != NULL) {
        node->show_counters(node->show_context);
    }
    if (entry->index != INDEX_BLACK_BOX || node->black_box == NULL) {
        return;
    }
    const struct black_box_header *header = &node->black_box->header;
    objects->black_box_state = (uint8_t)header->state;
    objects->black_box_reason = header->reason;
    objects->black_box_image.bytes = (const uint8_t *)node->black_box;
    objects->black_box_image.length =
        header->state == (uint32_t)BLACK_BOX_FROZEN ? sizeof *node->black_box : 0;
}

/* The next bytes of what the CRC covers, from `at` on: at most `most` of them. */
static const uint8_t *covered(const struct control_params *params, size_t at, size_t most,
                              size_t *count)
{
    const bool own = at < CONTROLLER_PARAMS_BYTES;
    const uint8_t *bytes = own ? (const uint8_t *)params + at
                               : (const uint8_t *)params->branch + (at - CONTROLLER_PARAMS_BYTES);
    const size_t left =
        own ? CONTROLLER_PARAMS_BYTES - at : CONTROLLER_PARAMS_BYTES + sizeof *params->branch - at;
    *count = left < most ? left : most;
    return bytes;
}

bool controller_node_params_corrupt(struct controller_node *node)
{
    const struct control_params *params = &node->objects.params;
    const size_t size = covered_bytes(params);
    if (node->crc_at == 0) {
        node->crc_so_far = CRC32_INIT;
        node->crc_expected = node->objects.params_crc;
    }
    size_t part;
    const uint8_t *bytes = covered(params, node->crc_at, CONTROLLER_CRC_BYTES, &part);
    node->crc_so_far = crc32_update(node->crc_so_far, bytes, part);
    node->crc_at = (uint16_t)(node->crc_at + part);
    if (node->crc_at == size) {
        node->crc_at = 0;
        /* Written meanwhile by SDO: this round saw some of both. */
        if (node->crc_expected == node->objects.params_crc) {
            node->params_corrupt = node->crc_so_far != node->crc_expected;
        }
    }
    return node->params_corrupt;
}

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
    comm->tpdo[TPDO_STEP].cob_id = FRAME_TELEMETRY;
    comm->tpdo[TPDO_STEP].map[0] = UINT32_C(0x20020110);
    comm->tpdo[TPDO_STEP].map[1] = UINT32_C(0x20020210);
    comm->tpdo[TPDO_STEP].map[2] = UINT32_C(0x20020310);
    comm->tpdo[TPDO_STEP].map[3] = UINT32_C(0x20020408);
    comm->tpdo[TPDO_STEP].map[4] = UINT32_C(0x20020508);
    comm->tpdo[TPDO_STEP].map_count = 5;
    comm->tpdo[TPDO_STATE].cob_id = FRAME_CONTROLLER_STATE;
    comm->tpdo[TPDO_STATE].event_ms = SLOW_PDO_TICKS * TICK_PERIOD_US / 1000;
    comm->tpdo[TPDO_STATE].map[0] = UINT32_C(0x20010108);
    comm->tpdo[TPDO_STATE].map[1] = UINT32_C(0x20010208);
    comm->tpdo[TPDO_STATE].map[2] = UINT32_C(0x20010320);
    comm->tpdo[TPDO_STATE].map_count = 3;
    comm->sync_cob_id |= CO_SYNC_PRODUCER;
    comm->sync_period_us = TICK_PERIOD_US;
    put_text(comm->name, sizeof comm->name, "AFO controller");
    put_text(comm->hardware_version, sizeof comm->hardware_version, CONTROLLER_HARDWARE_VERSION);
    put_text(comm->software_version, sizeof comm->software_version, version_text());
}

static const struct co_device_ops device_ops = {
    .access = {.writing = writing, .written = written, .reading = reading}};

static void default_objects(struct controller_objects *objects, const struct control_params *params)
{
    /* Field by field: a whole struct on the stack is more than the device has to spare. */
    memset(objects, 0, sizeof *objects);
    objects->command_count = 4;
    objects->state_count = 4;
    objects->step_count = 5;
    objects->record_count = 4;
    objects->param_count = CONTROL_PARAM_COUNT;
    objects->counter_count = 12;
    objects->identity_count = 3;
    objects->setup_count = 6;
    objects->crash_count = 2;
    objects->black_box_count = 3;
    objects->params = *params;
    objects->build_id = version_build_id();
    put_text(objects->version, sizeof objects->version, version_text());
    objects->params_crc = controller_node_crc_of(&objects->params);
}

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
    node->comm.store_count = node->comm.restore_count = 1;
    const struct co_device_config config = {
        .node_id = NODE_CONTROLLER,
        .application = &dictionary,
        .ops = &device_ops,
        .context = node,
        .pdos = {.objects = {controller_comm_table, controller_comm_count, &node->comm},
                 .tpdo = node->comm.tpdo,
                 .tpdo_count = TPDO_COUNT},
        .defaults = defaults};
    if (co_device_init(&node->device, &config, bus, 0) != 0) {
        return -1;
    }
    /* The master starts itself (CiA 301: a self-starting device). */
    const struct can_msg start = {
        .id = FRAME_NMT, .length = 2, .data = {CO_NMT_START, NODE_CONTROLLER}};
    (void)co_device_receive(&node->device, &start, 0);
    node->sent_state = UINT8_MAX; /* whatever the state is: tell it at the first tick */
    return 0;
}

void controller_node_attach(struct controller_node *node,
                            const struct controller_settings_store_ops *settings_store,
                            void *settings_store_context, struct black_box *black_box,
                            struct crash_record *crash)
{
    node->settings_store = settings_store;
    node->settings_store_context = settings_store_context;
    node->black_box = black_box;
    node->crash = crash;
    show_settings_store(node);
    show_crash(node);
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

static uint16_t scaled_u16(float value, float units)
{
    return (uint16_t)bytes_saturate_i32(value * units, 0, UINT16_MAX);
}

static void show_step(struct controller_objects *objects, const struct step_record *step)
{
    objects->step_measured = scaled_u16(step->measured_speed_rad_s, SPEED_UNITS_PER_RAD_S);
    objects->step_commanded = scaled_u16(step->commanded_speed_rad_s, SPEED_UNITS_PER_RAD_S);
    objects->step_r0 = scaled_u16(step->r0_m, R0_UNITS_PER_METRE);
    objects->step_number = (uint8_t)(step->number & 0xFFu);
    objects->step_side_fault = (uint8_t)((step->side == SIDE_RIGHT ? RIGHT_BIT : 0u) |
                                         (step->used_fallback ? FELL_BACK_BIT : 0u) |
                                         (objects->fault & (FELL_BACK_BIT - 1u)));
    objects->record_number = step->number;
    objects->record_measured_rad_s = step->measured_speed_rad_s;
    objects->record_commanded_rad_s = step->commanded_speed_rad_s;
    objects->record_r0_m = step->r0_m;
}

static void tell_fault(struct controller_node *node)
{
    const struct controller_objects *objects = &node->objects;
    const uint8_t vendor[5] = {objects->state, objects->fault, 0, 0, 0};
    if (objects->fault != 0) {
        co_device_raise_for(&node->device, CONTROLLER_EMCY_FAULT, objects->fault, CO_ERROR_GENERIC,
                            vendor);
    }
    co_device_clear_for(&node->device, CONTROLLER_EMCY_FAULT, node->sent_fault);
}

/* The found offsets become parameters, to be stored like the others. */
static void take_zero(struct controller_node *node, const struct zero_offsets *found)
{
    change_parameter(node, offsetof(struct control_params, angle_zero_left_rad),
                     found->angle_rad[SIDE_LEFT]);
    change_parameter(node, offsetof(struct control_params, angle_zero_right_rad),
                     found->angle_rad[SIDE_RIGHT]);
    change_parameter(node, offsetof(struct control_params, ankle_zero_left_m),
                     found->ankle_m[SIDE_LEFT]);
    change_parameter(node, offsetof(struct control_params, ankle_zero_right_m),
                     found->ankle_m[SIDE_RIGHT]);
}

static bool had_event(const struct controller *controller)
{
    const struct gait_event *event = controller->observer.state.event;
    return event[GAIT_APEX].happened || event[GAIT_HEEL_STRIKE].happened ||
           event[GAIT_LIFT_OFF].happened;
}

void controller_node_update(struct controller_node *node, const struct controller *controller,
                            const struct controller_output *output, bool emergency_stop,
                            uint64_t now_ns)
{
    struct controller_objects *objects = &node->objects;
    node->powered = supervisor_may_enable(output->state);
    node->standstill = checks_standstill(&controller->checks);
    objects->state =
        (uint8_t)((emergency_stop ? EMERGENCY_STOP_BIT : 0u) | ((unsigned)output->state & 0x7Fu));
    objects->fault = (uint8_t)((unsigned)output->fault & 0x7Fu);
    if (objects->state != node->sent_state || objects->fault != node->sent_fault) {
        if (objects->fault != node->sent_fault) {
            tell_fault(node);
        }
        node->sent_state = objects->state;
        node->sent_fault = objects->fault;
        co_device_trigger_tpdo(&node->device, TPDO_STATE);
    }
    if (output->new_step) {
        show_step(objects, &controller->last_step);
        co_device_trigger_tpdo(&node->device, TPDO_STEP);
    }
    objects->zeroing = (uint8_t)output->zeroing;
    if (output->new_zero) {
        take_zero(node, &controller->zeroing.mean);
    }
    /* In the ticks of gait events the controller has the most to do; telegrams can wait
     * for the next. */
    if (!had_event(controller)) {
        co_device_process(&node->device, now_ns);
    }
}

void controller_node_report_setup(struct controller_node *node, const struct setup_failure *failure)
{
    struct controller_objects *objects = &node->objects;
    objects->refused_node = failure->node;
    objects->refused_verdict = (uint8_t)(-(int)failure->verdict);
    objects->refused_index = failure->index;
    objects->refused_sub = failure->sub;
    objects->refused_expected = failure->expected;
    objects->refused_found = failure->found;
    const uint8_t vendor[5] = {failure->node, (uint8_t)(failure->index & 0xFFu),
                               (uint8_t)(failure->index >> 8), failure->sub,
                               objects->refused_verdict};
    co_device_raise_for(&node->device, CONTROLLER_EMCY_SETUP_REFUSED, failure->node,
                        CO_ERROR_GENERIC, vendor);
}

void controller_node_setup_done(struct controller_node *node, uint8_t which)
{
    if (node->objects.refused_node == which) {
        node->objects.refused_node = 0;
    }
    co_device_clear_for(&node->device, CONTROLLER_EMCY_SETUP_REFUSED, which);
}
