#include "sim_host/plant/walk.h"

#include <stddef.h>
#include <string.h>

#include "model/trig.h"
#include "sim_host/plant/range.h"
#include "sim_host/plant/walk_internal.h"

static const double HALF_PI = 1.57079632679489661923;

const char *walk_fault_name(enum walk_fault fault)
{
    switch (fault) {
    case WALK_FAULT_NONE:
        return "none";
    case WALK_FAULT_FALLEN_FORWARD:
        return "fallen_forward";
    case WALK_FAULT_FALLEN_BACKWARD:
        return "fallen_backward";
    case WALK_FAULT_BACKWARDS:
        return "backwards";
    case WALK_FAULT_TRIPPED:
        return "tripped";
    case WALK_FAULT_FLIGHT:
        return "flight";
    case WALK_FAULT_STUCK:
        return "stuck";
    case WALK_FAULT_SLIPPED:
        return "slipped";
    case WALK_FAULT_LEGS_CROSSED:
        return "legs_crossed";
    case WALK_FAULT_NOT_FINITE:
        return "not_finite";
    }
    return "unknown";
}

void walk_params_default(const struct walker3_params *body, struct walk_params *params)
{
    memset(params, 0, sizeof *params);
    params->body = *body;
    params->trip_extension_m = 0.03 * body->leg_length_m;
    params->fall_angle_rad = HALF_PI;
    params->stuck_s = 5.0;
    params->single_step_s = 1e-3;
    params->double_step_s = 2.5e-4;
}

const char *walk_params_check(const struct walk_params *params)
{
    const struct range ranges[] = {
        {"slope_rad", params->slope_rad, -0.5, 0.5},
        {"friction", params->friction, 0.0, 100.0},
        {"trip_extension_m", params->trip_extension_m, 0.0, 10.0},
        {"fall_angle_rad", params->fall_angle_rad, 0.1, HALF_PI},
        {"stuck_s", params->stuck_s, 1e-3, 1e6},
        {"unarmed_hold_s", params->unarmed_hold_s, 0.0, 1e6},
        {"single_step_s", params->single_step_s, 1e-5, 1e-2},
        {"double_step_s", params->double_step_s, 1e-5, 1e-2},
        {"own_push_N_per_m", params->own_push_N_per_m, 0.0, 1e7},
        {"own_push_rest_m", params->own_push_rest_m, 0.0, 10.0},
    };
    switch (walker3_params_check(&params->body)) {
    case WALKER3_PARAMS_OK:
        return range_first_bad(ranges, sizeof ranges / sizeof ranges[0]);
    case WALKER3_BAD_HIP_MASS:
        return "hip_mass_kg";
    case WALKER3_BAD_LEG_MASS:
        return "leg_mass_kg";
    case WALKER3_BAD_LEG_LENGTH:
        return "leg_length_m";
    case WALKER3_BAD_GRAVITY:
        return "gravity_m_s2";
    }
    return "body";
}

static void set_pose(struct walk *walk, const struct walk_pose *pose)
{
    walk->phase = WALK_HELD;
    walk->fault = WALK_FAULT_NONE;
    walk->stance = pose->stance;
    walk->state = (struct walker3_state){
        .q = {pose->theta_s_rad, pose->theta_n_rad, 0.0},
        .dq = {pose->theta_s_rate_rad_s, pose->theta_n_rate_rad_s, 0.0},
    };
    walk->contact = (struct walker3_contact){.ankle_locked = true};
    walk->own_push_active = false;
    walk->foot_was_above = false;
    walk->phase_since_s = walk->time_s;
    const uint64_t index = walk->current.index;
    walk->current = (struct walk_step){.index = index, .stance = pose->stance};
}

void walk_init(struct walk *walk, const struct walk_params *params, const struct walk_pose *pose)
{
    memset(walk, 0, sizeof *walk);
    walk->params = *params;
    walk->current.index = 1;
    set_pose(walk, pose);
}

void walk_hold(struct walk *walk, const struct walk_pose *pose)
{
    set_pose(walk, pose);
    walk_post(walk, WALK_EVENT_TAKE_HOLD, walk->stance, walk->time_s, 0.0);
}

void walk_let_go(struct walk *walk)
{
    if (walk->phase != WALK_HELD) {
        return;
    }
    walk->phase = WALK_SINGLE;
    walk->phase_since_s = walk->time_s;
    walk_post(walk, WALK_EVENT_LET_GO, walk->stance, walk->time_s, 0.0);
}

void walk_push(struct walk *walk, const double impulse_Ns[2])
{
    if (walk->phase == WALK_SINGLE || walk->phase == WALK_DOUBLE) {
        walker3_push(&walk->params.body, &walk->state, &walk->contact, impulse_Ns);
    }
}

void walk_set_next_height(struct walk *walk, double height_m)
{
    walk->next_height_m = height_m;
}

double walk_leg_angle_rad(const struct walk *walk, enum side side)
{
    return walk->state.q[side == walk->stance ? WALKER3_STANCE : WALKER3_SWING];
}

double walk_leg_rate_rad_s(const struct walk *walk, enum side side)
{
    if (walk->phase == WALK_HELD || walk->phase == WALK_DOWN) {
        return 0.0;
    }
    return walk->state.dq[side == walk->stance ? WALKER3_STANCE : WALKER3_SWING];
}

double walk_foot_extension_m(const struct sea *sea, double motor_m)
{
    /* A foot without weight on it stands where the slack spring's motor is. */
    return sea->latch == SEA_LATCH_CLOSED || motor_m < 0.0 ? 0.0 : motor_m;
}

static bool is_loose(const struct walk *walk, enum side side)
{
    return walk->phase == WALK_HELD || walk->phase == WALK_DOWN ||
           (side != walk->stance && walk->phase == WALK_SINGLE);
}

double walk_ankle_m(const struct walk *walk, const struct sea sea[SIDE_COUNT], enum side side)
{
    if (is_loose(walk, side)) {
        return walk_foot_extension_m(&sea[side], sea[side].position_m);
    }
    return side == walk->stance ? walk->state.q[WALKER3_ANKLE] : walk->contact.swing_extension_m;
}

double walk_ankle_rate_m_s(const struct walk *walk, const struct sea sea[SIDE_COUNT],
                           enum side side)
{
    if (is_loose(walk, side)) {
        const bool follows = sea[side].latch != SEA_LATCH_CLOSED && sea[side].position_m > 0.0;
        return follows ? sea[side].speed_m_s : 0.0;
    }
    return side == walk->stance ? walk->state.dq[WALKER3_ANKLE] : 0.0;
}

bool walk_on_ground(const struct walk *walk, enum side side)
{
    switch (walk->phase) {
    case WALK_SINGLE:
    case WALK_HELD:
        return side == walk->stance;
    case WALK_DOUBLE:
        return true;
    case WALK_DOWN:
        break;
    }
    return false;
}

void walk_ankle_spring(const struct walk *walk, const struct sea *sea, struct walker3_ankle *ankle)
{
    const bool free_spring = sea->latch != SEA_LATCH_CLOSED;
    double stiffness_N_per_m, play_m;
    sea_spring_at(sea, walk->state.q[WALKER3_ANKLE], &stiffness_N_per_m, &play_m);
    *ankle = (struct walker3_ankle){
        .device_smooth = walk->phase == WALK_DOUBLE && !walk->own_push_active,
        .device_N_per_m = free_spring ? stiffness_N_per_m : 0.0,
        .position_m = sea->position_m - play_m,
        .speed_m_s = sea->speed_m_s,
        .acceleration_m_s2 = sea->acceleration_m_s2,
        .own_N_per_m = walk->own_push_active ? walk->params.own_push_N_per_m : 0.0,
        .own_rest_m = walk->params.own_push_rest_m,
    };
}

void walk_forces(const struct walk *walk, const struct sea sea[SIDE_COUNT],
                 double ground_N[SIDE_COUNT][2], double *ankle_lock_N)
{
    struct walker3_forces forces;
    struct walker3_ankle ankle;
    double ddq[WALKER3_DOF];
    memset(ground_N, 0, sizeof(double[SIDE_COUNT][2]));
    *ankle_lock_N = 0.0;
    if (walk->phase == WALK_HELD || walk->phase == WALK_DOWN) {
        return;
    }
    walk_ankle_spring(walk, &sea[walk->stance], &ankle);
    const double push_N = walk->contact.ankle_locked
                              ? 0.0
                              : walker3_ankle_force_N(&ankle, 0.0, walk->state.q[WALKER3_ANKLE]);
    walker3_accelerate(&walk->params.body, &walk->state, &walk->contact, push_N, ddq, &forces);
    const enum side swing = walk_swing_side(walk);
    ground_N[walk->stance][0] = forces.stance_toe_N[0];
    ground_N[walk->stance][1] = forces.stance_toe_N[1];
    ground_N[swing][0] = forces.swing_toe_N[0];
    ground_N[swing][1] = forces.swing_toe_N[1];
    *ankle_lock_N = forces.ankle_lock_N;
}

double walk_energy_J(const struct walk *walk)
{
    const struct walker3_params *body = &walk->params.body;
    const double mass_kg = body->hip_mass_kg + 2.0 * body->leg_mass_kg;
    return walker3_kinetic_J(body, &walk->state) + walker3_potential_J(body, &walk->state) +
           mass_kg * body->gravity_m_s2 * walk->foot_m[1];
}

void walk_toe_gap(const struct walk *walk, const struct walker3_state *state,
                  double swing_extension_m, double *gap_m, double *ahead_m)
{
    double toe_m[2];
    double ground_m = walk->next_height_m;
    walker3_toe(&walk->params.body, state, swing_extension_m, toe_m);
    *ahead_m = -toe_m[0];
    if (walk->params.slope_rad != 0.0) {
        ground_m +=
            *ahead_m * trig_sin_f64(walk->params.slope_rad) / trig_cos_f64(walk->params.slope_rad);
    }
    *gap_m = toe_m[1] - ground_m;
}

void walk_post(struct walk *walk, enum walk_event_kind kind, enum side side, double time_s,
               double value)
{
    if (walk->events_written - walk->events_read == WALK_EVENT_RING) {
        walk->events_read++;
        walk->events_lost++;
    }
    walk->events[walk->events_written % WALK_EVENT_RING] =
        (struct walk_event){.kind = kind, .side = side, .time_s = time_s, .value = value};
    walk->events_written++;
}

bool walk_next_event(struct walk *walk, struct walk_event *event)
{
    if (walk->events_read == walk->events_written) {
        return false;
    }
    *event = walk->events[walk->events_read % WALK_EVENT_RING];
    walk->events_read++;
    return true;
}

void walk_finish_step(struct walk *walk)
{
    if (walk->steps_written - walk->steps_read == WALK_STEP_RING) {
        walk->steps_read++;
        walk->steps_lost++;
    }
    walk->steps[walk->steps_written % WALK_STEP_RING] = walk->current;
    walk->steps_written++;
    walk->current = (struct walk_step){.index = walk->current.index + 1, .stance = walk->stance};
}

bool walk_next_step(struct walk *walk, struct walk_step *step)
{
    if (walk->steps_read == walk->steps_written) {
        return false;
    }
    *step = walk->steps[walk->steps_read % WALK_STEP_RING];
    walk->steps_read++;
    return true;
}

void walk_record_apex(struct walk *walk, double time_s, const struct walker3_state *state)
{
    struct walk_step *step = &walk->current;
    step->apex_time_s = time_s;
    step->apex_speed_rad_s = -state->dq[WALKER3_STANCE];
    step->apex_theta_n_rad = state->q[WALKER3_SWING];
    step->apex_theta_n_rate_rad_s = state->dq[WALKER3_SWING];
    step->energy_J = walker3_kinetic_J(&walk->params.body, state) +
                     walker3_potential_J(&walk->params.body, state);
    walk_post(walk, WALK_EVENT_APEX, walk->stance, time_s, step->apex_speed_rad_s);
}

void walk_fail(struct walk *walk, enum walk_fault fault)
{
    walk->phase = WALK_DOWN;
    walk->fault = fault;
    walk_post(walk, WALK_EVENT_FAULT, walk->stance, walk->time_s, (double)fault);
}
