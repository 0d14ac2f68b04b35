#include "controller/control_params.h"

#include <stdbool.h>

/* What a person reads stays on the host: the device is built with PARAMS_WITHOUT_TEXT. */
#ifdef PARAMS_WITHOUT_TEXT
#define TEXT(text) ""
#else
#define TEXT(text) text
#endif
#define DESCRIPTOR(field, unit, minimum, maximum, meaning) \
    {TEXT(#field),  TEXT(unit),    REAL(minimum),          \
     REAL(maximum), TEXT(meaning), (uint16_t)offsetof(struct control_params, field)},
const struct control_param_descriptor control_param_descriptors[CONTROL_PARAM_COUNT] = {
    CONTROL_PARAM_TABLE(DESCRIPTOR)};
#undef DESCRIPTOR

/* The part of r0_max that a gait may need: at its limit eq. (16) cannot brake an excursion. */
#define R0_RATIO REAL(0.95)

static bool needs_branch(const struct control_params *params)
{
    const struct law *law = law_of(params->law);
    return law != NULL && law->needs_branch;
}

static int check_law(const struct control_params *params)
{
    if (law_of(params->law) == NULL) {
        return CONTROL_PARAMS_LAW;
    }
    const bool has_branch = params->branch != NULL && gait_branch_check(params->branch);
    return !needs_branch(params) || has_branch ? CONTROL_PARAMS_OK : CONTROL_PARAMS_BRANCH;
}

/* What is locked for a person holds for whoever sets the parameters, the person's own file, too. */
static int check_locked(const struct control_params *params)
{
    if (params->kp_low_m_s_rad > params->kp_high_m_s_rad) {
        return CONTROL_PARAMS_GAIN_RANGE;
    }
    if (params->kp_high_m_s_rad > REAL(0.0) &&
        !real_is_within(params->kp_m_s_rad, params->kp_low_m_s_rad, params->kp_high_m_s_rad)) {
        return CONTROL_PARAMS_GAIN;
    }
    if (params->r0_ceiling_m > REAL(0.0) && params->r0_max_m > params->r0_ceiling_m) {
        return CONTROL_PARAMS_R0_CEILING;
    }
    return params->r0_change_ceiling_m > REAL(0.0) &&
                   params->r0_change_max_m > params->r0_change_ceiling_m
               ? CONTROL_PARAMS_R0_CHANGE_CEILING
               : CONTROL_PARAMS_OK;
}

int control_params_validate(const struct control_params *params)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *d = &control_param_descriptors[i];
        const real value = *(const real *)((const char *)params + d->offset);
        if (!(value >= d->minimum && value <= d->maximum)) {
            return i;
        }
    }
    if (speed_table_check(&params->table) != SPEED_TABLE_OK) {
        return CONTROL_PARAMS_BAD_TABLE;
    }
    if (!(params->r0_min_m <= params->start_r0_m && params->start_r0_m <= params->r0_max_m)) {
        return CONTROL_PARAMS_R0_ORDER;
    }
    if (params->r0_max_m > REAL(0.4) * params->leg_length_m) {
        return CONTROL_PARAMS_R0_STROKE;
    }
    if (params->law == (real)LAW_OPEN_LOOP &&
        (params->open_loop_r0_m < params->r0_min_m || params->open_loop_r0_m > params->r0_max_m)) {
        return CONTROL_PARAMS_OPEN_LOOP;
    }
    /* Without, the first spring is loaded at once, at the full level, behind a person who may stand. */
    if (params->body == (real)BODY_PERSON && params->engage_steps < REAL(1.0)) {
        return CONTROL_PARAMS_ENGAGE;
    }
    const int locked = check_locked(params);
    return locked == CONTROL_PARAMS_OK ? check_law(params) : locked;
}

void control_params_speeds(const struct control_params *params, real *low_rad_s, real *high_rad_s)
{
    const struct gait_branch *branch = params->branch;
    *low_rad_s = speed_table_speed(&params->table, params->r0_min_m);
    *high_rad_s = speed_table_speed(&params->table, R0_RATIO * params->r0_max_m);
    if (needs_branch(params)) {
        const real last_rad_s =
            branch->speed_min_rad_s + branch->speed_step_rad_s * (real)(branch->count - 1u);
        *low_rad_s = branch->speed_min_rad_s > *low_rad_s ? branch->speed_min_rad_s : *low_rad_s;
        *high_rad_s = last_rad_s < *high_rad_s ? last_rad_s : *high_rad_s;
    }
}
