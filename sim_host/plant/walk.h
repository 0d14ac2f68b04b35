/* The walk: the phases of a step, their events, and the two SEAs at the ankles.
 *
 * Phases: HELD (start_hold.h), SINGLE and DOUBLE support, DOWN (a fault ended the walk; the state
 * stays as it was). Heel strike, release, locked ankle, lift-off and fall are landed inside a step
 * of the integrator. Apexes are landed for the record only. What holds the ankle and the toes is
 * walker3.h's contact. The walk chooses it:
 *   - single support: the heel is on the ground (r = 0 is held) while the stance spring is
 *     latched. Else r is free while the spring lifts the heel, which comes down again plastically.
 *   - heel strike: the toe of the swing leg meets the ground on its way down, ahead of the stance
 *     toe, with theta_s < 0 and theta_s + theta_n falling. While that sum rises, in mid-stance,
 *     the scuff is ignored. The impact is plastic. If the trailing latch is not armed and the
 *     walker has no push-off of its own, the trailing foot leaves after unarmed_hold_s (default:
 *     at once).
 *   - double support: both toes are pinned. r of the trailing leg is free, not below 0. The
 *     leading ankle is held as it landed.
 *   - lift-off: the released spring and the own push-off have reached their ends. The leaving foot
 *     follows its motor back. One that is not back yet lands earlier, on a longer leg, and then
 *     stands on its spring.
 * Sides: the walk names legs left and right; walker3 knows stance and swing.
 *
 * No heap, no globals, no I/O; plain data, a copy is a snapshot. Cost of one tick: one step of the
 * integrator in single support, one per drive period elsewhere, and about ten more per event.
 */
#ifndef SIM_HOST_PLANT_WALK_H
#define SIM_HOST_PLANT_WALK_H

#include <stdbool.h>
#include <stdint.h>

#include "model/side.h"
#include "sim_host/plant/sea.h"
#include "sim_host/plant/walker3.h"

enum walk_phase { WALK_HELD = 0, WALK_SINGLE = 1, WALK_DOUBLE = 2, WALK_DOWN = 3 };

enum walk_fault {
    WALK_FAULT_NONE = 0,
    WALK_FAULT_FALLEN_FORWARD = 1,  /* theta_s beyond -fall_angle: no foot in front in time */
    WALK_FAULT_FALLEN_BACKWARD = 2, /* theta_s beyond +fall_angle */
    WALK_FAULT_BACKWARDS = 3,       /* turned back before the apex: rate >= 0 with theta_s > 0 */
    WALK_FAULT_TRIPPED = 4,      /* legs passed with the foot further out than trip_extension_m */
    WALK_FAULT_FLIGHT = 5,       /* the stance foot left the ground in single support */
    WALK_FAULT_STUCK = 6,        /* double support longer than stuck_s */
    WALK_FAULT_SLIPPED = 7,      /* a foot needed more friction than there is */
    WALK_FAULT_LEGS_CROSSED = 8, /* inter-leg angle beyond pi */
    WALK_FAULT_NOT_FINITE = 9    /* a state is not a number: a defect, or absurd parameters */
};

/* Lower-case words with underscores, for JSON and messages; never NULL. */
const char *walk_fault_name(enum walk_fault fault);

struct walk_params {
    struct walker3_params body;
    double slope_rad;        /* > 0 uphill, |slope| <= 0.5 */
    double friction;         /* coefficient; 0 = no limit */
    double trip_extension_m; /* default 0.03 l */
    double fall_angle_rad;   /* default pi/2 */
    double stuck_s;          /* default 5 */
    double unarmed_hold_s;   /* an unarmed trailing foot stays on the ground so long; default 0 */
    double single_step_s;    /* largest integrator step, single support; default 1 ms */
    double double_step_s;    /* and elsewhere; default 0.25 ms */
    double own_push_N_per_m; /* own push-off of the walker, default 0: none */
    double own_push_rest_m;
};

enum walk_event_kind {
    WALK_EVENT_APEX = 0,        /* value: forward apex speed, rad/s */
    WALK_EVENT_HEEL_STRIKE = 1, /* side that lands; value: step length, m */
    WALK_EVENT_RELEASE = 2,     /* side whose spring is released; value: precompression, m */
    WALK_EVENT_LIFT_OFF = 3,    /* side that leaves; value: its ankle's extension, m */
    WALK_EVENT_FAULT = 4,       /* value: enum walk_fault */
    WALK_EVENT_LET_GO = 5,      /* side: stance; value: 0 */
    WALK_EVENT_TAKE_HOLD = 6,
    WALK_EVENT_TOE_OFF = 7, /* recorded person only: contact ends; value: leg angle, rad */
    WALK_EVENT_RECLOSED = 8 /* latch of side has closed again; value: motor, m */
};

struct walk_event {
    enum walk_event_kind kind;
    enum side side;
    double time_s;
    double value;
};

/* One step: single support of the stance leg with its apex, the other foot's heel
 * strike, the stance leg's push-off. Handed out at its lift-off. */
struct walk_step {
    uint64_t index;   /* 1 is the first step after letting go */
    enum side stance; /* side of the stance leg at the apex */
    double apex_time_s, apex_speed_rad_s;
    double apex_theta_n_rad, apex_theta_n_rate_rad_s;
    double heel_strike_time_s; /* ends single support of this step */
    double release_time_s;     /* NaN-free: 0 when the spring was not released */
    double precompression_m;   /* motor position at release, 0 without */
    double lift_off_time_s;
    double lift_off_extension_m;
    double step_length_m; /* toe to toe at heel strike */
    double collision_loss_J;
    double push_off_J;           /* work of the device on the walker */
    double own_push_J;           /* work of the own push-off */
    double energy_J;             /* walker, kinetic + potential above the stance toe, at the apex */
    double least_normal_force_N; /* smallest vertical ground force at a tick of the step */
    double
        friction_needed; /* largest |horizontal / vertical| of a foot with 5 % of the weight on it */
};

enum { WALK_EVENT_RING = 64, WALK_STEP_RING = 8 };

struct walk {
    struct walk_params params;
    enum walk_phase phase;
    enum walk_fault fault;
    double time_s;
    enum side stance;
    struct walker3_state state;
    struct walker3_contact contact;
    double foot_m[2];     /* world position of the stance toe */
    double next_height_m; /* ground of the next foothold relative to the slope through this one */
    double phase_since_s;
    bool own_push_active; /* the own push-off, from heel strike to lift-off */
    bool foot_was_above;  /* swing toe has been above the ground, ahead: may land */
    struct walk_step current;
    struct walk_event events[WALK_EVENT_RING];
    struct walk_step steps[WALK_STEP_RING];
    uint64_t events_written, events_read, events_lost;
    uint64_t steps_written, steps_read, steps_lost;
    /* cumulative */
    double collision_loss_J, own_work_J, device_work_J[SIDE_COUNT];
};

/* Angles and rates of the pose that is held. */
struct walk_pose {
    enum side stance;
    double theta_s_rad, theta_n_rad;
    double theta_s_rate_rad_s, theta_n_rate_rad_s;
};

void walk_params_default(const struct walker3_params *body, struct walk_params *params);
/* NULL if every field is in range, else the name of the first that is not. */
const char *walk_params_check(const struct walk_params *params);

/* Held in pose at time 0. Params have passed walk_params_check(). */
void walk_init(struct walk *walk, const struct walk_params *params, const struct walk_pose *pose);
/* Holds the walker in pose again: the fault is cleared, the step count goes on. */
void walk_hold(struct walk *walk, const struct walk_pose *pose);
/* Ends the hold: single support with the pose's rates from now on. No effect unless held. */
void walk_let_go(struct walk *walk);

/* Advances walker and both SEAs (indexed by side) by duration_s (one tick, a whole
 * number of drive periods of either SEA, which must be equal). Never fails: a
 * fault is in walk->fault; the SEAs run on in every phase. */
void walk_advance(struct walk *walk, struct sea sea[SIDE_COUNT], double duration_s);

/* Impulse on the torso (N s; x is backward, -x forward, y up), takes effect at
 * once. No effect while held or down. */
void walk_push(struct walk *walk, const double impulse_Ns[2]);

/* Ground of the next foothold above the slope line through the present one. */
void walk_set_next_height(struct walk *walk, double height_m);

double walk_leg_angle_rad(const struct walk *walk, enum side side);
double walk_leg_rate_rad_s(const struct walk *walk, enum side side);
/* Ankle extension: r of the stance leg; of the swing leg what the latch and the motor leave. */
double walk_ankle_m(const struct walk *walk, const struct sea sea[SIDE_COUNT], enum side side);
double walk_ankle_rate_m_s(const struct walk *walk, const struct sea sea[SIDE_COUNT],
                           enum side side);
bool walk_on_ground(const struct walk *walk, enum side side);
/* Ground forces (N, x and y) per side, and the force that locks the stance ankle. */
void walk_forces(const struct walk *walk, const struct sea sea[SIDE_COUNT],
                 double ground_N[SIDE_COUNT][2], double *ankle_lock_N);
/* Kinetic + potential energy above world height 0 (J). */
double walk_energy_J(const struct walk *walk);

/* Oldest unread event or finished step; false if there is none. The rings drop the
 * oldest when full and count what was lost. */
bool walk_next_event(struct walk *walk, struct walk_event *event);
bool walk_next_step(struct walk *walk, struct walk_step *step);

#endif
