/* A person who walks by reflexes: the body, its fourteen muscles, its feet on the ground, and what drives them.
 *
 * The state is plain data: a copy is a snapshot, and the same future follows from it bit for bit. A step costs about
 * 5 us. Planar; no learning; nothing is known of balance beyond the reflexes (reflexes.h).
 */
#ifndef SIM_HOST_REFLEX_REFLEX_PERSON_H
#define SIM_HOST_REFLEX_REFLEX_PERSON_H

#include <stdbool.h>
#include <stdint.h>

#include "sim_host/reflex/contact.h"
#include "sim_host/reflex/muscles.h"
#include "sim_host/reflex/reflex_noise.h"
#include "sim_host/reflex/reflexes.h"

enum foot_point { FOOT_HEEL = 0, FOOT_BALL = 1, FOOT_POINTS = 2 };

struct reflex_person_params {
    double mass_kg, leg_m; /* hip to sole */
    double gravity_m_s2;
    struct segments segments;
    struct contact_params contact;
    struct muscle muscle[SIDE_COUNT][MUSCLE_COUNT];
    struct reflex_gains gains;
    double noise_share; /* of every stimulation: reflex_noise.h */
    uint64_t noise_seed;
    /* At the start: hip's speed, and how far the legs are apart. The left leg is ahead and swings. */
    double start_speed_m_s, start_lean_rad;
    double step_s; /* a whole part of a millisecond */
};

/* What acts on it from outside during a step. */
struct reflex_person_loads {
    double ankle_Nm[SIDE_COUNT]; /* of a device, positive extends (plantarflexes) */
    struct vector2 push_N;       /* at the hip */
};

struct reflex_person {
    struct reflex_person_params params;
    struct multibody_state body;
    struct muscle_state muscle[SIDE_COUNT][MUSCLE_COUNT];
    struct contact_point contact[SIDE_COUNT][FOOT_POINTS];
    struct ground_line ground[SIDE_COUNT][FOOT_POINTS]; /* below each; at first level, at 0 */
    struct reflexes reflexes;
    struct reflex_noise noise; /* unused where params.noise_share is REFLEX_NOISE_NONE */
    double stimulation[SIDE_COUNT][MUSCLE_COUNT];
    struct vector2
        ground_N[SIDE_COUNT]; /* the ground's force on each foot, at the last step's begin */
    struct vector2 pressure_m
        [SIDE_COUNT]; /* the centre of pressure then; where a foot has no force, its last */
    double muscle_work_J[SIDE_COUNT][JOINT_COUNT]; /* at each joint, since the start */
    double muscle_positive_work_J[SIDE_COUNT][JOINT_COUNT];
    double torque_Nm[SIDE_COUNT][JOINT_COUNT]; /* of the muscles, at the last step's begin */
    uint64_t steps;
};

/* A healthy person, new to the device: Geyer & Herr's, scaled from their 80 kg and 1 m, with softer feet, the gains
 * that suit these, and the preset REFLEX_NOISE_NONE. */
void reflex_person_default(double mass_kg, double leg_m, struct reflex_person_params *params);

/* NULL, or which number is out of its range. */
const char *reflex_person_check(const struct reflex_person_params *params);

void reflex_person_init(struct reflex_person *person, const struct reflex_person_params *params);

/* One step of params.step_s. */
void reflex_person_step(struct reflex_person *person, const struct reflex_person_loads *loads);

/* New ground below a heel or a ball that is in the air: true where it is above that; else all stays as it was. */
bool reflex_person_lay_ground(struct reflex_person *person, enum side side, enum foot_point point,
                              const struct ground_line *ground);

/* The same below a whole foot. */
bool reflex_person_lay_foothold(struct reflex_person *person, enum side side,
                                const struct ground_line ground[FOOT_POINTS]);

/* Where heel or ball of a foot is, m. */
struct vector2 reflex_person_place(const struct reflex_person *person, enum side side,
                                   enum foot_point point);
struct vector2 reflex_person_ball(const struct reflex_person *person, enum side side);

/* An impulse at the hip, N s. */
void reflex_person_push(struct reflex_person *person, struct vector2 impulse_Ns);

/* The foot stops short at something: the impulse along x that leaves its heel or ball none of its speed there. Nothing
 * where that moves backward. */
void reflex_person_trip(struct reflex_person *person, enum side side, enum foot_point point);

/* Whether the hip is less than 0.6 legs above the ground, or something is not finite. */
bool reflex_person_fell(const struct reflex_person *person);

#endif
