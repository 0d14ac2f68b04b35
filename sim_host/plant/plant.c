#include "sim_host/plant/plant.h"

#include <stdio.h>
#include <string.h>

#include "sim_host/plant/plant_internal.h"

/* Streams of one seed. */
enum { STREAM_SENSOR = 0x5E0, STREAM_GROUND = 0x60D, STREAM_FOOT = 0xF00 };

enum plant_error plant_init(struct plant *plant, const struct plant_config *config, char *message)
{
    message[0] = '\0';
    const enum plant_error error = plant_config_check(config, message);
    if (error != PLANT_OK) {
        return error;
    }
    memset(plant, 0, sizeof *plant);
    plant->config = *config;
    person_motion_init(&plant->motion);
    if (config->kind == PLANT_RECORDED_PERSON) {
        char why[RECORDING_ERROR_MAX];
        if (config->recording != NULL) {
            plant->recording = *config->recording;
        } else if (recording_load(&plant->recording, config->recording_path,
                                  &config->recording_format, why) != RECORDING_OK) {
            (void)snprintf(message, PLANT_ERROR_MAX, "%s", why);
            return PLANT_BAD_RECORDING;
        }
        recorded_person_at(&plant->recording, 0.0, &plant->recording_cursor, &plant->person);
    }
    if (config->kind == PLANT_REFLEX_PERSON) {
        plant_init_reflex_person(plant);
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_init(&plant->sea[side], &config->sea[side], config->seed + (uint64_t)side);
        sensor_init(&plant->sensor[side], &config->sensors[side], config->seed,
                    STREAM_SENSOR + (uint64_t)side);
        foot_switch_init(&plant->foot_switch[side], &config->foot_switch[side],
                         plant->person.contact[side], config->seed, STREAM_FOOT + (uint64_t)side);
        contact_wire_init(&plant->other_foot[side]);
    }
    rng_init(&plant->ground_rng, config->seed, STREAM_GROUND);
    start_hold_init(&plant->start_hold, &config->start_hold);
    walk_init(&plant->walk, &config->walk, &config->start);
    plant_lay_foothold(plant);
    return PLANT_OK;
}

void plant_free(struct plant *plant)
{
    if (plant->config.recording == NULL) {
        recording_free(&plant->recording);
    }
}

void plant_set_command(struct plant *plant, enum side side, const struct sea_command *command)
{
    sea_set_command(&plant->sea[side], command, plant_now_s(plant));
}

static bool is_person(const struct plant *plant)
{
    return plant->config.kind != PLANT_WALKER;
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

double plant_spring_end_m(const struct plant *plant, enum side side)
{
    return plant->config.kind == PLANT_REFLEX_PERSON ? plant_reflex_spring_end_m(plant, side)
                                                     : ankle_of(plant, side);
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
    sea_read(&plant->sea[side], plant_spring_end_m(plant, side), output);
}

/* The start hold sees the drives as they are at this SYNC. */
static void run_start_hold(struct plant *plant)
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
        plant_lay_foothold(plant);
        break;
    }
}

static void advance_walker(struct plant *plant)
{
    const uint64_t steps = plant->walk.current.index;
    run_start_hold(plant);
    walk_advance(&plant->walk, plant->sea, plant->config.tick_s);
    if (plant->walk.current.index != steps) {
        plant_pass_foothold(plant);
    }
}

void plant_advance(struct plant *plant)
{
    plant->walk.time_s = plant_now_s(plant);
    if (plant->sea[SIDE_LEFT].params.as_built && plant->sea[SIDE_RIGHT].params.as_built) {
        sea_built_share(&plant->sea[SIDE_LEFT].built, &plant->sea[SIDE_RIGHT].built,
                        plant->config.tick_s);
    }
    switch (plant->config.kind) {
    case PLANT_WALKER:
        advance_walker(plant);
        break;
    case PLANT_RECORDED_PERSON:
        plant_advance_recorded_person(plant);
        break;
    case PLANT_REFLEX_PERSON:
        plant_advance_reflex_person(plant);
        break;
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

/* A person stands on the leg that is on the ground, in double support on the one behind. */
static void person_truth(struct plant_truth *truth)
{
    const bool left = truth->contact[SIDE_LEFT], right = truth->contact[SIDE_RIGHT];
    const bool is_left_behind = truth->leg_angle_rad[SIDE_LEFT] < truth->leg_angle_rad[SIDE_RIGHT];
    truth->phase = left && right ? WALK_DOUBLE : left || right ? WALK_SINGLE : WALK_HELD;
    truth->stance = (left && right ? is_left_behind : left) ? SIDE_LEFT : SIDE_RIGHT;
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
        truth->way_m[side] = truth->ankle_m[side];
        truth->way_rate_m_s[side] = truth->ankle_rate_m_s[side];
        truth->contact[side] =
            is_person(plant) ? person->contact[side] : walk_on_ground(walk, side);
    }
    truth->stance = walk->stance;
    truth->phase = walk->phase;
    truth->fault = walk->fault;
    truth->finished = person->finished;
    truth->is_person = is_person(plant);
    truth->has_place = plant->config.kind != PLANT_RECORDED_PERSON;
    if (!is_person(plant)) {
        walker_truth(plant, truth);
    } else {
        person_truth(truth);
    }
    if (plant->config.kind == PLANT_REFLEX_PERSON) {
        plant_reflex_truth(plant, truth);
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
        const enum side side = (enum side)i;
        energy->springs_J +=
            sea_spring_energy_now_J(&plant->sea[i], plant_spring_end_m(plant, side));
        energy->device_work_J[i] =
            is_person(plant) ? plant->person_work_J[i] : walk->device_work_J[i];
        energy->motor_work_J[i] = plant->sea[i].motor_work_J;
        energy->motor_positive_work_J[i] = plant->sea[i].motor_positive_work_J;
    }
}

uint64_t plant_steps(const struct plant *plant)
{
    return plant->config.kind == PLANT_REFLEX_PERSON ? plant->footholds : plant->walk.steps_written;
}

double plant_walked_s(const struct plant *plant)
{
    const uint64_t start = is_person(plant) ? plant->config.recording_start_tick : 0;
    return ((double)plant->tick - (double)start) * plant->config.tick_s;
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
    if (plant->config.kind == PLANT_REFLEX_PERSON) {
        reflex_person_push(&plant->reflex, (struct vector2){-impulse_x_Ns, impulse_y_Ns});
        return;
    }
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

void plant_lay_stair(struct plant *plant, double rise_m)
{
    if (plant->config.kind == PLANT_REFLEX_PERSON) {
        plant_lay_reflex_stair(plant, rise_m);
        return;
    }
    plant->foothold_height_m -= rise_m; /* the line rises, and what is stood on lies below it */
    walk_set_next_height(&plant->walk, plant->next_foothold_height_m - plant->foothold_height_m);
}
