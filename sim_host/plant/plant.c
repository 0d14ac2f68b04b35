#include "sim_host/plant/plant.h"

#include "model/tick.h"

#include <stdio.h>
#include <string.h>

#include "sim_host/gait/gait_curve.h"
#include "sim_host/plant/plant_internal.h"
#include "sim_host/plant/range.h"

/* Streams of one seed. */
enum { STREAM_SENSOR = 0x5E0, STREAM_GROUND = 0x60D };

static const struct walker3_params PAPER_BODY = {
    .hip_mass_kg = 1.0, .leg_mass_kg = 0.01, .leg_length_m = 1.0, .gravity_m_s2 = 9.80665};
static const double PAPER_SPRING_N_PER_M = 100.0;
static const double START_PUSH_OFF = 0.05; /* of the leg's length */

/* Just after lift-off of the gait at START_PUSH_OFF, for this body and spring. A body
 * that has no such gait gets the paper's angles, its rates scaled by sqrt(g/l). */
static void start_pose(const struct walker3_params *body, double spring_N_per_m,
                       struct walk_pose *pose)
{
    static const double PAPER_LIFT_OFF[4] = {0.175299021, -0.354600794, -0.691599930, -0.568335556};
    const struct gait_walker subject = {body->hip_mass_kg, body->leg_mass_kg, body->leg_length_m,
                                        spring_N_per_m, body->gravity_m_s2};
    const double rate = __builtin_sqrt(body->gravity_m_s2 / body->leg_length_m / 9.80665);
    struct gait_point gait;
    *pose = (struct walk_pose){SIDE_LEFT, PAPER_LIFT_OFF[0], PAPER_LIFT_OFF[1],
                               PAPER_LIFT_OFF[2] * rate, PAPER_LIFT_OFF[3] * rate};
    if (gait_curve(&subject, START_PUSH_OFF * body->leg_length_m, 0.0, 1, &gait, NULL) ==
        GAIT_CURVE_OK) {
        *pose = (struct walk_pose){SIDE_LEFT, gait.lift_off[0], gait.lift_off[1], gait.lift_off[2],
                                   gait.lift_off[3]};
    }
}

void plant_config_for(const struct walker3_params *body, double spring_N_per_m,
                      enum sea_preset_kind sea, enum sensor_preset_kind sensors,
                      struct plant_config *config)
{
    const struct sea_subject subject = {
        .total_mass_kg = body->hip_mass_kg + 2.0 * body->leg_mass_kg,
        .leg_length_m = body->leg_length_m,
        .gravity_m_s2 = body->gravity_m_s2,
        .spring_N_per_m = spring_N_per_m,
    };
    memset(config, 0, sizeof *config);
    config->kind = PLANT_WALKER;
    config->tick_s = TICK_PERIOD_US / 1e6;
    config->seed = 1;
    walk_params_default(body, &config->walk);
    start_pose(body, spring_N_per_m, &config->start);
    start_hold_params_default(body->leg_length_m, &config->start_hold);
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_preset(sea, &subject, &config->sea[side]);
        sensor_preset(sensors, &config->sensors[side]);
    }
    recording_format_default(&config->recording_format);
    config->recording_start_tick = config->start_hold.release_tick;
}

void plant_config_default(struct plant_config *config)
{
    plant_config_for(&PAPER_BODY, PAPER_SPRING_N_PER_M, SEA_REAL, SENSORS_17BIT, config);
}

static enum plant_error complain(enum plant_error error, char *message, const char *part,
                                 const char *field)
{
    (void)snprintf(message, PLANT_ERROR_MAX, "%s: %s is out of range", part, field);
    return error;
}

static const char *check_pose(const struct walk_pose *pose)
{
    const struct range ranges[] = {
        {"theta_s_rad", pose->theta_s_rad, -1.5, 1.5},
        {"theta_n_rad", pose->theta_n_rad, -1.5, 1.5},
        {"theta_s_rate_rad_s", pose->theta_s_rate_rad_s, -100.0, 100.0},
        {"theta_n_rate_rad_s", pose->theta_n_rate_rad_s, -100.0, 100.0},
    };
    if (pose->stance != SIDE_LEFT && pose->stance != SIDE_RIGHT) {
        return "stance";
    }
    return range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
}

/* The tick and both drives' periods must fit into each other. */
static bool periods_fit(const struct plant_config *config)
{
    const double period_s = config->sea[SIDE_LEFT].drive_period_s;
    const double periods = config->tick_s / period_s;
    const double off = periods - (double)(int)(periods + 0.5);
    return config->tick_s >= 1e-4 && config->tick_s <= 1e-2 && periods >= 0.5 && off < 1e-6 &&
           off > -1e-6 && config->sea[SIDE_RIGHT].drive_period_s == period_s;
}

static enum plant_error check_config(const struct plant_config *config, char *message)
{
    static const char *const SIDES[SIDE_COUNT] = {"left", "right"};
    char part[32];
    const char *bad = walk_params_check(&config->walk);
    if (bad != NULL) {
        const bool body = walker3_params_check(&config->walk.body) != WALKER3_PARAMS_OK;
        return complain(body ? PLANT_BAD_BODY : PLANT_BAD_WALK, message, body ? "body" : "walk",
                        bad);
    }
    if ((bad = check_pose(&config->start)) != NULL) {
        return complain(PLANT_BAD_START, message, "start", bad);
    }
    if ((bad = start_hold_params_check(&config->start_hold)) != NULL) {
        return complain(PLANT_BAD_START_HOLD, message, "support", bad);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        if ((bad = sea_params_check(&config->sea[side])) != NULL) {
            (void)snprintf(part, sizeof part, "sea %s", SIDES[side]);
            return complain(PLANT_BAD_SEA, message, part, bad);
        }
        if ((bad = sensor_params_check(&config->sensors[side])) != NULL) {
            (void)snprintf(part, sizeof part, "sensor %s", SIDES[side]);
            return complain(PLANT_BAD_SENSOR, message, part, bad);
        }
    }
    if (!periods_fit(config)) {
        return complain(PLANT_BAD_TICK, message, "tick", "tick_s or drive_period_s");
    }
    if (!(config->roughness_m >= 0.0 && config->roughness_m <= 1.0) ||
        (config->heights_m == NULL && config->heights_count > 0)) {
        return complain(PLANT_BAD_GROUND, message, "ground", "roughness_m or heights_m");
    }
    return PLANT_OK;
}

/* Height of foothold n (from 1 on) above the slope line. */
static double height_of_foothold(struct plant *plant, uint64_t n)
{
    const struct plant_config *config = &plant->config;
    double height_m = 0.0;
    if (n >= 1 && n <= config->heights_count) {
        height_m = config->heights_m[n - 1];
    }
    if (config->roughness_m > 0.0) {
        height_m += config->roughness_m * rng_normal(&plant->ground_rng);
    }
    return height_m;
}

static void lay_next_foothold(struct plant *plant)
{
    const double height_m = height_of_foothold(plant, plant->footholds + 1);
    walk_set_next_height(&plant->walk, height_m - plant->foothold_height_m);
    plant->next_foothold_height_m = height_m;
}

enum plant_error plant_init(struct plant *plant, const struct plant_config *config, char *message)
{
    message[0] = '\0';
    const enum plant_error error = check_config(config, message);
    if (error != PLANT_OK) {
        return error;
    }
    memset(plant, 0, sizeof *plant);
    plant->config = *config;
    if (config->kind == PLANT_RECORDED_PERSON) {
        char why[RECORDING_ERROR_MAX];
        if (recording_load(&plant->recording, config->recording_path, &config->recording_format,
                           why) != RECORDING_OK) {
            (void)snprintf(message, PLANT_ERROR_MAX, "%s", why);
            return PLANT_BAD_RECORDING;
        }
        recorded_person_at(&plant->recording, 0.0, &plant->recording_cursor, &plant->person);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_init(&plant->sea[side], &config->sea[side], config->seed + (uint64_t)side);
        sensor_init(&plant->sensor[side], &config->sensors[side], config->seed,
                    STREAM_SENSOR + (uint64_t)side);
    }
    rng_init(&plant->ground_rng, config->seed, STREAM_GROUND);
    start_hold_init(&plant->start_hold, &config->start_hold);
    walk_init(&plant->walk, &config->walk, &config->start);
    lay_next_foothold(plant);
    return PLANT_OK;
}

void plant_free(struct plant *plant)
{
    recording_free(&plant->recording);
}

void plant_set_command(struct plant *plant, enum side side, const struct sea_command *command)
{
    sea_set_command(&plant->sea[side], command, plant_now_s(plant));
}

static bool is_person(const struct plant *plant)
{
    return plant->config.kind == PLANT_RECORDED_PERSON;
}

static double ankle_of(const struct plant *plant, enum side side)
{
    return is_person(plant) ? plant->person.ankle_m[side]
                            : walk_ankle_m(&plant->walk, plant->sea, side);
}

static double ankle_rate_of(const struct plant *plant, enum side side)
{
    return is_person(plant) ? plant->person.ankle_rate_m_s[side]
                            : walk_ankle_rate_m_s(&plant->walk, plant->sea, side);
}

void plant_sample(struct plant *plant, enum side side, struct sensor_sample *sample)
{
    const struct sensor_truth truth = {
        .leg_angle_rad = is_person(plant) ? plant->person.leg_angle_rad[side]
                                          : walk_leg_angle_rad(&plant->walk, side),
        .leg_rate_rad_s = is_person(plant) ? plant->person.leg_rate_rad_s[side]
                                           : walk_leg_rate_rad_s(&plant->walk, side),
        .ankle_extension_m = ankle_of(plant, side),
        .ankle_rate_m_s = ankle_rate_of(plant, side),
    };
    sensor_sample(&plant->sensor[side], &truth, plant->config.tick_s, sample);
}

void plant_sea_output(const struct plant *plant, enum side side, struct sea_output *output)
{
    sea_read(&plant->sea[side], ankle_of(plant, side), output);
}

/* The hand looks at the drives as they are at this SYNC. */
static void tend(struct plant *plant)
{
    const enum side stance = plant->walk.stance;
    struct sea_output loaded;
    plant_sea_output(plant, stance, &loaded);
    const struct start_hold_view view = {
        .drives_enabled = plant->sea[SIDE_LEFT].command.mode == SEA_POSITION &&
                          plant->sea[SIDE_RIGHT].command.mode == SEA_POSITION,
        .stance_position_m = loaded.reported_position_m,
        .stance_target_m = plant->sea[stance].command.target_position_m,
        .stance_speed_m_s = loaded.speed_m_s,
        .fault = plant->walk.fault != WALK_FAULT_NONE,
    };
    switch (start_hold_tick(&plant->start_hold, plant->tick, &view)) {
    case START_HOLD_NONE:
        break;
    case START_HOLD_LET_GO:
        walk_let_go(&plant->walk);
        break;
    case START_HOLD_TAKE_HOLD:
        walk_hold(&plant->walk, &plant->config.start);
        lay_next_foothold(plant);
        break;
    }
}

static void advance_walker(struct plant *plant)
{
    const uint64_t steps = plant->walk.current.index;
    tend(plant);
    walk_advance(&plant->walk, plant->sea, plant->config.tick_s);
    if (plant->walk.current.index != steps) {
        plant->footholds++;
        plant->foothold_height_m = plant->next_foothold_height_m;
        lay_next_foothold(plant);
    }
}

void plant_advance(struct plant *plant)
{
    plant->walk.time_s = plant_now_s(plant);
    if (is_person(plant)) {
        plant_advance_recorded_person(plant);
    } else {
        advance_walker(plant);
    }
    plant->tick++;
    plant->walk.time_s = plant_now_s(plant);
}

static void walker_truth(const struct plant *plant, struct plant_truth *truth)
{
    const struct walk *walk = &plant->walk;
    const enum side swing = side_other(walk->stance);
    double lock_N, toe_m[2];
    walk_forces(walk, plant->sea, truth->ground_force_N, &lock_N);
    walker3_hip(&walk->params.body, &walk->state, truth->hip_m);
    walker3_toe(&walk->params.body, &walk->state, walk_ankle_m(walk, plant->sea, swing), toe_m);
    for (int i = 0; i < 2; i++) {
        truth->hip_m[i] += walk->foot_m[i];
        truth->toe_m[walk->stance][i] = walk->foot_m[i];
        truth->toe_m[swing][i] = walk->foot_m[i] + toe_m[i];
    }
}

void plant_truth(const struct plant *plant, struct plant_truth *truth)
{
    const struct walk *walk = &plant->walk;
    const struct recorded_person_state *person = &plant->person;
    memset(truth, 0, sizeof *truth);
    truth->tick = plant->tick;
    truth->time_s = plant_now_s(plant);
    for (int i = 0; i < SIDE_COUNT; i++) {
        const enum side side = (enum side)i;
        truth->leg_angle_rad[side] =
            is_person(plant) ? person->leg_angle_rad[side] : walk_leg_angle_rad(walk, side);
        truth->leg_rate_rad_s[side] =
            is_person(plant) ? person->leg_rate_rad_s[side] : walk_leg_rate_rad_s(walk, side);
        truth->ankle_m[side] = ankle_of(plant, side);
        truth->ankle_rate_m_s[side] = ankle_rate_of(plant, side);
        truth->contact[side] =
            is_person(plant) ? person->contact[side] : walk_on_ground(walk, side);
    }
    truth->stance = walk->stance;
    truth->phase = walk->phase;
    truth->fault = walk->fault;
    truth->finished = person->finished;
    if (!is_person(plant)) {
        walker_truth(plant, truth);
    }
}

void plant_energy(const struct plant *plant, struct plant_energy *energy)
{
    const struct walk *walk = &plant->walk;
    memset(energy, 0, sizeof *energy);
    if (!is_person(plant)) {
        energy->walker_J = walk_energy_J(walk);
        energy->collision_loss_J = walk->collision_loss_J;
        energy->own_work_J = walk->own_work_J;
    }
    for (int i = 0; i < SIDE_COUNT; i++) {
        struct sea_output output;
        plant_sea_output(plant, (enum side)i, &output);
        const double stiffness = plant->sea[i].params.spring_N_per_m;
        if (stiffness > 0.0) {
            energy->springs_J += 0.5 * output.spring_force_N * output.spring_force_N / stiffness;
        }
        energy->device_work_J[i] =
            is_person(plant) ? plant->person_work_J[i] : walk->device_work_J[i];
        energy->motor_work_J[i] = plant->sea[i].motor_work_J;
        energy->motor_positive_work_J[i] = plant->sea[i].motor_positive_work_J;
    }
}

bool plant_next_event(struct plant *plant, struct walk_event *event)
{
    return walk_next_event(&plant->walk, event);
}

bool plant_next_step(struct plant *plant, struct walk_step *step)
{
    return walk_next_step(&plant->walk, step);
}

enum walk_fault plant_fault(const struct plant *plant)
{
    return plant->walk.fault;
}

void plant_push(struct plant *plant, double impulse_x_Ns, double impulse_y_Ns)
{
    const double impulse_Ns[2] = {impulse_x_Ns, impulse_y_Ns};
    walk_push(&plant->walk, impulse_Ns);
}

void plant_set_spring_scale(struct plant *plant, enum side side, double scale)
{
    const double limited = scale > 0.0 ? (scale < 100.0 ? scale : 100.0) : 0.0;
    plant->sea[side].params.spring_N_per_m = limited * plant->config.sea[side].spring_N_per_m;
}

void plant_set_own_push(struct plant *plant, double stiffness_N_per_m, double rest_m)
{
    plant->walk.params.own_push_N_per_m = stiffness_N_per_m > 0.0 ? stiffness_N_per_m : 0.0;
    plant->walk.params.own_push_rest_m = rest_m;
    if (!(stiffness_N_per_m > 0.0)) {
        plant->walk.own_push_active = false;
    }
}

void plant_set_next_height(struct plant *plant, double height_m)
{
    walk_set_next_height(&plant->walk, height_m);
    plant->next_foothold_height_m = plant->foothold_height_m + height_m;
}
