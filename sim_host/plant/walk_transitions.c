/* Transitions between the phases: the swing foot lands, the trailing foot leaves the ground. */
#include "sim_host/plant/walk_internal.h"

void walk_heel_strike(struct walk_run *run)
{
    struct walk *walk = run->walk;
    const enum side landing = walk_swing_side(walk);
    struct sea *sea = &run->sea[walk->stance];
    struct walker3_impact impact;
    double toe_m[2];
    walk->contact.swing_extension_m = walk_foot_extension_m(
        &run->sea[landing], sea_position_at_m(&run->sea[landing], run->tau_s));
    walker3_toe(&walk->params.body, &walk->state, walk->contact.swing_extension_m, toe_m);
    walker3_collide(&walk->params.body, &walk->state, walk->contact.swing_extension_m, &impact);
    walk->contact.swing_toe_pinned = true;
    walk->phase = WALK_DOUBLE;
    walk->phase_since_s = walk->time_s;
    walk->own_push_active = walk->params.own_push_N_per_m > 0.0;
    walk->collision_loss_J += impact.lost_J;
    walk->current.collision_loss_J = impact.lost_J;
    walk->current.heel_strike_time_s = walk->time_s;
    walk->current.step_length_m = __builtin_sqrt(toe_m[0] * toe_m[0] + toe_m[1] * toe_m[1]);
    walk_post(walk, WALK_EVENT_HEEL_STRIKE, landing, walk->time_s, walk->current.step_length_m);
    sea_other_foot_contact(sea, walk->time_s);
}

void walk_leave_ground(struct walk_run *run)
{
    struct walk *walk = run->walk;
    const enum side leaving = walk->stance;
    const double extension_m = walk->contact.swing_extension_m;
    double toe_m[2];
    walk->current.lift_off_time_s = walk->time_s;
    walk->current.lift_off_extension_m = walk->state.q[WALKER3_ANKLE];
    walk_post(walk, WALK_EVENT_LIFT_OFF, leaving, walk->time_s, walk->state.q[WALKER3_ANKLE]);
    walker3_toe(&walk->params.body, &walk->state, extension_m, toe_m);
    walk->foot_m[0] += toe_m[0];
    walk->foot_m[1] += toe_m[1];
    walker3_swap_legs(&walk->state, extension_m);
    walk->stance = side_other(leaving);
    walk->contact = (struct walker3_contact){.ankle_locked = true};
    walk->phase = WALK_SINGLE;
    walk->phase_since_s = walk->time_s;
    walk->own_push_active = false;
    walk->next_height_m = 0.0;
    sea_lift_off(&run->sea[leaving]);
    walk_finish_step(walk);
}
