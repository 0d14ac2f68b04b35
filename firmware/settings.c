#include "firmware/settings.h"

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "hal/devices/device_check.h"

static_assert(offsetof(struct control_params, table) == CONTROL_PARAM_COUNT * sizeof(real),
              "the fields of CONTROL_PARAM_TABLE come first, without gaps");
static_assert(sizeof(struct settings_record) % NV_WORD_BYTES == 0,
              "the record ends with a word: no byte behind it is asked for");

void settings_default(struct settings *settings)
{
    struct control_params *control = &settings->control;

    memset(settings, 0, sizeof *settings);
    /* In range whatever parameters there are; what must fit together is set below. */
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *d = &control_param_descriptors[i];
        memcpy((uint8_t *)control + d->offset, &d->minimum, sizeof d->minimum);
    }
    control->torso_mass_kg = 1.0f;
    control->leg_mass_kg = 0.01f;
    control->leg_length_m = 1.0f;
    control->spring_stiffness_n_m = 100.0f;
    control->gravity_m_s2 = 9.80665f;
    control->start_r0_m = 0.05f;
    control->r0_min_m = 0.005f;
    control->r0_max_m = 0.3f;
    control->open_loop_r0_m = 0.05f;
    /* Four rising speeds over all push-offs: enough for the check, not for a walk. */
    control->table.count = 4;
    control->table.r0_min_m = 0.005f;
    control->table.r0_step_m = 0.1f;
    control->table.speed_rad_s[0] = 0.1f;
    control->table.speed_rad_s[1] = 0.7f;
    control->table.speed_rad_s[2] = 1.2f;
    control->table.speed_rad_s[3] = 1.6f;
    device_description_default(&settings->device);
    settings->desired_speed_rad_s = 0.407f;
}

static int is_finite(float value)
{
    return real_is_finite(value);
}

/* Whether every motor may go wherever the law may ask it to. */
static bool stroke_suffices(const struct settings *settings)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct device_leg *own = &settings->device.leg[leg];
        if (device_leg_is_driven(own) && settings->control.r0_max_m > own->stroke_max_m) {
            return false;
        }
    }
    return true;
}

static enum device_verdict check_device(const struct settings *settings)
{
    struct device_refusal refusal;
    return settings->control.body == (real)BODY_PERSON
               ? device_check_person(&settings->device, &refusal)
               : device_check(&settings->device, &refusal);
}

enum settings_result settings_check(const struct settings *settings)
{
    if (control_params_validate(&settings->control) != CONTROL_PARAMS_OK) {
        return SETTINGS_BAD_CONTROL;
    }
    if (check_device(settings) != DEVICE_OK) {
        return SETTINGS_BAD_DEVICE;
    }
    if (!stroke_suffices(settings)) {
        return SETTINGS_BAD_STROKE;
    }
    if (!is_finite(settings->desired_speed_rad_s) || settings->desired_speed_rad_s <= 0.0f ||
        settings->walk_at_start > 1u) {
        return SETTINGS_BAD_SPEED;
    }
    return SETTINGS_OK;
}

/* Field by field to where it belongs: the record as a whole is more than the stack has to spare. */
static enum param_store_result load_fields(struct settings *settings, struct param_store *store)
{
    const struct {
        uint32_t offset, size;
        void *to;
    } fields[] = {
        /* The parameters are one array of floats to the store: copied as part of the whole. */
        {offsetof(struct settings_values, control), CONTROL_PARAM_COUNT * sizeof(real),
         (uint8_t *)settings + offsetof(struct settings, control)},
        {offsetof(struct settings_values, table), sizeof settings->control.table,
         &settings->control.table},
        {offsetof(struct settings_values, device), sizeof settings->device, &settings->device},
        {offsetof(struct settings_values, desired_speed_rad_s), sizeof(float),
         &settings->desired_speed_rad_s},
        {offsetof(struct settings_values, walk_at_start), sizeof(uint32_t),
         &settings->walk_at_start},
    };
    enum param_store_result result = PARAM_STORE_OK;
    for (unsigned i = 0; i < sizeof fields / sizeof fields[0] && result == PARAM_STORE_OK; i++) {
        result = param_store_load(store, fields[i].offset, fields[i].to, fields[i].size);
    }
    return result;
}

enum param_store_result settings_load(struct settings *settings, struct param_store *store,
                                      const struct nv_store *nv)
{
    settings_default(settings);
    enum param_store_result result =
        param_store_open(store, nv, SETTINGS_VERSION, sizeof(struct settings_record));
    if (result == PARAM_STORE_OK) {
        result = load_fields(settings, store);
    }
    if (result == PARAM_STORE_OK) {
        settings->control.branch = settings_branch(store);
    } else {
        settings_default(settings);
    }
    return result;
}

/* One field of the record: where it belongs and where it comes from. */
struct piece {
    uint32_t offset;
    uint32_t length;
    const void *bytes; /* NULL = zeros */
};

enum { PIECES = 6 };

static void list_pieces(const struct settings_parts *parts, struct piece pieces[PIECES])
{
    const struct piece list[PIECES] = {
        {offsetof(struct settings_values, control), sizeof(real) * CONTROL_PARAM_COUNT,
         parts->control},
        {offsetof(struct settings_values, table), sizeof parts->control->table,
         &parts->control->table},
        {offsetof(struct settings_values, device), sizeof *parts->device, parts->device},
        {offsetof(struct settings_values, desired_speed_rad_s), sizeof(float),
         &parts->desired_speed_rad_s},
        {offsetof(struct settings_values, walk_at_start), sizeof(uint32_t), &parts->walk_at_start},
        {offsetof(struct settings_record, branch), sizeof(struct gait_branch),
         parts->control->branch},
    };
    memcpy(pieces, list, sizeof list);
}

/* A param_store_source: eight bytes of the record at a time. */
static void give_word(const void *context, uint32_t offset, uint8_t *out)
{
    const struct piece *pieces = context;

    for (uint32_t i = 0; i < NV_WORD_BYTES; i++, offset++) {
        out[i] = 0x00;
        for (uint32_t piece = 0; piece < PIECES; piece++) {
            const uint32_t within = offset - pieces[piece].offset;
            if (within < pieces[piece].length && pieces[piece].bytes != NULL) {
                out[i] = ((const uint8_t *)pieces[piece].bytes)[within];
            }
        }
    }
}

enum param_store_result settings_save_parts(const struct settings_parts *parts,
                                            struct param_store *store, bool standstill)
{
    struct piece pieces[PIECES];

    list_pieces(parts, pieces);
    return param_store_save(store, give_word, pieces, standstill);
}

const struct gait_branch *settings_branch(const struct param_store *store)
{
    const struct gait_branch *branch =
        param_store_map(store, offsetof(struct settings_record, branch));

    return branch != NULL && branch->count > 0u ? branch : NULL;
}

enum param_store_result settings_save(struct settings *settings, struct param_store *store,
                                      bool standstill)
{
    const struct settings_parts parts = {
        .control = &settings->control,
        .device = &settings->device,
        .desired_speed_rad_s = settings->desired_speed_rad_s,
        .walk_at_start = settings->walk_at_start,
    };
    const enum param_store_result result = settings_save_parts(&parts, store, standstill);

    if (result == PARAM_STORE_OK && settings->control.branch != NULL) {
        settings->control.branch = settings_branch(store);
    }
    return result;
}
