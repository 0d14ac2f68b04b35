/* A planar body of seven rigid segments: trunk (with head and arms), and a thigh, a shank and a foot a side.
 *
 * Coordinates: x forward, y up, angles counterclockwise, so that a leg that swings forward turns in the positive sense.
 * A segment's angle is its own against the ground, not against its neighbour. All are 0 when it stands upright:
 * trunk up, legs down, feet flat.
 *   q = (hip x, hip y, trunk, left thigh, left shank, left foot, right thigh, right shank, right foot)
 * Each segment turns about its upper joint: thigh and trunk at the hip, the shank at the knee, the foot at the ankle.
 *
 * The equations are Newton's for each segment, projected on the coordinates: with the vectors r_j that lead from the
 * hip to a centre of mass, its acceleration is  hip'' + sum(alpha_j perp(r_j) - omega_j^2 r_j).  A leg meets the rest
 * of the body in the hip's two coordinates only. So the equations are solved leg by leg, 3 x 3, then 2 x 2.
 *
 * Pure functions: no heap, no globals, constant cost (about 1 us). Only + - * / sqrt and model/trig.h: the same bits on
 * every machine. Nothing is checked on the way in: segments_check() once (segments.h).
 */
#ifndef SIM_HOST_REFLEX_MULTIBODY_H
#define SIM_HOST_REFLEX_MULTIBODY_H

#include "model/side.h"

enum { PART_THIGH = 0, PART_SHANK = 1, PART_FOOT = 2, LEG_PARTS = 3 };
enum {
    MULTIBODY_X = 0,
    MULTIBODY_Y = 1,
    MULTIBODY_TRUNK = 2,
    MULTIBODY_LEFT = 3,  /* + PART_x */
    MULTIBODY_RIGHT = 6, /* + PART_x */
    MULTIBODY_DOF = 9
};

struct vector2 {
    double x, y; /* m, m/s, N */
};

struct segment {
    double mass_kg;
    double length_m;         /* upper joint to lower joint; unused of a foot and of the trunk */
    struct vector2 centre_m; /* of mass, from the upper joint, at angle 0 */
    double inertia_kgm2;     /* about the centre of mass */
};

struct segments {
    struct segment trunk, part[LEG_PARTS]; /* both legs are alike */
    struct vector2 heel_m, ball_m;         /* of the foot, from the ankle, at angle 0 */
    double gravity_m_s2;
};

struct multibody_state {
    double q[MULTIBODY_DOF];  /* m, m, rad */
    double dq[MULTIBODY_DOF]; /* m/s, m/s, rad/s */
};

/* Sine and cosine of every angle, and what thighs and shanks lead to: worked out once for a state, and used by all that
 * is asked of it. */
struct multibody_pose {
    double sine[MULTIBODY_DOF], cosine[MULTIBODY_DOF]; /* from MULTIBODY_TRUNK on */
    struct vector2 shaft_m[SIDE_COUNT][PART_FOOT];     /* from the upper joint to the lower one */
};

/* Where a leg's coordinates begin. */
static inline int multibody_leg(enum side side)
{
    return side == SIDE_LEFT ? MULTIBODY_LEFT : MULTIBODY_RIGHT;
}

void multibody_pose(const struct segments *segments, const struct multibody_state *state,
                    struct multibody_pose *pose);

/* The same of a state whose angles lie close to those of another one (0.02 rad), by that one's pose: turned by the
 * difference, to rounding. A fifth of the time; further away it is multibody_pose(). */
void multibody_pose_near(const struct segments *segments, const struct multibody_state *state,
                         const struct multibody_state *close,
                         const struct multibody_pose *close_pose, struct multibody_pose *pose);

/* The accelerations under gravity and generalised forces (N, N, then N m in the sense of each angle). */
void multibody_accelerations(const struct segments *segments, const struct multibody_state *state,
                             const struct multibody_pose *pose, const double force[MULTIBODY_DOF],
                             double acceleration[MULTIBODY_DOF]);

/* A point of a foot, given from the ankle at angle 0: where it is and how fast it moves. */
void multibody_foot_point(const struct multibody_state *state, const struct multibody_pose *pose,
                          enum side side, struct vector2 at_m, struct vector2 *position_m,
                          struct vector2 *velocity_m_s);

/* Adds what a force (N) at such a point does to every coordinate. */
void multibody_add_force(const struct multibody_pose *pose, enum side side, struct vector2 at_m,
                         struct vector2 force_N, double force[MULTIBODY_DOF]);

/* Kinetic and potential energy, J; height 0 is the ground's. */
double multibody_energy_J(const struct segments *segments, const struct multibody_state *state);

/* The centre of mass, and its velocity. */
void multibody_centre(const struct segments *segments, const struct multibody_state *state,
                      struct vector2 *position_m, struct vector2 *velocity_m_s);

#endif
