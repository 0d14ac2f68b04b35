#include "firmware/settings.h"

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

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
    /* Four points of the paper's gait curve: enough for the check, not for a walk. */
    control->table.count = 4;
    control->table.r0_min_m = 0.005f;
    control->table.r0_step_m = 0.1f;
    control->table.speed_rad_s[0] = 0.1f;
    control->table.speed_rad_s[1] = 0.7f;
    control->table.speed_rad_s[2] = 1.2f;
    control->table.speed_rad_s[3] = 1.6f;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        settings->axis[leg].counts_per_m = 13107200.0f;
        settings->axis[leg].direction = 1;
        settings->sensor[leg].angle_direction = 1;
        settings->setup.counts_per_m[leg] = 13107200u;
        settings->setup.limit_max_counts[leg] = 4587520; /* 0.35 m */
        settings->setup.following_error_counts[leg] = 1310720u;
    }
    settings->desired_speed_rad_s = 0.407f;
}

static int is_finite(float value)
{
    return real_is_finite(value);
}

/* The float below half the range: then zero and stroke together stay in it, to either side, also
 * where a count was rounded to a float. */
static const float counts_limit = 1073741760.0f;

static bool is_force(float force_N)
{
    return is_finite(force_N) && force_N >= 0.0f;
}

/* Whether the drive lets the motor go wherever the law may ask it to. */
static bool allows_stroke(const struct node_setup_config *setup, int leg,
                          const struct cia402_axis_config *axis, float r0_max_m)
{
    const int32_t end =
        axis->zero_counts + axis->direction * (int32_t)(r0_max_m * axis->counts_per_m);

    return setup->limit_min_counts[leg] <= (axis->direction > 0 ? axis->zero_counts : end) &&
           setup->limit_max_counts[leg] >= (axis->direction > 0 ? end : axis->zero_counts);
}

static enum settings_result check_leg(const struct cia402_axis_config *axis,
                                      const struct leg_sensor_config *sensor, float r0_max_m)
{
    if (!is_finite(axis->counts_per_m) || axis->counts_per_m <= 0.0f ||
        r0_max_m * axis->counts_per_m > counts_limit || (float)axis->zero_counts > counts_limit ||
        (float)axis->zero_counts < -counts_limit || !is_force(axis->rated_force_N) ||
        (axis->direction != 1 && axis->direction != -1)) {
        return SETTINGS_BAD_AXIS;
    }
    if (!is_finite(sensor->angle_zero_rad) ||
        (sensor->angle_direction != 1 && sensor->angle_direction != -1)) {
        return SETTINGS_BAD_SENSOR;
    }
    if (sensor->ankle_is_lever &&
        (!is_finite(sensor->ankle_lever_m) || sensor->ankle_lever_m <= 0.0f ||
         !is_finite(sensor->ankle_neutral_rad))) {
        return SETTINGS_BAD_SENSOR;
    }
    return SETTINGS_OK;
}

static enum settings_result check_setup(const struct settings *settings, int leg)
{
    const struct node_setup_config *setup = &settings->setup;
    const struct cia402_axis_config *axis = &settings->axis[leg];
    const float counts_per_m = (float)setup->counts_per_m[leg];

    if (setup->counts_per_m[leg] == 0u || counts_per_m != axis->counts_per_m ||
        setup->rated_force_N[leg] != axis->rated_force_N ||
        setup->limit_min_counts[leg] >= setup->limit_max_counts[leg] ||
        !allows_stroke(setup, leg, axis, settings->control.r0_max_m) ||
        setup->ankle_is_lever[leg] != settings->sensor[leg].ankle_is_lever ||
        setup->following_error_counts[leg] == 0u) {
        return SETTINGS_BAD_SETUP;
    }
    return SETTINGS_OK;
}

enum settings_result settings_check(const struct settings *settings)
{
    if (control_params_validate(&settings->control) != CONTROL_PARAMS_OK) {
        return SETTINGS_BAD_CONTROL;
    }
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        enum settings_result result =
            check_leg(&settings->axis[leg], &settings->sensor[leg], settings->control.r0_max_m);
        if (result == SETTINGS_OK) {
            result = check_setup(settings, leg);
        }
        if (result != SETTINGS_OK) {
            return result;
        }
    }
    if (!is_finite(settings->desired_speed_rad_s) || settings->desired_speed_rad_s <= 0.0f ||
        settings->walk_at_start > 1u) {
        return SETTINGS_BAD_SPEED;
    }
    return SETTINGS_OK;
}

enum param_store_result settings_load(struct settings *settings, struct param_store *store,
                                      const struct nv_store *nv)
{
    struct settings_values kept;
    enum param_store_result result;

    settings_default(settings);
    result = param_store_open(store, nv, SETTINGS_VERSION, sizeof(struct settings_record));
    if (result == PARAM_STORE_OK) {
        result = param_store_load(store, 0, &kept, sizeof kept);
    }
    if (result != PARAM_STORE_OK) {
        return result;
    }
    /* The parameters are one array of floats to the store: copied as part of the whole. */
    memcpy((uint8_t *)settings + offsetof(struct settings, control), kept.control,
           sizeof kept.control);
    settings->control.table = kept.table;
    settings->control.branch = settings_branch(store);
    memcpy(settings->axis, kept.axis, sizeof settings->axis);
    memcpy(settings->sensor, kept.sensor, sizeof settings->sensor);
    settings->setup = kept.setup;
    settings->desired_speed_rad_s = kept.desired_speed_rad_s;
    settings->walk_at_start = kept.walk_at_start;
    return PARAM_STORE_OK;
}

/* One field of the record: where it belongs and where it comes from. */
struct piece {
    uint32_t offset;
    uint32_t length;
    const void *bytes; /* NULL = zeros */
};

enum { PIECES = 9 };

static void list_pieces(const struct settings_parts *parts, struct piece pieces[PIECES])
{
    const uint32_t axis_bytes = sizeof(struct cia402_axis_config);
    const struct piece list[PIECES] = {
        {offsetof(struct settings_values, control), sizeof(real) * CONTROL_PARAM_COUNT,
         parts->control},
        {offsetof(struct settings_values, table), sizeof parts->control->table,
         &parts->control->table},
        {offsetof(struct settings_values, axis), axis_bytes, parts->axis[SIDE_LEFT]},
        {offsetof(struct settings_values, axis) + axis_bytes, axis_bytes, parts->axis[SIDE_RIGHT]},
        {offsetof(struct settings_values, sensor), SIDE_COUNT * sizeof *parts->sensor,
         parts->sensor},
        {offsetof(struct settings_values, setup), sizeof *parts->setup, parts->setup},
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
        .axis = {&settings->axis[SIDE_LEFT], &settings->axis[SIDE_RIGHT]},
        .sensor = settings->sensor,
        .setup = &settings->setup,
        .desired_speed_rad_s = settings->desired_speed_rad_s,
        .walk_at_start = settings->walk_at_start,
    };
    const enum param_store_result result = settings_save_parts(&parts, store, standstill);

    if (result == PARAM_STORE_OK && settings->control.branch != NULL) {
        settings->control.branch = settings_branch(store);
    }
    return result;
}
