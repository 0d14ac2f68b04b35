#include "sim_host/host/subject.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/host/ini.h"
#include "sim_host/host/law_name.h"
#include "sim_host/study/gait_curve.h"
#include "sim_host/study/laws_table.h"

/* Paper's walker, which all gains are scaled from. */
#define PAPER_LENGTH_M 1.0
#define PAPER_GRAVITY_M_S2 9.80665
#define PAPER_KP 0.042
#define PAPER_SPRING_RATIO (100.0 * 1.0 / (1.0 * 9.80665)) /* k l / (M g) */

struct subject_key {
    const char *section;
    const char *key;
    double minimum, maximum;
    size_t offset;
    const char *meaning;
};

enum { SUBJECT_KEYS = 19, SUBJECT_KEYS_REQUIRED = 4 };

/* What a file says, and which keys it has said already. */
struct reading {
    struct subject *subject;
    bool given[SUBJECT_KEYS];
};

/* The first SUBJECT_KEYS_REQUIRED have no default: a body is nobody's guess. */
#define KEY(section, key, minimum, maximum, field, meaning)                                  \
    {section, key, minimum, maximum, offsetof(struct subject, field), meaning}
static const struct subject_key subject_keys[SUBJECT_KEYS] = {
    KEY("walker", "M", 0.1, 200.0, torso_mass_kg, "mass at the hip, kg"),
    KEY("walker", "m", 0.0001, 30.0, leg_mass_kg, "mass in the middle of each leg, kg"),
    KEY("walker", "l", 0.1, 1.5, leg_length_m, "leg length, m"),
    KEY("walker", "k", 1.0, 100000.0, spring_N_per_m, "ankle spring, N/m"),
    KEY("walker", "g", 1.0, 20.0, gravity_m_s2, "gravity, m/s^2"),
    KEY("sea", "stroke_max_m", 0.001, 0.6, stroke_max_m, "longest compression, m"),
    KEY("sea", "speed_max_m_s", 0.001, 10.0, speed_max_m_s, "motor speed limit, m/s of spring"),
    KEY("sea", "force_max_N", 0.1, 50000.0, force_max_N, "motor force limit, N"),
    KEY("sea", "counts_per_m", 1000.0, 1.0e8, counts_per_m, "motor counts per metre of spring"),
    KEY("drive", "turns_per_m", 0.1, 100000.0, turns_per_m, "CANSimple: motor turns per metre of spring"),
    KEY("drive", "rad_per_m", 0.1, 100000.0, rad_per_m, "MIT: motor angle per metre of spring, rad/m"),
    KEY("drive", "zero_rad", -100.0, 100.0, zero_rad, "MIT: motor angle at the unloaded spring, rad"),
    KEY("drive", "position_range_rad", 0.1, 1000.0, position_range_rad, "MIT: position field, +- rad"),
    KEY("drive", "velocity_range_rad_s", 0.1, 1000.0, velocity_range_rad_s,
        "MIT: velocity field, +- rad/s"),
    KEY("drive", "torque_range_Nm", 0.1, 1000.0, torque_range_Nm, "MIT: torque field, +- Nm"),
    KEY("drive", "kp_Nm_rad", 0.0, 500.0, kp_Nm_rad, "MIT: position gain, Nm/rad"),
    KEY("drive", "kd_Nms_rad", 0.0, 5.0, kd_Nms_rad, "MIT: velocity gain, Nm s/rad"),
    KEY("ankle", "lever_m", 0.01, 0.5, ankle_lever_m, "lever of an ankle joint, m"),
    KEY("ankle", "neutral_rad", -1.0, 1.0, ankle_neutral_rad, "plantarflexion at extension 0, rad"),
};
#undef KEY

void subject_default(struct subject *subject)
{
    *subject = (struct subject){
        .name = "paper's walker",
        .torso_mass_kg = 1.0,
        .leg_mass_kg = 0.01,
        .leg_length_m = 1.0,
        .spring_N_per_m = 100.0,
        .gravity_m_s2 = PAPER_GRAVITY_M_S2,
        .stroke_max_m = 0.35,
        .speed_max_m_s = 1.9,
        .force_max_N = 90.0,
        .counts_per_m = 13107200.0,
        .ankle_lever_m = 0.12,
        .turns_per_m = 200.0, /* a 5 mm screw */
        .rad_per_m = 50.0,    /* a drum of 20 mm radius; AK80-9 ranges */
        .zero_rad = -12.0,
        .position_range_rad = 12.5,
        .velocity_range_rad_s = 50.0,
        .torque_range_Nm = 18.0,
        .kp_Nm_rad = 400.0,
        .kd_Nms_rad = 2.0,
    };
}

static int parse_number(const char *key, const char *value, double minimum, double maximum,
                        const char *meaning, double *result, char *message, size_t size)
{
    char *end = NULL;
    errno = 0;
    const double number = strtod(value, &end);
    if (end == value || *end != '\0' || errno == ERANGE || !isfinite(number)) {
        snprintf(message, size, "key \"%s\" (%s): \"%.40s\" is not a number", key, meaning, value);
        return -1;
    }
    if (number < minimum || number > maximum) {
        snprintf(message, size, "key \"%s\" (%s): %.40s is out of range, allowed is %g to %g", key,
                 meaning, value, minimum, maximum);
        return -1;
    }
    *result = number;
    return 0;
}

static int take_control_key(struct subject *subject, const char *key, const char *value,
                            char *message, size_t size)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        const struct control_param_descriptor *d = &control_param_descriptors[i];
        if (strcmp(key, d->name) == 0) {
            enum law_mode law;
            subject->control_overridden[i] = true;
            if (strcmp(key, "law") == 0 && law_from_name(value, &law) == 0) {
                subject->control_override[i] = (double)law;
                return 0;
            }
            return parse_number(key, value, (double)d->minimum, (double)d->maximum, d->meaning,
                                &subject->control_override[i], message, size);
        }
    }
    snprintf(message, size, "unknown key \"%s\" in section [controller]", key);
    return -1;
}

static int take_protocol(struct subject *subject, const char *value, char *message, size_t size)
{
    static const char *const names[] = {"cia402", "cansimple", "mit"};
    for (int i = 0; i < 3; i++) {
        if (strcmp(value, names[i]) == 0) {
            subject->protocol = (enum drive_protocol)i;
            return 0;
        }
    }
    snprintf(message, size,
             "key \"protocol\": \"%.40s\" is unknown, allowed is cia402, cansimple or mit", value);
    return -1;
}

static int take_ankle_kind(struct subject *subject, const char *value, char *message, size_t size)
{
    if (strcmp(value, "linear") == 0) {
        subject->ankle = ANKLE_LINEAR;
        return 0;
    }
    if (strcmp(value, "lever") == 0) {
        subject->ankle = ANKLE_LEVER;
        return 0;
    }
    snprintf(message, size, "key \"kind\": \"%.40s\" is unknown, allowed is linear or lever", value);
    return -1;
}

static int take_key(void *context, const char *section, const char *key, const char *value, int line,
                    char *message, size_t size)
{
    struct reading *reading = (struct reading *)context;
    struct subject *subject = reading->subject;
    (void)line;
    if (strcmp(section, "subject") == 0 && strcmp(key, "name") == 0) {
        snprintf(subject->name, sizeof subject->name, "%.*s", SUBJECT_NAME_MAX - 1, value);
        return 0;
    }
    if (strcmp(section, "controller") == 0) {
        return take_control_key(subject, key, value, message, size);
    }
    if (strcmp(section, "drive") == 0 && strcmp(key, "protocol") == 0) {
        return take_protocol(subject, value, message, size);
    }
    if (strcmp(section, "ankle") == 0 && strcmp(key, "kind") == 0) {
        return take_ankle_kind(subject, value, message, size);
    }
    for (int i = 0; i < SUBJECT_KEYS; i++) {
        const struct subject_key *k = &subject_keys[i];
        if (strcmp(section, k->section) == 0 && strcmp(key, k->key) == 0) {
            if (reading->given[i]) {
                snprintf(message, size, "key \"%s\" (%s) is given twice", key, k->meaning);
                return -1;
            }
            reading->given[i] = true;
            return parse_number(key, value, k->minimum, k->maximum, k->meaning,
                                (double *)((char *)subject + k->offset), message, size);
        }
    }
    snprintf(message, size, "unknown key \"%.40s\" in section [%.40s]", key, section);
    return -1;
}

int subject_read(struct subject *subject, const char *path, char *message)
{
    struct reading reading = {.subject = subject};
    subject_default(subject);
    subject->stroke_max_m = 0.0; /* not the paper's walker's: by this body's scale */
    subject->speed_max_m_s = 0.0;
    subject->force_max_N = 0.0;
    snprintf(subject->name, sizeof subject->name, "%.*s", SUBJECT_NAME_MAX - 1, path);
    if (ini_read(path, take_key, &reading, message, SUBJECT_MESSAGE_MAX) != 0) {
        return -1;
    }
    for (int i = 0; i < SUBJECT_KEYS_REQUIRED; i++) {
        if (!reading.given[i]) {
            snprintf(message, SUBJECT_MESSAGE_MAX,
                     "%s: section [%s] lacks key \"%s\" (%s), allowed is %g to %g", path,
                     subject_keys[i].section, subject_keys[i].key, subject_keys[i].meaning,
                     subject_keys[i].minimum, subject_keys[i].maximum);
            return -1;
        }
    }
    if (subject->leg_mass_kg > subject->torso_mass_kg) {
        snprintf(message, SUBJECT_MESSAGE_MAX, "%s: key \"m\" (%g kg) is above key \"M\" (%g kg)", path,
                 subject->leg_mass_kg, subject->torso_mass_kg);
        return -1;
    }
    return 0;
}

struct gait_walker subject_gait_walker(const struct subject *subject)
{
    return (struct gait_walker){subject->torso_mass_kg, subject->leg_mass_kg, subject->leg_length_m,
                                subject->spring_N_per_m, subject->gravity_m_s2};
}

double subject_stroke_m(const struct subject *subject)
{
    return subject->stroke_max_m > 0.0 ? subject->stroke_max_m : 0.35 * subject->leg_length_m;
}

struct walker_drives subject_drives(const struct subject *subject)
{
    const bool mit = subject->protocol == DRIVE_PROTOCOL_MIT;
    return (struct walker_drives){
        .protocol = subject->protocol,
        .units_per_m = mit ? subject->rad_per_m : subject->turns_per_m,
        .zero_units = mit ? subject->zero_rad : 0.0,
        .ranges = {subject->position_range_rad, subject->velocity_range_rad_s,
                   subject->torque_range_Nm}};
}

static int make_speed_table(const struct subject *subject, double length_scale,
                            struct speed_table *table, char *message)
{
    const struct gait_walker walker = subject_gait_walker(subject);
    const double first_m = 0.005 * length_scale;
    const double step_m = (0.3 * length_scale - first_m) / (SPEED_TABLE_MAX - 1);
    struct gait_point points[SPEED_TABLE_MAX];
    int reached = 0;
    const enum gait_curve_error error =
        gait_curve(&walker, first_m, step_m, SPEED_TABLE_MAX, points, &reached);
    if (error != GAIT_CURVE_OK) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "no curve of steady gaits for this walker beyond r0 = %g m: %s",
                 first_m + step_m * reached, gait_curve_error_name(error));
        return -1;
    }
    table->count = SPEED_TABLE_MAX;
    table->r0_min_m = (real)first_m;
    table->r0_step_m = (real)step_m;
    for (int i = 0; i < SPEED_TABLE_MAX; i++) {
        table->speed_rad_s[i] = (real)points[i].speed_rad_s;
    }
    return 0;
}

/* What the laws beyond eq. (16) need; a walker for which there is none has eq. (16) only. */
static void make_branch(const struct subject *subject, double length_scale,
                        struct gait_branch *branch)
{
    const struct gait_walker walker = subject_gait_walker(subject);
    const struct laws_weights weights = laws_weights_default();
    struct laws_table table;
    *branch = (struct gait_branch){.count = 0};
    if (laws_table_make(&walker, length_scale, &weights, &table) != LAWS_TABLE_OK) {
        return;
    }
    branch->count = (uint32_t)table.count;
    branch->speed_min_rad_s = (real)table.speed_min_rad_s;
    branch->speed_step_rad_s = (real)table.speed_step_rad_s;
    branch->r0_weight = (real)table.r0_weight;
    branch->travel_weight = (real)table.travel_weight;
    for (int i = 0; i < table.count; i++) {
        const struct laws_point *from = &table.point[i];
        struct gait_branch_point *to = &branch->point[i];
        to->r0_m = (real)from->r0_m;
        to->swing_angle_rad = (real)from->swing_angle_rad;
        to->swing_rate_rad_s = (real)from->swing_rate_rad_s;
        for (int k = 0; k < GAIT_BRANCH_COSTS; k++) {
            to->cost[k] = (real)from->cost[k];
        }
        for (int k = 0; k < 3; k++) {
            to->lqr_gain[k] = (real)from->lqr_gain[k];
            to->deadbeat_gain[k] = (real)from->deadbeat_gain[k];
        }
    }
}

/* Branches that were made, each once, kept for good: parameters point to them. */
struct kept_branch {
    struct gait_branch branch;
    struct gait_walker walker;
    double length_scale;
    struct kept_branch *next;
};

static const struct gait_branch *branch_of(const struct subject *subject, double length_scale)
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    static struct kept_branch *kept;
    const struct gait_walker walker = subject_gait_walker(subject);
    struct kept_branch *entry;

    pthread_mutex_lock(&lock);
    for (entry = kept; entry != NULL; entry = entry->next) {
        if (memcmp(&entry->walker, &walker, sizeof walker) == 0 &&
            entry->length_scale == length_scale) {
            break;
        }
    }
    if (entry == NULL && (entry = calloc(1, sizeof *entry)) != NULL) {
        entry->walker = walker;
        entry->length_scale = length_scale;
        make_branch(subject, length_scale, &entry->branch);
        entry->next = kept;
        kept = entry;
    }
    pthread_mutex_unlock(&lock);
    return entry != NULL && entry->branch.count > 0 ? &entry->branch : NULL;
}

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

static bool overridden(const struct subject *subject, size_t offset)
{
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (control_param_descriptors[i].offset == offset) {
            return subject->control_overridden[i];
        }
    }
    return false;
}

int subject_control_params(const struct subject *subject, struct control_params *params,
                           char *message)
{
    const double l = subject->leg_length_m;
    const double g = subject->gravity_m_s2;
    const double weight_N = subject->torso_mass_kg * g;
    const double time_scale = sqrt(l / g) / sqrt(PAPER_LENGTH_M / PAPER_GRAVITY_M_S2);
    /* Same spring energy in units of M g l. */
    const double length_scale =
        l * sqrt(PAPER_SPRING_RATIO / (subject->spring_N_per_m * l / weight_N));
    const double stroke = subject_stroke_m(subject);
    const double speed =
        subject->speed_max_m_s > 0.0 ? subject->speed_max_m_s : 0.6 * sqrt(g * l);
    const double force = subject->force_max_N > 0.0 ? subject->force_max_N
                                                    : 2.5 * subject->spring_N_per_m * stroke;

    *params = (struct control_params){
        .torso_mass_kg = (real)subject->torso_mass_kg,
        .leg_mass_kg = (real)subject->leg_mass_kg,
        .leg_length_m = (real)l,
        .spring_stiffness_n_m = (real)subject->spring_N_per_m,
        .gravity_m_s2 = (real)g,
        .law = (real)LAW_PROPORTIONAL,
        .kp_m_s_rad = (real)(PAPER_KP * length_scale * time_scale),
        .start_r0_m = (real)(0.05 * length_scale),
        .speed_ramp_rad_s = (real)(0.005 / time_scale),
        .r0_min_m = (real)(0.005 * length_scale),
        .r0_max_m =
            (real)smaller(0.3 * length_scale, smaller(stroke, force / subject->spring_N_per_m)),
        .r0_change_max_m = (real)(0.05 * length_scale),
        .open_loop_r0_m = (real)(0.05 * length_scale),
        .open_loop_ramp_m = (real)(0.0005 * length_scale),
        .apex_window_s = (real)(0.08 * time_scale),
        .angle_hysteresis_rad = REAL(0.01),
        .sensor_latency_s = REAL(0.0001), /* an absolute encoder that samples at SYNC */
        .sea_speed_max_m_s = (real)(0.8 * speed),
        .sea_acceleration_m_s2 = (real)(g),
        .sea_tolerance_m = (real)(0.001 * l),
        .sensor_age_max_s = REAL(0.01),
        .step_timeout_s = (real)(3.0 * time_scale),
        .fall_angle_rad = REAL(1.2),
        .unload_timeout_s = REAL(0.6),
        .engage_steps = REAL(0.0), /* the paper's walker has no push-off of its own */
        .engage_ramp_steps = REAL(10.0),
    };
    if (make_speed_table(subject, length_scale, &params->table, message) != 0) {
        return -1;
    }
    params->branch = branch_of(subject, length_scale);
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (subject->control_overridden[i]) {
            *(real *)((char *)params + control_param_descriptors[i].offset) =
                (real)subject->control_override[i];
        }
    }
    if (params->law == (real)LAW_PREDICTIVE &&
        !overridden(subject, offsetof(struct control_params, r0_change_max_m))) {
        params->r0_change_max_m = params->r0_max_m; /* what the motor can do limits it, step by step */
    }
    const int verdict = control_params_validate(params);
    if (verdict == CONTROL_PARAMS_OK) {
        return 0;
    }
    if (verdict < CONTROL_PARAM_COUNT) {
        const struct control_param_descriptor *d = &control_param_descriptors[verdict];
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "controller parameter %s = %g %s is out of range, allowed is %g to %g", d->name,
                 (double)*(const real *)((const char *)params + d->offset), d->unit,
                 (double)d->minimum, (double)d->maximum);
    } else if (verdict == CONTROL_PARAMS_R0_ORDER) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "controller parameters: r0_min_m %g <= start_r0_m %g <= r0_max_m %g does not hold",
                 (double)params->r0_min_m, (double)params->start_r0_m, (double)params->r0_max_m);
    } else if (verdict == CONTROL_PARAMS_OPEN_LOOP) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "open-loop r0 %g m lies outside what this subject allows, %g to %g m",
                 (double)params->open_loop_r0_m, (double)params->r0_min_m,
                 (double)params->r0_max_m);
    } else if (verdict == CONTROL_PARAMS_LAW) {
        snprintf(message, SUBJECT_MESSAGE_MAX, "controller parameter law = %g is no law",
                 (double)params->law);
    } else if (verdict == CONTROL_PARAMS_BRANCH) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "this law needs the walker's branch of gaits, which could not be computed");
    } else {
        snprintf(message, SUBJECT_MESSAGE_MAX, "controller parameters do not fit together (code %d)",
                 verdict);
    }
    return -1;
}
