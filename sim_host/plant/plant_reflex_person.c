/* A person who walks by reflexes, with the SEAs at the ankles: what the springs do moves the person. Like a
 * recording's, the walk begins at recording_start_tick; the pose of its begin is held before. Who has fallen lies still.
 *
 * Between a spring's end and the ankle there is a strut. While the latch is closed it gets shorter as the ankle flexes
 * below neutral, without force; above neutral it has its full length, and the ankle moves away from it. The latch that
 * opens locks it at the length that it has, until the latch closes. So an open latch's spring is compressed by the
 * motor's position less the ankle's whole way since then, flexing and extending: its force is k (x - (r - r_locked)), with
 * r_locked = r at the release, at most 0. An ankle at or above neutral feels k (x - r), as every other plant's. */
#include "model/trig.h"
#include "sim_host/plant/plant_internal.h"
#include "sim_host/plant/walk_internal.h"

#define RIGHT_ANGLE_RAD 1.57079632679489661923
#define CONTACT_N 20.0 /* what a foot on the ground carries at least */

/* Pitch of the virtual leg from hip to ankle, and its rate: thigh and shank are equally long (recording.h). */
static void virtual_leg(const struct reflex_person *reflex, enum side side, double *angle_rad,
                        double *rate_rad_s)
{
    const double *angle = reflex->body.q + multibody_leg(side),
                 *rate = reflex->body.dq + multibody_leg(side);
    *angle_rad = 0.5 * (angle[PART_THIGH] + angle[PART_SHANK]);
    *rate_rad_s = 0.5 * (rate[PART_THIGH] + rate[PART_SHANK]);
}

struct flexion {
    double angle_rad, rate_rad_s;
};

static struct flexion plantarflexion(const struct reflex_person *reflex, enum side side)
{
    struct joint_angles joints;
    muscles_joint_angles(&reflex->body, side, &joints);
    return (struct flexion){joints.angle_rad[JOINT_ANKLE] - RIGHT_ANGLE_RAD,
                            joints.rate_rad_s[JOINT_ANKLE]};
}

static double ankle_m_of(const struct plant *plant, enum side side)
{
    return recording_ankle_m(&plant->config.recording_format.ankle[side],
                             plantarflexion(&plant->reflex, side).angle_rad);
}

/* The ankle's way from neutral, below 0 where it is flexed; a sensor's is never (recording.h). */
static double way_m_of(const struct plant *plant, enum side side)
{
    const struct recording_ankle *ankle = &plant->config.recording_format.ankle[side];
    return sea_lever_way_m(&ankle->lever_table, ankle->lever_m,
                           plantarflexion(&plant->reflex, side).angle_rad - ankle->neutral_rad);
}

/* What the way changes by with the angle: the moment of a force, too. */
static double lever_m_of(const struct plant *plant, enum side side)
{
    const struct recording_ankle *ankle = &plant->config.recording_format.ankle[side];
    return sea_lever_at_m(&ankle->lever_table, ankle->lever_m,
                          plantarflexion(&plant->reflex, side).angle_rad - ankle->neutral_rad);
}

/* The strut follows the ankle behind a closed latch. Where the spring's end stands then. */
static double follow_ankle(struct plant *plant, enum side side)
{
    const double way_m = way_m_of(plant, side);
    if (plant->sea[side].latch == SEA_LATCH_CLOSED) {
        plant->strut_m[side] = way_m < 0.0 ? way_m : 0.0;
    }
    return way_m - plant->strut_m[side];
}

double plant_reflex_spring_end_m(const struct plant *plant, enum side side)
{
    return way_m_of(plant, side) - plant->strut_m[side];
}

static double ankle_rate_m_s_of(const struct plant *plant, enum side side)
{
    return lever_m_of(plant, side) * plantarflexion(&plant->reflex, side).rate_rad_s;
}

static void look(const struct plant *plant, struct recorded_person_state *person)
{
    for (int k = 0; k < SIDE_COUNT; k++) {
        const enum side side = (enum side)k;
        virtual_leg(&plant->reflex, side, &person->leg_angle_rad[k], &person->leg_rate_rad_s[k]);
        person->ankle_m[k] = ankle_m_of(plant, side);
        person->ankle_rate_m_s[k] =
            person->ankle_m[k] > 0.0 ? ankle_rate_m_s_of(plant, side) : 0.0; /* the heel is down */
        person->contact[k] = plant->reflex.ground_N[k].y > CONTACT_N;
    }
}

void plant_init_reflex_person(struct plant *plant)
{
    struct reflex_person_params params = plant->config.reflex;
    params.step_s = plant->config.sea[SIDE_LEFT].drive_period_s;
    params.noise_seed = plant->config.seed;
    reflex_person_init(&plant->reflex, &params);
    for (int side = 0; side < SIDE_COUNT; side++) {
        (void)follow_ankle(plant, (enum side)side);
    }
    look(plant, &plant->person);
}

/* Heel strikes, toe-offs, and the leg passing the vertical while its foot is on the ground. */
static void post_events(struct plant *plant, const struct recorded_person_state *before)
{
    const struct recorded_person_state *now = &plant->person;
    const double tick_s = plant->config.tick_s, next_s = plant_now_s(plant) + tick_s;
    for (int k = 0; k < SIDE_COUNT; k++) {
        const enum side side = (enum side)k;
        const double from = before->leg_angle_rad[k], to = now->leg_angle_rad[k];
        if (from > 0.0 && to <= 0.0 && now->contact[k]) {
            const double part = from / (from - to);
            const double rate = before->leg_rate_rad_s[k] +
                                part * (now->leg_rate_rad_s[k] - before->leg_rate_rad_s[k]);
            walk_post(&plant->walk, WALK_EVENT_APEX, side, next_s - (1.0 - part) * tick_s, -rate);
        }
        if (now->contact[k] != before->contact[k]) {
            walk_post(&plant->walk, now->contact[k] ? WALK_EVENT_HEEL_STRIKE : WALK_EVENT_TOE_OFF,
                      side, next_s, now->leg_angle_rad[k]);
        }
    }
}

static double force_N(const struct plant *plant, enum side side, double end_m)
{
    return plant->config.unworn ? 0.0 : sea_ankle_force_N(&plant->sea[side], end_m);
}

/* A drive period. end_m: where the springs' ends stand if their latches are open, at its begin, and then at its end. */
static void run_period(struct plant *plant, double now_s, double end_m[SIDE_COUNT])
{
    struct reflex_person_loads loads = {.ankle_Nm = {0.0}};
    double before_N[SIDE_COUNT];
    for (int k = 0; k < SIDE_COUNT; k++) {
        const enum side side = (enum side)k;
        /* A motor that is home lets go of a strut, however far the ankle is flexed. */
        plant_run_latch(plant, side, end_m[k] > 0.0 ? end_m[k] : 0.0, now_s);
        sea_drive_period(&plant->sea[k], end_m[k]);
        before_N[k] = force_N(plant, side, end_m[k]);
        if (before_N[k] != 0.0) {
            loads.ankle_Nm[k] = before_N[k] * lever_m_of(plant, side);
        }
    }
    if (plant->tick >= plant->config.recording_start_tick && plant->walk.fault == WALK_FAULT_NONE) {
        reflex_person_step(&plant->reflex, &loads);
    }
    for (int k = 0; k < SIDE_COUNT; k++) {
        const enum side side = (enum side)k;
        const double after_m = follow_ankle(plant, side);
        sea_finish_period(&plant->sea[k]);
        plant->person_work_J[k] +=
            0.5 * (before_N[k] + force_N(plant, side, after_m)) * (after_m - end_m[k]);
        end_m[k] = after_m;
    }
}

/* Which way it lies: the hip against the middle of the feet. */
static enum walk_fault fall_of(const struct reflex_person *reflex)
{
    double ahead_m = 0.0;
    if (!reflex_person_fell(reflex)) {
        return WALK_FAULT_NONE;
    }
    for (int k = 0; k < SIDE_COUNT; k++) {
        ahead_m += reflex->body.q[MULTIBODY_X] - reflex_person_ball(reflex, (enum side)k).x;
    }
    if (!(ahead_m - ahead_m == 0.0)) {
        return WALK_FAULT_NOT_FINITE;
    }
    return ahead_m > 0.0 ? WALK_FAULT_FALLEN_FORWARD : WALK_FAULT_FALLEN_BACKWARD;
}

void plant_advance_reflex_person(struct plant *plant)
{
    const double period_s = plant->config.sea[SIDE_LEFT].drive_period_s;
    const int periods = (int)(plant->config.tick_s / period_s + 0.5);
    const struct recorded_person_state before = plant->person;
    plant_run_switches(plant, true);
    plant_lay_reflex_ground(plant);
    double end_m[SIDE_COUNT] = {plant_reflex_spring_end_m(plant, SIDE_LEFT),
                                plant_reflex_spring_end_m(plant, SIDE_RIGHT)};
    for (int i = 0; i < periods; i++) {
        run_period(plant, plant_now_s(plant) + (double)i * period_s, end_m);
    }
    look(plant, &plant->person);
    post_events(plant, &before);
    if (plant->walk.fault == WALK_FAULT_NONE) {
        plant->walk.fault = fall_of(&plant->reflex);
    }
}

void plant_reflex_truth(const struct plant *plant, struct plant_truth *truth)
{
    const struct reflex_person *reflex = &plant->reflex;
    truth->hip_m[0] = -reflex->body.q[MULTIBODY_X];
    truth->hip_m[1] = reflex->body.q[MULTIBODY_Y];
    for (int k = 0; k < SIDE_COUNT; k++) {
        const struct vector2 ball = reflex_person_ball(reflex, (enum side)k);
        truth->toe_m[k][0] = -ball.x;
        truth->toe_m[k][1] = ball.y;
        truth->ground_force_N[k][0] = -reflex->ground_N[k].x;
        truth->ground_force_N[k][1] = reflex->ground_N[k].y;
        truth->way_m[k] = way_m_of(plant, (enum side)k);
        truth->way_rate_m_s[k] = ankle_rate_m_s_of(plant, (enum side)k);
    }
}
