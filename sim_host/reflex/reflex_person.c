#include "sim_host/reflex/reflex_person.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Table of segments of Geyer & Herr (2010) for 80 kg and legs of 1 m: mass by 80 kg, lengths by 1 m; a centre of mass
 * there is measured from the lower end. */
#define THIGH_KG (8.5 / 80.0)
#define SHANK_KG (3.5 / 80.0)
#define FOOT_KG (1.25 / 80.0)
#define TRUNK_KG (53.5 / 80.0)
#define THIGH_KGM2 (0.15 / 80.0)
#define SHANK_KGM2 (0.05 / 80.0)
#define FOOT_KGM2 (0.005 / 80.0)
#define TRUNK_KGM2 (3.0 / 80.0)
#define PART_M 0.5
#define CENTRE_M 0.2        /* of thigh and shank, below their upper joint */
#define TRUNK_CENTRE_M 0.35 /* above the hip */
#define FOOT_CENTRE_M 0.02  /* ahead of the ankle */
#define HEEL_M 0.04
#define BALL_M 0.16
#define FELL_SHARE 0.6
#define SENSE_PERIOD_S 0.001

void reflex_person_default(double mass_kg, double leg_m, struct reflex_person_params *params)
{
    const double inertia = mass_kg * leg_m * leg_m;
    *params = (struct reflex_person_params){
        .mass_kg = mass_kg,
        .leg_m = leg_m,
        .gravity_m_s2 = 9.80665,
        .noise_share = REFLEX_NOISE_NONE,
        .start_speed_m_s = 1.144,
        .start_lean_rad = 0.0755,
        .step_s = 0.00025,
    };
    struct segments *segments = &params->segments;
    const struct segment limb = {0.0, PART_M * leg_m, {0.0, -CENTRE_M * leg_m}, 0.0};
    segments->gravity_m_s2 = params->gravity_m_s2;
    segments->trunk = (struct segment){
        TRUNK_KG * mass_kg, 0.0, {0.0, TRUNK_CENTRE_M * leg_m}, TRUNK_KGM2 * inertia};
    segments->part[PART_THIGH] = segments->part[PART_SHANK] = limb;
    segments->part[PART_THIGH].mass_kg = THIGH_KG * mass_kg;
    segments->part[PART_THIGH].inertia_kgm2 = THIGH_KGM2 * inertia;
    segments->part[PART_SHANK].mass_kg = SHANK_KG * mass_kg;
    segments->part[PART_SHANK].inertia_kgm2 = SHANK_KGM2 * inertia;
    segments->part[PART_FOOT] =
        (struct segment){FOOT_KG * mass_kg, 0.0, {FOOT_CENTRE_M * leg_m, 0.0}, FOOT_KGM2 * inertia};
    segments->heel_m = (struct vector2){-HEEL_M * leg_m, 0.0};
    segments->ball_m = (struct vector2){BALL_M * leg_m, 0.0};
    contact_default(mass_kg, &params->contact);
    for (int side = 0; side < SIDE_COUNT; side++) {
        muscles_default(mass_kg, leg_m, params->muscle[side]);
    }
    reflex_gains_healthy(&params->gains);
}

static bool is_within(double value, double low, double high)
{
    return value >= low && value <= high; /* false for a NaN */
}

const char *reflex_person_check(const struct reflex_person_params *params)
{
    const double a_sense = SENSE_PERIOD_S / params->step_s;
    if (!is_within(params->mass_kg, 10.0, 200.0)) {
        return "mass_kg: allowed is 10 to 200";
    }
    if (!is_within(params->leg_m, 0.4, 1.5)) {
        return "leg_m: allowed is 0.4 to 1.5";
    }
    if (!is_within(params->gravity_m_s2, 0.1, 100.0)) {
        return "gravity_m_s2: allowed is 0.1 to 100";
    }
    if (!is_within(params->start_speed_m_s, 0.0, 3.0)) {
        return "start_speed_m_s: allowed is 0 to 3";
    }
    if (!is_within(params->start_lean_rad, -0.5, 0.5)) {
        return "start_lean_rad: allowed is -0.5 to 0.5";
    }
    if (!is_within(params->noise_share, REFLEX_NOISE_NONE, REFLEX_NOISE_MOST)) {
        return "noise_share: allowed is 0 to 0.2";
    }
    if (!is_within(a_sense, 1.0, 100.0) || fabs(a_sense - floor(a_sense + 0.5)) > 1e-9) {
        return "step_s: a millisecond is a whole number of steps, 100 at most";
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            const struct muscle *muscle = &params->muscle[side][i];
            if (!is_within(muscle->force_max_N, 1.0, 20000.0) ||
                !is_within(muscle->optimal_m, 0.005, 0.5) ||
                !is_within(muscle->slack_m, 0.01, 1.0) ||
                !is_within(muscle->speed_max_per_s, 1.0, 30.0)) {
                return "a muscle's force, speed or lengths are out of range";
            }
        }
    }
#define GAIN_IS_FINITE(name, published, unit, meaning) \
    &&is_within(params->gains.name, -REFLEX_GAIN_MOST, REFLEX_GAIN_MOST)
    return true REFLEX_GAINS(GAIN_IS_FINITE) ? NULL : "a reflex's gain is out of range";
#undef GAIN_IS_FINITE
}

static struct vector2 point_of(const struct segments *segments, enum foot_point point)
{
    return point == FOOT_HEEL ? segments->heel_m : segments->ball_m;
}

/* ---- sensing -------------------------------------------------------------------------------------------------- */

static void sense(const struct reflex_person *person, struct reflex_moment *moment)
{
    const struct reflex_person_params *params = &person->params;
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct reflex_sense *leg = &moment->leg[side];
        struct joint_angles joints;
        muscles_joint_angles(&person->body, (enum side)side, &joints);
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            leg->force[i] = person->muscle[side][i].force_N / params->muscle[side][i].force_max_N;
            leg->length[i] = person->muscle[side][i].length_m / params->muscle[side][i].optimal_m;
        }
        leg->knee_rad = joints.angle_rad[JOINT_KNEE];
        leg->knee_rate_rad_s = joints.rate_rad_s[JOINT_KNEE];
        leg->load = person->ground_N[side].y / (params->mass_kg * params->gravity_m_s2);
    }
    moment->lean_rad = -person->body.q[MULTIBODY_TRUNK];
    moment->lean_rate_rad_s = -person->body.dq[MULTIBODY_TRUNK];
}

struct vector2 reflex_person_place(const struct reflex_person *person, enum side side,
                                   enum foot_point point)
{
    const struct segments *segments = &person->params.segments;
    struct multibody_pose pose;
    struct vector2 position_m, velocity_m_s;
    multibody_pose(&person->params.segments, &person->body, &pose);
    multibody_foot_point(&person->body, &pose, side, point_of(segments, point), &position_m,
                         &velocity_m_s);
    return position_m;
}

struct vector2 reflex_person_ball(const struct reflex_person *person, enum side side)
{
    return reflex_person_place(person, side, FOOT_BALL);
}

static bool may_lie_below(const struct reflex_person *person, enum side side, enum foot_point point,
                          const struct ground_line *ground)
{
    const struct vector2 at_m = reflex_person_place(person, side, point);
    return !person->contact[side][point].touches && at_m.y > ground_height_m(ground, at_m.x);
}

bool reflex_person_lay_ground(struct reflex_person *person, enum side side, enum foot_point point,
                              const struct ground_line *ground)
{
    const bool may = may_lie_below(person, side, point, ground);
    if (may) {
        person->ground[side][point] = *ground;
    }
    return may;
}

bool reflex_person_lay_foothold(struct reflex_person *person, enum side side,
                                const struct ground_line ground[FOOT_POINTS])
{
    for (int point = 0; point < FOOT_POINTS; point++) {
        if (!may_lie_below(person, side, (enum foot_point)point, &ground[point])) {
            return false;
        }
    }
    memcpy(person->ground[side], ground, sizeof person->ground[side]);
    return true;
}

/* ---- the start ------------------------------------------------------------------------------------------------ */

/* Late single support: the right foot flat on the ground behind the hip, the left leg ahead, bent. */
static void start_pose(struct reflex_person *person)
{
    static const double thigh[SIDE_COUNT] = {[SIDE_LEFT] = 0.35, [SIDE_RIGHT] = -0.20};
    static const double shank[SIDE_COUNT] = {[SIDE_LEFT] = 0.15, [SIDE_RIGHT] = -0.30};
    static const double foot[SIDE_COUNT] = {[SIDE_LEFT] = 0.20, [SIDE_RIGHT] = 0.0};
    const struct reflex_person_params *params = &person->params;
    struct multibody_state *body = &person->body;
    body->q[MULTIBODY_TRUNK] = -params->start_lean_rad;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const int first = multibody_leg((enum side)side);
        body->q[first + PART_THIGH] = thigh[side];
        body->q[first + PART_SHANK] = shank[side];
        body->q[first + PART_FOOT] = foot[side];
    }
    const double sink_m =
        0.5 * params->mass_kg * params->gravity_m_s2 / params->contact.stiffness_N_m;
    body->q[MULTIBODY_Y] = -reflex_person_ball(person, SIDE_RIGHT).y - sink_m;
    body->dq[MULTIBODY_X] = params->start_speed_m_s;
    /* The stance leg turns about its ankle, the other one goes ahead. */
    const double turn_rad_s = params->start_speed_m_s / params->leg_m;
    body->dq[MULTIBODY_RIGHT + PART_THIGH] = body->dq[MULTIBODY_RIGHT + PART_SHANK] = -turn_rad_s;
    body->dq[MULTIBODY_LEFT + PART_SHANK] = turn_rad_s;
    body->dq[MULTIBODY_LEFT + PART_THIGH] = 0.0;
}

void reflex_person_init(struct reflex_person *person, const struct reflex_person_params *params)
{
    memset(person, 0, sizeof *person);
    person->params = *params;
    start_pose(person);
    for (int side = 0; side < SIDE_COUNT; side++) {
        struct joint_angles joints;
        struct muscle_passes passes;
        muscles_joint_angles(&person->body, (enum side)side, &joints);
        muscles_pass(&joints, &passes);
        for (int i = 0; i < MUSCLE_COUNT; i++) {
            const double total_m =
                muscles_total_m(params->muscle[side], (enum muscle_id)i, params->leg_m, &passes);
            muscle_settle(&params->muscle[side][i], total_m, 0.01, &person->muscle[side][i]);
        }
    }
    person->ground_N[SIDE_RIGHT].y = params->mass_kg * params->gravity_m_s2;
    for (int side = 0; side < SIDE_COUNT; side++) {
        person->pressure_m[side] = reflex_person_ball(person, (enum side)side);
    }
    struct reflex_moment moment;
    sense(person, &moment);
    reflexes_init(&person->reflexes, &moment);
    reflex_noise_init(&person->noise, params->noise_seed);
}

/* ---- a step --------------------------------------------------------------------------------------------------- */

/* What does not change within a step. */
struct held {
    double torque_Nm[SIDE_COUNT][JOINT_COUNT]; /* of muscles and device */
    struct ground_frame ground[SIDE_COUNT][FOOT_POINTS];
    const struct reflex_person_loads *loads;
    struct multibody_state start; /* the body at the step's begin */
    struct multibody_pose pose;
};

/* What the ground does to the feet. */
struct ground_reactions {
    struct vector2 force_N[SIDE_COUNT];
    struct vector2 moment_Nm[SIDE_COUNT]; /* each point's vertical force times its place */
};

static void accelerate(const struct reflex_person *person, const struct held *held,
                       const struct multibody_state *body, double acceleration[MULTIBODY_DOF],
                       struct ground_reactions *reactions)
{
    const struct reflex_person_params *params = &person->params;
    double force[MULTIBODY_DOF] = {held->loads->push_N.x, held->loads->push_N.y};
    struct multibody_pose pose;
    multibody_pose_near(&params->segments, body, &held->start, &held->pose, &pose);
    for (int side = 0; side < SIDE_COUNT; side++) {
        double torque[JOINT_COUNT];
        struct joint_angles joints;
        memcpy(torque, held->torque_Nm[side], sizeof torque);
        muscles_joint_angles(body, (enum side)side, &joints);
        muscles_add_joint_ends(&joints, params->mass_kg, torque);
        muscles_add_to_body(torque, (enum side)side, force);
        struct vector2 *force_N = &reactions->force_N[side];
        struct vector2 *moment_Nm = &reactions->moment_Nm[side];
        *force_N = *moment_Nm = (struct vector2){0.0, 0.0};
        for (int point = 0; point < FOOT_POINTS; point++) {
            struct vector2 position, velocity;
            const struct vector2 at = point_of(&params->segments, (enum foot_point)point);
            multibody_foot_point(body, &pose, (enum side)side, at, &position, &velocity);
            const struct vector2 push =
                contact_force(&params->contact, &person->contact[side][point], position, velocity,
                              &held->ground[side][point], NULL);
            if (push.y > 0.0) {
                multibody_add_force(&pose, (enum side)side, at, push, force);
                force_N->x += push.x;
                force_N->y += push.y;
                moment_Nm->x += push.y * position.x;
                moment_Nm->y += push.y * position.y;
            }
        }
    }
    multibody_accelerations(&params->segments, body, &pose, force, acceleration);
}

static void keep_reactions(struct reflex_person *person, const struct ground_reactions *reactions)
{
    memcpy(person->ground_N, reactions->force_N, sizeof person->ground_N);
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double vertical_N = reactions->force_N[side].y;
        if (vertical_N > 0.0) {
            person->pressure_m[side] = (struct vector2){reactions->moment_Nm[side].x / vertical_N,
                                                        reactions->moment_Nm[side].y / vertical_N};
        }
    }
}

/* Runge and Kutta's fourth order; the contacts' holds stay where they are meanwhile. */
static void advance_body(struct reflex_person *person, const struct held *held)
{
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    const double step_s = person->params.step_s;
    const struct multibody_state start = held->start;
    struct multibody_state slope = {{0}, {0}}, sum = {{0}, {0}};
    for (int stage = 0; stage < 4; stage++) {
        struct multibody_state here;
        struct ground_reactions reactions;
        for (int i = 0; i < MULTIBODY_DOF; i++) {
            here.q[i] = start.q[i] + at[stage] * step_s * slope.q[i];
            here.dq[i] = start.dq[i] + at[stage] * step_s * slope.dq[i];
        }
        accelerate(person, held, &here, slope.dq, &reactions);
        for (int i = 0; i < MULTIBODY_DOF; i++) {
            slope.q[i] = here.dq[i];
            sum.q[i] += weight[stage] / 6.0 * slope.q[i];
            sum.dq[i] += weight[stage] / 6.0 * slope.dq[i];
        }
        if (stage == 0) {
            keep_reactions(person, &reactions);
        }
    }
    for (int i = 0; i < MULTIBODY_DOF; i++) {
        person->body.q[i] = start.q[i] + step_s * sum.q[i];
        person->body.dq[i] = start.dq[i] + step_s * sum.dq[i];
    }
}

static void pull(struct reflex_person *person, const struct reflex_person_loads *loads,
                 enum side side, double torque_Nm[JOINT_COUNT])
{
    const struct reflex_person_params *params = &person->params;
    struct joint_angles joints;
    struct muscle_passes passes;
    muscles_joint_angles(&person->body, side, &joints);
    muscles_pass(&joints, &passes);
    memset(torque_Nm, 0, JOINT_COUNT * sizeof *torque_Nm);
    for (int i = 0; i < MUSCLE_COUNT; i++) {
        const enum muscle_id id = (enum muscle_id)i;
        const double total_m = muscles_total_m(params->muscle[side], id, params->leg_m, &passes);
        const double force_N =
            muscle_step(&params->muscle[side][i], total_m, person->stimulation[side][i],
                        params->step_s, &person->muscle[side][i]);
        muscles_add_torque(id, params->leg_m, &passes, force_N, torque_Nm);
    }
    for (int i = 0; i < JOINT_COUNT; i++) {
        const double work_J = torque_Nm[i] * joints.rate_rad_s[i] * params->step_s;
        person->torque_Nm[side][i] = torque_Nm[i];
        person->muscle_work_J[side][i] += work_J;
        person->muscle_positive_work_J[side][i] += work_J > 0.0 ? work_J : 0.0;
    }
    torque_Nm[JOINT_ANKLE] += loads->ankle_Nm[side];
}

void reflex_person_step(struct reflex_person *person, const struct reflex_person_loads *loads)
{
    const struct reflex_person_params *params = &person->params;
    struct held held = {.loads = loads, .start = person->body};
    const uint64_t a_sense = (uint64_t)(SENSE_PERIOD_S / params->step_s + 0.5);
    if (person->steps % a_sense == 0) {
        struct reflex_moment moment;
        sense(person, &moment);
        reflexes_sense(&person->reflexes, &moment);
        for (int side = 0; side < SIDE_COUNT; side++) {
            reflexes_stimulate(&person->reflexes, &params->gains, (enum side)side,
                               person->stimulation[side]);
            if (params->noise_share > REFLEX_NOISE_NONE) {
                reflex_noise_add(&person->noise, params->noise_share, (enum side)side,
                                 person->stimulation[side]);
            }
        }
    }
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int point = 0; point < FOOT_POINTS; point++) {
            held.ground[side][point] = ground_frame_of(&person->ground[side][point]);
        }
        pull(person, loads, (enum side)side, held.torque_Nm[side]);
    }
    multibody_pose(&params->segments, &held.start, &held.pose);
    advance_body(person, &held);
    struct multibody_pose pose;
    multibody_pose_near(&params->segments, &person->body, &held.start, &held.pose, &pose);
    for (int side = 0; side < SIDE_COUNT; side++) {
        for (int point = 0; point < FOOT_POINTS; point++) {
            struct vector2 position, velocity;
            multibody_foot_point(&person->body, &pose, (enum side)side,
                                 point_of(&params->segments, (enum foot_point)point), &position,
                                 &velocity);
            contact_update(&params->contact, &person->contact[side][point], position, velocity,
                           &held.ground[side][point]);
        }
    }
    person->steps++;
}

/* The speeds that an impulse leaves: the accelerations of such a force at rest and without gravity, for a second. */
static void speeds_of(const struct reflex_person *person, const struct multibody_pose *pose,
                      const double impulse[MULTIBODY_DOF], double change[MULTIBODY_DOF])
{
    struct segments segments = person->params.segments;
    struct multibody_state rest = person->body;
    segments.gravity_m_s2 = 0.0;
    memset(rest.dq, 0, sizeof rest.dq);
    multibody_accelerations(&segments, &rest, pose, impulse, change);
}

void reflex_person_push(struct reflex_person *person, struct vector2 impulse_Ns)
{
    const double impulse[MULTIBODY_DOF] = {impulse_Ns.x, impulse_Ns.y};
    struct multibody_pose pose;
    double change[MULTIBODY_DOF];
    multibody_pose(&person->params.segments, &person->body, &pose);
    speeds_of(person, &pose, impulse, change);
    for (int i = 0; i < MULTIBODY_DOF; i++) {
        person->body.dq[i] += change[i];
    }
}

void reflex_person_trip(struct reflex_person *person, enum side side, enum foot_point point)
{
    const struct segments *segments = &person->params.segments;
    const struct vector2 foot_m = point_of(segments, point);
    struct multibody_state unit = person->body;
    struct multibody_pose pose;
    struct vector2 at_m, speed_m_s, a_unit_m_s;
    double impulse[MULTIBODY_DOF] = {0.0};
    multibody_pose(&person->params.segments, &person->body, &pose);
    multibody_foot_point(&person->body, &pose, side, foot_m, &at_m, &speed_m_s);
    if (speed_m_s.x <= 0.0) {
        return;
    }
    multibody_add_force(&pose, side, foot_m, (struct vector2){1.0, 0.0}, impulse);
    speeds_of(person, &pose, impulse, unit.dq);
    multibody_foot_point(&unit, &pose, side, foot_m, &at_m, &a_unit_m_s);
    for (int i = 0; i < MULTIBODY_DOF; i++) {
        person->body.dq[i] -= speed_m_s.x / a_unit_m_s.x * unit.dq[i];
    }
}

bool reflex_person_fell(const struct reflex_person *person)
{
    double check = 0.0;
    for (int i = 0; i < MULTIBODY_DOF; i++) {
        check += person->body.q[i] - person->body.q[i] + (person->body.dq[i] - person->body.dq[i]);
    }
    const double ground_m =
        0.5 *
        (ground_height_m(&person->ground[SIDE_LEFT][FOOT_BALL], person->body.q[MULTIBODY_X]) +
         ground_height_m(&person->ground[SIDE_RIGHT][FOOT_BALL], person->body.q[MULTIBODY_X]));
    return !(check == 0.0) ||
           person->body.q[MULTIBODY_Y] - ground_m < FELL_SHARE * person->params.leg_m;
}
