/* The bodies of the walker: three degrees of freedom, constraint forces, impulses.
 *
 * A compass walker from its Lagrangian, in inertial coordinates with the stance
 * toe at the origin; it walks towards -x. Coordinates:
 *   q = (theta_s, theta_n, r): angle of the stance and of the swing leg from
 *       the vertical (positive = foot ahead of the hip, which then lies at
 *       x = (l + r) sin theta_s > 0 of the stance toe) and extension of the
 *       stance ankle.
 * Points: the hip mass M is at (l + r) along the stance leg. The stance leg's mass m is at r + l/2, for
 * the spring is below the leg. The swing leg's mass m is l/2 below the hip.
 * Nothing here is taken from model/: no reduced equations, constraints are
 * forces (Lagrange multipliers), impacts are impulses.
 *
 * All functions are pure: no heap, no globals, no I/O; callable from anywhere
 * that may use double; constant cost. Only + - * / sqrt and model/trig.h, so the
 * bits are the same on every machine. Nothing is checked on the way in:
 * walker3_params_check() once, and the caller watches for non-finite states.
 */
#ifndef SIM_HOST_PLANT_WALKER3_H
#define SIM_HOST_PLANT_WALKER3_H

#include <stdbool.h>

struct walker3_params {
    double hip_mass_kg;  /* M, (0, 1e4] */
    double leg_mass_kg;  /* m of each leg, (0, 1e3]; zero would leave the swing leg undefined */
    double leg_length_m; /* l, hip to ankle spring at r = 0, [0.05, 10] */
    double gravity_m_s2; /* [0.1, 100] */
};

enum { WALKER3_STANCE = 0, WALKER3_SWING = 1, WALKER3_ANKLE = 2, WALKER3_DOF = 3 };

struct walker3_state {
    double q[WALKER3_DOF];  /* rad, rad, m */
    double dq[WALKER3_DOF]; /* rad/s, rad/s, m/s */
};

/* What holds the body. The stance toe is always pinned (it is the origin). */
struct walker3_contact {
    bool ankle_locked;        /* r is held (heel on the ground, or latched) */
    bool swing_toe_pinned;    /* double support */
    double swing_extension_m; /* extension of the other foot, held, >= 0 */
};

/* Force along the stance ankle as a function of time and extension:
 *     device_N_per_m * (position - r) + own_N_per_m * (own_rest_m - r).
 * The motor is at position(tau) = position_m + speed_m_s tau + acceleration_m_s2 tau^2 / 2. tau
 * counts from the instant that the struct describes. Neither spring pulls: each term is 0 when
 * negative. device_smooth lets the device's term be negative, for double support. The caller ends that
 * where the spring would pull, so the force is smooth up to the event that is landed on it. */
struct walker3_ankle {
    bool device_smooth;
    double device_N_per_m;
    double position_m;
    double speed_m_s;
    double acceleration_m_s2;
    double own_N_per_m;
    double own_rest_m;
};

struct walker3_forces {
    double ankle_lock_N;    /* along the stance leg, holding r; 0 while free */
    double stance_toe_N[2]; /* ground on the stance toe: x, y */
    double swing_toe_N[2];  /* ground on the other toe; 0 in single support */
};

enum walker3_param_error {
    WALKER3_PARAMS_OK = 0,
    WALKER3_BAD_HIP_MASS = -1,
    WALKER3_BAD_LEG_MASS = -2,
    WALKER3_BAD_LEG_LENGTH = -3,
    WALKER3_BAD_GRAVITY = -4
};

/* Checks each field against the range beside it; non-finite values fail. */
enum walker3_param_error walker3_params_check(const struct walker3_params *params);

/* Position of the hip and of the other foot's toe relative to the stance toe (m). */
void walker3_hip(const struct walker3_params *params, const struct walker3_state *state,
                 double hip_m[2]);
void walker3_toe(const struct walker3_params *params, const struct walker3_state *state,
                 double swing_extension_m, double toe_m[2]);
/* Velocity of the other foot's toe (m/s), its extension held. */
void walker3_toe_velocity(const struct walker3_params *params, const struct walker3_state *state,
                          double swing_extension_m, double toe_m_s[2]);

/* Kinetic energy, and potential energy above the stance toe's height (J). The
 * springs' energy is not in it. */
double walker3_kinetic_J(const struct walker3_params *params, const struct walker3_state *state);
double walker3_potential_J(const struct walker3_params *params, const struct walker3_state *state);

/* Accelerations of q under gravity, the ankle force (N, > 0 extends) and the
 * constraint forces of `contact`. forces may be NULL. The constraints are kept
 * at the level of accelerations. */
void walker3_accelerate(const struct walker3_params *params, const struct walker3_state *state,
                        const struct walker3_contact *contact, double ankle_force_N,
                        double ddq[WALKER3_DOF], struct walker3_forces *forces);

/* Ankle force of `ankle` at tau_s and extension_m (N). */
double walker3_ankle_force_N(const struct walker3_ankle *ankle, double tau_s, double extension_m);

/* One step of the classical fourth-order Runge-Kutta method from tau_s (the
 * time on `ankle`'s clock) to tau_s + step_s. *next may be *state. */
void walker3_step(const struct walker3_params *params, const struct walker3_state *state,
                  const struct walker3_contact *contact, const struct walker3_ankle *ankle,
                  double tau_s, double step_s, struct walker3_state *next);

struct walker3_impact {
    double stance_toe_Ns[2]; /* impulse of the ground on the stance toe */
    double swing_toe_Ns[2];  /* and on the other toe */
    double lost_J;           /* kinetic energy lost, >= 0 */
    bool clamped;            /* r' would have been negative and was set to 0 */
};

/* Plastic impact of the other toe while the stance toe stays pinned: from the
 * impulse equations, no slip, no rebound. The stance ankle is free but its heel is not.
 * At r <= 0, a negative rate makes all three rates zero: heel and both toes hold. impact may be NULL. */
void walker3_collide(const struct walker3_params *params, struct walker3_state *state,
                     double swing_extension_m, struct walker3_impact *impact);

/* An impulse (N s; x, y) on the hip under the constraints of `contact`. */
void walker3_push(const struct walker3_params *params, struct walker3_state *state,
                  const struct walker3_contact *contact, const double impulse_Ns[2]);

/* Brings the stance ankle to rest (r' = 0), plastically: the heel comes down. In
 * double support nothing is left to move. */
void walker3_lock_ankle(const struct walker3_params *params, struct walker3_state *state,
                        const struct walker3_contact *contact);

/* The legs swap names after lift-off: the origin moves to the toe of the old
 * swing leg, whose extension becomes r (r' = 0). */
void walker3_swap_legs(struct walker3_state *state, double swing_extension_m);

#endif
