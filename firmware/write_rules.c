#include "firmware/write_rules.h"

#include <stddef.h>

#include "firmware/params_guard.h"
#include "hal/bus/bytes.h"
#include "hal/canopen/co_defs.h"
#include "hal/devices/device_check.h"

enum {
    INDEX_STORE = 0x1010,
    INDEX_RESTORE = 0x1011,
    INDEX_PROGRAM_CONTROL = 0x1F51,
    INDEX_PROGRAM_IDENTIFICATION = 0x1F56,
    INDEX_PROGRAM_STATUS = 0x1F57,
    INDEX_COMMANDS = 0x2000,
    SUB_CUE = 10,
    INDEX_CHANGE_LOG = 0x2005,
    INDEX_PARAMS = 0x2010,
    INDEX_CRASH = 0x2032,
    INDEX_BLACK_BOX = 0x2040,
    INDEX_REFUSED_DEVICE = 0x2053,
    BOTH_LEGS = 255,
    INDEX_COMMISSIONING = 0x2060,
    INDEX_FORCE_SAMPLES = 0x2062,
    SUB_UNLOCK = 5,
    SUB_MARK = 7
};

/* What has to be written to 0x1010 and 0x1011 (CiA 301, clauses 7.5.2.13 and 7.5.2.14), and
 * what is read there: it does so on command. */
#define SIGNATURE_SAVE UINT32_C(0x65766173)
#define SIGNATURE_LOAD UINT32_C(0x64616F6C)
#define ON_COMMAND UINT32_C(1)

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

/* What this walker bears, and what is locked for this person: made with the settings. */
static uint32_t check_ceilings(const struct control_params *params, size_t offset, float value)
{
    if (offset == offsetof(struct control_params, kp_m_s_rad)) {
        return params->kp_high_m_s_rad > 0.0f
                   ? check_range(value, params->kp_low_m_s_rad, params->kp_high_m_s_rad)
                   : CO_ABORT_DEVICE_STATE;
    }
    if (offset == offsetof(struct control_params, r0_max_m)) {
        return check_range(value, 0.0f,
                           params->r0_ceiling_m > 0.0f ? params->r0_ceiling_m : params->r0_max_m);
    }
    if (offset == offsetof(struct control_params, r0_change_max_m)) {
        return check_range(value, 0.0f,
                           params->r0_change_ceiling_m > 0.0f ? params->r0_change_ceiling_m
                                                              : params->r0_change_max_m);
    }
    return CO_ABORT_NONE;
}

static uint32_t check_parameter(struct write_rules *rules, unsigned parameter, float value)
{
    const struct control_param_descriptor *d = &control_param_descriptors[parameter];
    uint32_t verdict = check_range(value, d->minimum, d->maximum);
    if (verdict == CO_ABORT_NONE) {
        verdict = check_ceilings(&rules->objects->params, d->offset, value);
    }
    if (verdict != CO_ABORT_NONE) {
        return verdict;
    }
    if (rules->powered && !may_change_live(parameter)) {
        return CO_ABORT_DEVICE_STATE;
    }
    /* Tried in place, between two ticks: a copy of all is more than the stack has to spare. */
    float *field = (float *)((char *)&rules->objects->params + d->offset);
    const float before = *field;
    *field = value;
    const int verdict_of_all = control_params_validate(&rules->objects->params);
    *field = before;
    return verdict_of_all == CONTROL_PARAMS_OK ? CO_ABORT_NONE : CO_ABORT_VALUE;
}

static uint32_t write_device_key(const struct write_rules *rules, const struct co_entry *entry,
                                 const uint8_t *bytes)
{
    const int leg = (int)entry->index - DEVICE_INDEX_LEFT; /* -1: common */
    const struct device_key *row = device_key_row(leg, entry->sub - 1u);
    const float value =
        row->type == DEVICE_FLOAT ? bytes_get_f32(bytes) : (float)bytes_get_i32(bytes);
    if (rules->powered) {
        return CO_ABORT_DEVICE_STATE;
    }
    uint32_t verdict = check_range(value, row->minimum, row->maximum);
    if (verdict == CO_ABORT_NONE && device_key_check(row, value) != DEVICE_OK) {
        verdict = CO_ABORT_VALUE;
    }
    if (verdict == CO_ABORT_NONE) {
        const float before = device_value(&rules->objects->device, leg, entry->sub - 1u);
        settings_lock_note(&rules->lock, rules->objects, entry->index, entry->sub, before, value);
    }
    return verdict;
}

enum device_verdict write_rules_check_device(const struct write_rules *rules)
{
    struct controller_objects *objects = rules->objects;
    struct device_refusal refusal = {.verdict = DEVICE_OK};
    const enum device_verdict verdict = objects->params.body == (float)BODY_PERSON
                                            ? device_check_person(&objects->device, &refusal)
                                            : device_check(&objects->device, &refusal);
    const bool refused = verdict != DEVICE_OK;
    objects->device_verdict = (uint8_t)verdict;
    objects->device_refused_leg = (uint8_t)(refused && refusal.leg < 0 ? BOTH_LEGS : refusal.leg);
    objects->device_refused_key = (uint8_t)(refused ? refusal.key + 1u : 0u);
    return verdict;
}

/* Under torque the value in force goes to the one written by a ramp (write_rules_written). */
static uint32_t write_parameter(struct write_rules *rules, uint8_t place, float value)
{
    struct controller_objects *objects = rules->objects;
    const size_t offset = control_param_descriptors[place - 1u].offset;
    const float before = *(const float *)((const char *)&objects->params + offset);
    if (!settings_lock_is_open(&rules->lock)) {
        return CO_ABORT_DEVICE_STATE;
    }
    const uint32_t verdict = check_parameter(rules, place - 1u, value);
    if (verdict != CO_ABORT_NONE) {
        return verdict;
    }
    rules->before = before;
    if (!settings_lock_begin_ramp(&rules->lock, place, before, value)) {
        return CO_ABORT_DEVICE_STATE;
    }
    settings_lock_note(&rules->lock, objects, INDEX_PARAMS, place, before, value);
    return CO_ABORT_NONE;
}

static uint32_t keep_settings(const struct write_rules *rules, const struct co_entry *entry,
                              const uint8_t *bytes)
{
    const bool save = entry->index == INDEX_STORE;
    if (rules->settings_store == NULL ||
        bytes_get_u32(bytes) != (save ? SIGNATURE_SAVE : SIGNATURE_LOAD)) {
        return CO_ABORT_NOT_STORED;
    }
    if (rules->powered || !rules->standstill) {
        return CO_ABORT_DEVICE_STATE;
    }
    return save ? rules->settings_store->save_settings(rules->settings_store_context)
                : rules->settings_store->forget_settings(rules->settings_store_context);
}

/* Erasing and writing flash holds the loop up, and the restart ends it. */
static bool may_update(const struct write_rules *rules)
{
    return rules->update != NULL && !rules->powered && rules->standstill;
}

uint32_t write_rules_begin(void *context, const struct co_entry *entry, uint32_t total)
{
    const struct write_rules *rules = (const struct write_rules *)context;
    (void)entry; /* there is one domain to write */
    return may_update(rules) ? program_update_begin(rules->update, total) : CO_ABORT_DEVICE_STATE;
}

uint32_t write_rules_take(void *context, const struct co_entry *entry, const uint8_t *bytes,
                          unsigned length, bool last)
{
    const struct write_rules *rules = (const struct write_rules *)context;
    (void)entry;
    return may_update(rules) ? program_update_take(rules->update, bytes, length, last)
                             : CO_ABORT_DEVICE_STATE;
}

uint32_t write_rules_writing(void *context, const struct co_entry *entry, const uint8_t *bytes,
                             unsigned length)
{
    struct write_rules *rules = (struct write_rules *)context;
    if (entry->index == INDEX_PROGRAM_CONTROL) {
        return may_update(rules) ? program_update_control(rules->update, bytes[0])
                                 : CO_ABORT_DEVICE_STATE;
    }
    if (entry->index == INDEX_STORE || entry->index == INDEX_RESTORE) {
        return keep_settings(rules, entry, bytes);
    }
    if (entry->index == INDEX_CRASH) {
        return rules->crash == NULL ? CO_ABORT_DEVICE_STATE : CO_ABORT_NONE;
    }
    if (entry->index == INDEX_BLACK_BOX) {
        return rules->black_box == NULL || bytes[0] == BLACK_BOX_CLOSING ? CO_ABORT_DEVICE_STATE
                                                                         : CO_ABORT_NONE;
    }
    if (entry->index == INDEX_COMMANDS && entry->sub == SUB_UNLOCK) {
        return settings_lock_try(&rules->lock, rules->objects, bytes_get_u32(bytes));
    }
    if (entry->index >= DEVICE_INDEX_COMMON && entry->index <= DEVICE_INDEX_RIGHT) {
        return length == sizeof(float) ? write_device_key(rules, entry, bytes) : CO_ABORT_LENGTH;
    }
    if (entry->type != CO_REAL32 || length != sizeof(float)) {
        return CO_ABORT_NONE; /* the dictionary's own limits decide */
    }
    const float value = bytes_get_f32(bytes);
    if (entry->index == INDEX_PARAMS && entry->sub >= 1 && entry->sub <= CONTROL_PARAM_COUNT) {
        return write_parameter(rules, entry->sub, value);
    }
    if (entry->index == INDEX_COMMANDS) {
        float low_rad_s, high_rad_s;
        control_params_speeds(&rules->objects->params, &low_rad_s, &high_rad_s);
        return check_range(value, low_rad_s, high_rad_s);
    }
    return CO_ABORT_NONE;
}

static void show_settings_store(const struct write_rules *rules)
{
    rules->comm->store = rules->comm->restore = rules->settings_store != NULL ? ON_COMMAND : 0;
}

/* The record is shown as long as nobody has said that it was seen. */
static void show_crash(const struct write_rules *rules)
{
    struct controller_objects *objects = rules->objects;
    const struct crash_record *record = rules->crash;
    const bool left = record != NULL && crash_record_is_valid(record);
    objects->crash_cause = left ? (uint8_t)record->cause : (uint8_t)CRASH_NONE;
    objects->crash_image.bytes = (const uint8_t *)record;
    objects->crash_image.length = left ? sizeof *record : 0;
}

static void show_program(const struct write_rules *rules)
{
    struct controller_comm *comm = rules->comm;
    comm->program_control = PROGRAM_CONTROL_START; /* one runs, whatever was written */
    comm->program_identification = rules->update != NULL ? rules->update->identification : 0;
    comm->program_status =
        rules->update != NULL ? rules->update->status : (uint32_t)PROGRAM_STATUS_NONE;
}

void write_rules_written(void *context, const struct co_entry *entry)
{
    struct write_rules *rules = (struct write_rules *)context;
    struct controller_objects *objects = rules->objects;
    if (entry->index == INDEX_PARAMS) {
        /* It was stored between two ticks; in force it comes by the ramp, whose end is now where nothing is
         * loaded. */
        *(float *)((char *)&objects->params + control_param_descriptors[entry->sub - 1u].offset) =
            rules->before;
        settings_lock_move(&rules->lock, objects, !rules->powered);
    } else if (entry->index == INDEX_COMMANDS && entry->sub == SUB_UNLOCK) {
        objects->unlock = 0;
    } else if (entry->index == INDEX_COMMANDS && entry->sub == SUB_MARK) {
        if (rules->sync_pulse != NULL) {
            sync_pulse_give(rules->sync_pulse);
        }
    } else if (entry->index == INDEX_PROGRAM_CONTROL) {
        show_program(rules);
    } else if (entry->index == INDEX_STORE || entry->index == INDEX_RESTORE) {
        show_settings_store(rules);
    } else if (entry->index == INDEX_CRASH) {
        crash_record_acknowledge(rules->crash);
        show_crash(rules);
    } else if (entry->index == INDEX_BLACK_BOX && objects->black_box_state == BLACK_BOX_FROZEN) {
        black_box_freeze(rules->black_box, 0);
    } else if (entry->index == INDEX_BLACK_BOX) {
        black_box_start(rules->black_box, objects->build_id, objects->params_crc);
    }
}

/* Counters are fetched now; the image may be read while nothing writes it any more. */
uint32_t write_rules_reading(void *context, const struct co_entry *entry)
{
    struct write_rules *rules = (struct write_rules *)context;
    struct controller_objects *objects = rules->objects;
    if (entry->index == INDEX_REFUSED_DEVICE) {
        (void)write_rules_check_device(rules);
    }
    if (entry->index == INDEX_CHANGE_LOG) {
        objects->change_records = (struct co_domain){(const uint8_t *)objects->changes.record,
                                                     sizeof objects->changes.record};
    }
    const bool is_shown =
        entry->index == CONTROLLER_INDEX_COUNTERS || entry->index == CONTROLLER_INDEX_DRIVES ||
        (entry->index == CONTROLLER_INDEX_STATE && entry->sub == SUB_CUE) ||
        (entry->index >= INDEX_COMMISSIONING && entry->index <= INDEX_FORCE_SAMPLES);
    if (is_shown && rules->show != NULL) {
        rules->show(rules->show_context, entry->index);
    }
    if (entry->index == INDEX_PROGRAM_IDENTIFICATION || entry->index == INDEX_PROGRAM_STATUS) {
        show_program(rules);
    }
    if (entry->index != INDEX_BLACK_BOX || rules->black_box == NULL) {
        return CO_ABORT_NONE;
    }
    const struct black_box_header *header = &rules->black_box->header;
    objects->black_box_state = (uint8_t)header->state;
    objects->black_box_reason = header->reason;
    objects->black_box_image.bytes = (const uint8_t *)rules->black_box;
    objects->black_box_image.length =
        header->state == (uint32_t)BLACK_BOX_FROZEN ? sizeof *rules->black_box : 0;
    return CO_ABORT_NONE;
}

void write_rules_show_attached(const struct write_rules *rules)
{
    show_settings_store(rules);
    show_crash(rules);
    show_program(rules);
}
