/* What the parts of walk.c share; nobody else includes this. */
#ifndef SIM_HOST_PLANT_WALK_INTERNAL_H
#define SIM_HOST_PLANT_WALK_INTERNAL_H

#include "sim_host/plant/walk.h"

/* A moment inside an advance: the walk, both SEAs, and where their clocks stand. */
struct walk_run {
    struct walk *walk;
    struct sea *sea;
    double tau_s; /* since the start of the SEAs' current drive period */
};

static inline enum side walk_swing_side(const struct walk *walk)
{
    return side_other(walk->stance);
}

/* Height of the swing toe above the ground it may land on, and how far it is ahead
 * of the stance toe (both m). */
void walk_toe_gap(const struct walk *walk, const struct walker3_state *state,
                  double swing_extension_m, double *gap_m, double *ahead_m);

/* Extension of the swing foot when its motor stands at motor_m. */
double walk_foot_extension_m(const struct sea *sea, double motor_m);

/* The ankle force of the stance leg, on the clock of the current drive period. */
void walk_ankle_spring(const struct walk *walk, const struct sea *sea, struct walker3_ankle *ankle);

/* One step of the integrator under walk->contact, of at most step_s, cut short by
 * the first event, which is handled. Returns the time that passed. */
double walk_step_once(struct walk_run *run, double step_s);

/* Transitions: the swing foot lands, now; the trailing foot leaves the ground, now. */
void walk_heel_strike(struct walk_run *run);
void walk_leave_ground(struct walk_run *run);

/* Records; these change nothing but phase, fault, events and the current step. */
void walk_fail(struct walk *walk, enum walk_fault fault);
void walk_record_apex(struct walk *walk, double time_s, const struct walker3_state *state);
void walk_post(struct walk *walk, enum walk_event_kind kind, enum side side, double time_s,
               double value);
void walk_finish_step(struct walk *walk);

#endif
