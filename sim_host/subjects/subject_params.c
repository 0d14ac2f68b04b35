/* From a subject to the controller's parameters: gains and limits scaled from the
 * paper's walker, finv computed for this very walker. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_host/devices/device_text.h"
#include "sim_host/gait/late_gait.h"
#include "sim_host/gait/laws_table.h"
#include "sim_host/subjects/subject.h"

/* Paper's walker, which all gains are scaled from. */
#define PAPER_LENGTH_M 1.0
#define PAPER_GRAVITY_M_S2 9.80665
#define PAPER_KP 0.042
#define LOW_R0 0.03 /* from here on its gaits must be held by eq. (16) */
#define PAPER_SPRING_RATIO (100.0 * 1.0 / (1.0 * 9.80665)) /* k l / (M g) */

/* The push-offs 0.005 to 0.3 of the paper's walker, scaled by length_scale, must lie
 * where gaits are computed: GAIT_CURVE_FLOOR to GAIT_CURVE_CEILING leg lengths. */
static int check_spring(const struct subject *subject, double length_scale, char *message)
{
    const double l = subject->person.leg_length_m;
    const double spring_N_per_m = subject_spring_N_per_m(subject);
    if (0.005 * length_scale >= GAIT_CURVE_FLOOR * l &&
        0.3 * length_scale <= GAIT_CURVE_CEILING * l) {
        return 0;
    }
    const double paper_like = spring_N_per_m * length_scale * length_scale / (l * l);
    const double stiffest = 0.005 / GAIT_CURVE_FLOOR, softest = 0.3 / GAIT_CURVE_CEILING;
    snprintf(
        message, SUBJECT_MESSAGE_MAX,
        "the device's key \"spring_N_per_m\" (ankle spring, N/m): %g does not suit this body, allowed is "
        "%.3g to %.3g",
        spring_N_per_m, paper_like * softest * softest, paper_like * stiffest * stiffest);
    return -1;
}

/* The spring that the compass' gaits are computed with: the nearest one that suits well. A person's law
 * does not ask for them, and their spring may be any. */
static double clipped_length_scale(const struct subject *subject, double length_scale)
{
    const double least = 0.5 * subject->person.leg_length_m;
    const double most = subject->person.leg_length_m;
    return length_scale < least ? least : (length_scale > most ? most : length_scale);
}

static void set_spring(struct subject *subject, double spring_N_per_m)
{
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        device_file_set(&subject->device, (enum side)leg, DEVICE_LEG_spring_N_per_m,
                        spring_N_per_m);
    }
}

static int make_speed_table(const struct subject *subject, double length_scale, double delay_s,
                            struct speed_table *table, char *message)
{
    const struct gait_walker walker = subject_gait_walker(subject);
    const double first_m = 0.005 * length_scale;
    const double step_m = (0.3 * length_scale - first_m) / (SPEED_TABLE_MAX - 1);
    struct gait_point points[SPEED_TABLE_MAX];
    int reached = 0;
    const enum gait_curve_error error =
        late_gait_curve(&walker, delay_s, first_m, step_m, SPEED_TABLE_MAX, points, &reached);
    if (error != GAIT_CURVE_OK) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "no curve of steady gaits for this walker from r0 = %g m on: %s",
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

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* The gain of eq. (16), and the range that the walker's gaits bear. */
struct gain {
    double best, low, high;
};

/* What the laws beyond eq. (16) need, and eq. (16)'s gain for this very walker; a walker whose branch cannot be
 * followed has eq. (16) only, with the paper's gain scaled. */
static void make_branch(const struct subject *subject, double length_scale, double delay_s,
                        double scaled_kp, struct gait_branch *branch, struct gain *kp)
{
    const struct gait_walker walker = subject_gait_walker(subject);
    const struct laws_weights weights = laws_weights_default();
    struct laws_table table;
    double largest;
    *branch = (struct gait_branch){.count = 0};
    *kp = (struct gain){scaled_kp, scaled_kp, scaled_kp};
    const enum laws_table_error error =
        laws_table_make(&walker, length_scale, delay_s, &weights, &table);
    if (error == LAWS_TABLE_NO_CURVE || error == LAWS_TABLE_LOST) {
        return;
    }
    kp->best =
        laws_table_gain(&table, LOW_R0 * length_scale, scaled_kp, scaled_kp / PAPER_KP, &largest);
    laws_table_gain_range(&table, LOW_R0 * length_scale, kp->best, scaled_kp / PAPER_KP, &kp->low,
                          &kp->high);
    if (error != LAWS_TABLE_OK) {
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
    double length_scale, delay_s;
    struct gain kp;
    struct kept_branch *next;
};

static bool is_same_walker(const struct gait_walker *a, const struct gait_walker *b)
{
    return a->hip_mass_kg == b->hip_mass_kg && a->leg_mass_kg == b->leg_mass_kg &&
           a->leg_length_m == b->leg_length_m && a->ankle_stiffness_N_m == b->ankle_stiffness_N_m &&
           a->gravity_m_s2 == b->gravity_m_s2;
}

static const struct gait_branch *branch_of(const struct subject *subject, double length_scale,
                                           double delay_s, double scaled_kp, struct gain *kp)
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    static struct kept_branch *kept;
    const struct gait_walker walker = subject_gait_walker(subject);
    struct kept_branch *entry;

    pthread_mutex_lock(&lock);
    for (entry = kept; entry != NULL; entry = entry->next) {
        if (is_same_walker(&entry->walker, &walker) && entry->length_scale == length_scale &&
            entry->delay_s == delay_s) {
            break;
        }
    }
    if (entry == NULL && (entry = calloc(1, sizeof *entry)) != NULL) {
        entry->walker = walker;
        entry->length_scale = length_scale;
        entry->delay_s = delay_s;
        make_branch(subject, length_scale, delay_s, scaled_kp, &entry->branch, &entry->kp);
        entry->next = kept;
        kept = entry;
    }
    pthread_mutex_unlock(&lock);
    *kp = entry != NULL ? entry->kp : (struct gain){scaled_kp, scaled_kp, scaled_kp};
    return entry != NULL && entry->branch.count > 0 ? &entry->branch : NULL;
}

/* What a reference may ask of motors as they are built: with room for a stop, which asks for 1.6 times as
 * much, and for the way back behind a push, without load, which asks for twice as much. */
#define FREE_SHARE 0.3
#define LOADED_SHARE 0.9

static double reference_acceleration_m_s2(const struct subject *subject, double r0_m)
{
    double least = 1000.0;
    for (int leg = 0; leg < SIDE_COUNT; leg++) {
        const struct sea_config *config = &subject->actuators.config[leg];
        const double most_N = 0.75 * r0_m * sea_config_stiffness_N_per_m(config);
        least = smaller(least, FREE_SHARE * sea_config_acceleration_m_s2(config, 0.0));
        least = smaller(least, LOADED_SHARE * sea_config_acceleration_m_s2(config, most_N));
    }
    return least;
}

/* The prescribed push-off must be one that the actuator as it is built can give. */
static int check_actuators(const struct subject *subject, const struct control_params *params,
                           char *message)
{
    const struct sea_duty duty = {.precompression_m = (double)params->start_r0_m,
                                  .load_s = SUBJECT_LOAD_S};
    char why[SUBJECT_MESSAGE_MAX / 2];
    for (int leg = 0; leg < SIDE_COUNT && subject->actuators.as_built; leg++) {
        if (sea_config_can_be_built(&subject->actuators.config[leg], &duty, why, sizeof why) != 0) {
            snprintf(message, SUBJECT_MESSAGE_MAX, "%s: %s", device_leg_name(leg), why);
            return -1;
        }
    }
    return 0;
}

static int check_lever(const struct subject *subject, int leg, char *message)
{
    const double stroke_m =
        device_file_number(&subject->device, (enum side)leg, DEVICE_LEG_stroke_max_m);
    const double lever_m =
        device_file_number(&subject->device, (enum side)leg, DEVICE_LEG_ankle_lever_m);
    const struct device_leg *own = &subject->device.description.leg[leg];
    if (device_leg_is_driven(own) && own->ankle == DEVICE_ANKLE_LEVER && stroke_m > lever_m) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "%s: stroke over lever: stroke_max_m is %g m, and a lever of %g m cannot move the "
                 "spring's end so far",
                 device_leg_name(leg), stroke_m, lever_m);
        return -1;
    }
    return 0;
}

/* The device's own numbers against each other, before anything moves. The law may ask for up to
 * r0_max_m: nothing says so when the motor then stalls before it. */
static int check_device(const struct subject *subject, const struct control_params *params,
                        char *message)
{
    const double force_N = subject_force_max_N(subject);
    const double greatest_N = subject_spring_N_per_m(subject) * (double)params->r0_max_m;
    if (check_actuators(subject, params, message) != 0 ||
        check_lever(subject, SIDE_LEFT, message) != 0 ||
        check_lever(subject, SIDE_RIGHT, message) != 0) {
        return -1;
    }
    /* A trapezium of speed is 3/2 of its mean at its fastest. A person's cadence is their own. */
    const double needed_m_s = 1.5 * (double)params->start_r0_m / SUBJECT_LOAD_S;
    if (subject->is_person && needed_m_s > subject_speed_max_m_s(subject)) {
        snprintf(
            message, SUBJECT_MESSAGE_MAX,
            "speed over drive: %g m in %.3g s, at 130 steps a minute, needs %.3g m/s of spring, "
            "and speed_max_m_s is %.3g m/s",
            (double)params->start_r0_m, SUBJECT_LOAD_S, needed_m_s, subject_speed_max_m_s(subject));
        return -1;
    }
    if (greatest_N > 1.0001 * force_N) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "spring over motor: at r0_max_m, %g m, the spring pushes with %.4g N, and the "
                 "motor gives %.4g N (force_max_N)",
                 (double)params->r0_max_m, greatest_N, force_N);
        return -1;
    }
    return 0;
}

/* Puts what control_params_validate found into words. */
static void explain(const struct control_params *params, int verdict, char *message)
{
    if (verdict < CONTROL_PARAM_COUNT) {
        const struct control_param_descriptor *d = &control_param_descriptors[verdict];
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "controller parameter %s = %g %s is out of range, allowed is %g to %g", d->name,
                 (double)*(const real *)((const char *)params + d->offset), d->unit,
                 (double)d->minimum, (double)d->maximum);
    } else if (verdict == CONTROL_PARAMS_R0_ORDER) {
        snprintf(
            message, SUBJECT_MESSAGE_MAX,
            "start_r0_m %g m lies outside what this subject's walker and SEA allow, %g to %g m",
            (double)params->start_r0_m, (double)params->r0_min_m, (double)params->r0_max_m);
    } else if (verdict == CONTROL_PARAMS_OPEN_LOOP) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "open-loop r0 %g m lies outside what this subject allows, %g to %g m",
                 (double)params->open_loop_r0_m, (double)params->r0_min_m,
                 (double)params->r0_max_m);
    } else if (verdict == CONTROL_PARAMS_R0_STROKE) {
        snprintf(message, SUBJECT_MESSAGE_MAX, "r0_max_m %g m is above 0.4 leg lengths, %g m",
                 (double)params->r0_max_m, 0.4 * (double)params->leg_length_m);
    } else if (verdict == CONTROL_PARAMS_LAW) {
        snprintf(message, SUBJECT_MESSAGE_MAX, "controller parameter law = %g is no law",
                 (double)params->law);
    } else if (verdict == CONTROL_PARAMS_ENGAGE) {
        snprintf(
            message, SUBJECT_MESSAGE_MAX,
            "body is 1, a person, and engage_steps is %g: a person needs at least 1 steady step "
            "before assistance; set engage_steps = 4",
            (double)params->engage_steps);
    } else if (verdict == CONTROL_PARAMS_GAIN_RANGE) {
        snprintf(message, SUBJECT_MESSAGE_MAX, "kp_low_m_s_rad %g is above kp_high_m_s_rad %g",
                 (double)params->kp_low_m_s_rad, (double)params->kp_high_m_s_rad);
    } else if (verdict == CONTROL_PARAMS_GAIN) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "kp_m_s_rad %g lies outside what is locked for this person, kp_low_m_s_rad %g to "
                 "kp_high_m_s_rad %g",
                 (double)params->kp_m_s_rad, (double)params->kp_low_m_s_rad,
                 (double)params->kp_high_m_s_rad);
    } else if (verdict == CONTROL_PARAMS_R0_CEILING) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "r0_max_m %g m is above what is locked for this person, r0_ceiling_m %g m",
                 (double)params->r0_max_m, (double)params->r0_ceiling_m);
    } else if (verdict == CONTROL_PARAMS_R0_CHANGE_CEILING) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "r0_change_max_m %g m is above what is locked for this person, "
                 "r0_change_ceiling_m %g m",
                 (double)params->r0_change_max_m, (double)params->r0_change_ceiling_m);
    } else if (verdict == CONTROL_PARAMS_BRANCH) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "this law needs the walker's branch of gaits, which could not be computed");
    } else {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "controller parameters do not fit together (code %d)", verdict);
    }
}

static int check_person(const struct subject *subject, char *message)
{
    struct device_refusal refusal;
    if (device_check_person(&subject->device.description, &refusal) == DEVICE_OK) {
        return 0;
    }
    device_refusal_text(&refusal, message, SUBJECT_MESSAGE_MAX);
    return -1;
}

/* What may be changed over the bus. Nobody knows what gain a person's own gait bears: the eigenvalues are those of a
 * compass walker. So a person's gain may be lowered there, down to a constant push-off, and never raised above the one
 * that was prescribed. The push-off may be raised to the one prescribed. */
static void limit_changes(const struct subject *subject, struct control_params *params)
{
    const struct person *person = &subject->person;
    if (params->body == (real)BODY_PERSON) {
        params->kp_low_m_s_rad =
            person_overrides(person, offsetof(struct control_params, kp_low_m_s_rad))
                ? params->kp_low_m_s_rad
                : REAL(0.0);
        params->kp_high_m_s_rad =
            person_overrides(person, offsetof(struct control_params, kp_high_m_s_rad))
                ? params->kp_high_m_s_rad
                : params->kp_m_s_rad;
    }
    /* A bench walker's own gain beyond what its gaits bear: over the bus there is no other then. */
    if (params->body != (real)BODY_PERSON &&
        !person_overrides(person, offsetof(struct control_params, kp_low_m_s_rad)) &&
        !person_overrides(person, offsetof(struct control_params, kp_high_m_s_rad)) &&
        !(params->kp_m_s_rad >= params->kp_low_m_s_rad &&
          params->kp_m_s_rad <= params->kp_high_m_s_rad)) {
        params->kp_low_m_s_rad = params->kp_high_m_s_rad = REAL(0.0);
    }
    if (!person_overrides(person, offsetof(struct control_params, r0_ceiling_m))) {
        params->r0_ceiling_m = params->r0_max_m;
    }
    if (!person_overrides(person, offsetof(struct control_params, r0_change_ceiling_m))) {
        params->r0_change_ceiling_m = params->r0_change_max_m;
    }
}

static int derive(const struct subject *subject, struct control_params *params, char *message)
{
    const double l = subject->person.leg_length_m;
    const double g = subject->person.gravity_m_s2;
    const double spring_N_per_m = subject_spring_N_per_m(subject);
    const double weight_N = subject->person.torso_mass_kg * g;
    const double time_scale = sqrt(l / g) / sqrt(PAPER_LENGTH_M / PAPER_GRAVITY_M_S2);
    /* Same spring energy in units of M g l. */
    const double length_scale = l * sqrt(PAPER_SPRING_RATIO / (spring_N_per_m * l / weight_N));
    const double stroke = subject_stroke_m(subject);
    const double speed = subject_speed_max_m_s(subject);
    const double force = subject_force_max_N(subject);

    *params = (struct control_params){
        .torso_mass_kg = (real)subject->person.torso_mass_kg,
        .leg_mass_kg = (real)subject->person.leg_mass_kg,
        .leg_length_m = (real)l,
        .spring_stiffness_n_m = (real)spring_N_per_m,
        .gravity_m_s2 = (real)g,
        .law = (real)LAW_PROPORTIONAL,
        .kp_m_s_rad = (real)(PAPER_KP * length_scale * time_scale),
        .start_r0_m = (real)(0.05 * length_scale),
        .speed_ramp_rad_s = (real)(0.005 / time_scale),
        .r0_min_m = (real)(0.005 * length_scale),
        .r0_max_m = (real)smaller(0.3 * length_scale, smaller(stroke, force / spring_N_per_m)),
        .r0_change_max_m = (real)(0.05 * length_scale),
        .open_loop_r0_m = (real)(0.05 * length_scale),
        .open_loop_ramp_m = (real)(0.0005 * length_scale),
        .apex_window_s = (real)(0.08 * time_scale),
        .angle_hysteresis_rad = REAL(0.01),
        .sensor_latency_s = subject->device.description.leg[SIDE_LEFT].leg_latency_s,
        .sea_speed_max_m_s = (real)(0.8 * speed),
        .sea_acceleration_m_s2 = (real)(g),
        .sea_tolerance_m = (real)(0.001 * l),
        .sensor_age_max_s = REAL(0.01),
        .step_timeout_s = (real)(3.0 * time_scale),
        .fall_angle_rad = REAL(1.2),
        .unload_timeout_s = REAL(0.6),
        .engage_steps = REAL(0.0), /* the paper's walker has no push-off of its own */
        .engage_ramp_steps = REAL(10.0),
        .terrain_speed_rad_s = REAL(0.0), /* nobody gets faster than asked unless it is said so */
    };
    struct subject compass = *subject;
    const double delay_s = subject_latch_delay_s(subject);
    double compass_scale = length_scale;
    if (subject->is_person) {
        const double ratio = length_scale / clipped_length_scale(subject, length_scale);
        compass_scale = length_scale / ratio;
        set_spring(&compass, spring_N_per_m * ratio * ratio);
    }
    if (check_spring(&compass, compass_scale, message) != 0 ||
        make_speed_table(&compass, compass_scale, delay_s, &params->table, message) != 0) {
        return -1;
    }
    struct gain kp;
    params->branch = branch_of(&compass, compass_scale, delay_s, (double)params->kp_m_s_rad, &kp);
    if (subject->actuators.as_built) {
        params->sea_acceleration_m_s2 =
            (real)reference_acceleration_m_s2(subject, (double)params->start_r0_m);
    }
    params->kp_m_s_rad = (real)kp.best;
    params->kp_low_m_s_rad = (real)kp.low;
    params->kp_high_m_s_rad = (real)kp.high;
    for (int i = 0; i < CONTROL_PARAM_COUNT; i++) {
        if (subject->person.control_overridden[i]) {
            *(real *)((char *)params + control_param_descriptors[i].offset) =
                (real)subject->person.control_override[i];
        }
    }
    if (law_of(params->law) != NULL && law_of(params->law)->keeps_within_reach &&
        !person_overrides(&subject->person, offsetof(struct control_params, r0_change_max_m))) {
        params->r0_change_max_m =
            params->r0_max_m; /* what the motor can do limits it, step by step */
    }
    limit_changes(subject, params);
    /* Not with the parameters' own checks: the controller does not know the SEA. */
    if ((double)params->r0_max_m > (double)(real)stroke) {
        snprintf(message, SUBJECT_MESSAGE_MAX,
                 "r0_max_m %g m is more than the SEA's stroke_max_m, %g m",
                 (double)params->r0_max_m, stroke);
        return -1;
    }
    if (check_device(subject, params, message) != 0) {
        return -1;
    }
    const int verdict = control_params_validate(params);
    if (verdict != CONTROL_PARAMS_OK) {
        explain(params, verdict, message);
        return -1;
    }
    return params->body == (real)BODY_PERSON ? check_person(subject, message) : 0;
}

int subject_control_params(const struct subject *subject, struct control_params *params,
                           char *message)
{
    if (derive(subject, params, message) == 0) {
        return 0;
    }
    if (subject->names_no_device) {
        const size_t length = strlen(message);
        snprintf(
            message + length, SUBJECT_MESSAGE_MAX - length,
            "; no device was named, and this is the paper's: choose one that fits the person, such as "
            "--device sim_host/devices/virtual-adult.ini");
    }
    return -1;
}
