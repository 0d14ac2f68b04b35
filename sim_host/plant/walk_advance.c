/* The walk in time: which step of the integrator is next, and how long it may be. */
#include <stddef.h>

#include "sim_host/plant/walk_internal.h"

/* Two moments closer than this are one. */
static const double SAME_TIME_S = 1e-12;

/* Steps within one drive period: more than a walk can need; then it has hung up. */
enum { SPAN_STEPS = 2000 };

/* Would the ankle extend by itself if nothing held it? */
static bool ankle_rises(const struct walk_run *run)
{
    const struct walk *walk = run->walk;
    struct walker3_contact unlocked = walk->contact;
    struct walker3_ankle ankle;
    double ddq[WALKER3_DOF];
    unlocked.ankle_locked = false;
    walk_ankle_spring(walk, &run->sea[walk->stance], &ankle);
    walker3_accelerate(&walk->params.body, &walk->state, &unlocked,
                       walker3_ankle_force_N(&ankle, run->tau_s, walk->state.q[WALKER3_ANKLE]), ddq,
                       NULL);
    return ddq[WALKER3_ANKLE] > 0.0;
}

/* Heel on the ground or ankle free. */
static void choose_contact(struct walk_run *run)
{
    struct walk *walk = run->walk;
    const bool resting =
        walk->state.q[WALKER3_ANKLE] <= 0.0 && walk->state.dq[WALKER3_ANKLE] <= 0.0;
    const bool latched = run->sea[walk->stance].latch == SEA_LATCH_CLOSED;
    if (walk->phase == WALK_SINGLE && latched && walk->state.q[WALKER3_ANKLE] <= 0.0) {
        walk->contact.ankle_locked = true;
    } else {
        walk->contact.ankle_locked = resting && !ankle_rises(run);
    }
    if (walk->contact.ankle_locked && walk->state.dq[WALKER3_ANKLE] != 0.0) {
        walk->state.q[WALKER3_ANKLE] = 0.0;
        walker3_lock_ankle(&walk->params.body, &walk->state, &walk->contact);
    }
}

static void release_due(struct walk_run *run, enum side side)
{
    struct walk *walk = run->walk;
    struct sea *sea = &run->sea[side];
    const bool due = sea->release_pending && sea->release_time_s <= walk->time_s + SAME_TIME_S;
    const double motor_m = sea_position_at_m(sea, run->tau_s);
    if ((!due && !sea_lets_go(sea)) || !sea_release_now(sea)) {
        return;
    }
    walk_post(walk, WALK_EVENT_RELEASE, side, walk->time_s, motor_m);
    if (side == walk->stance && walk->phase != WALK_HELD) {
        walk->current.release_time_s = walk->time_s;
        walk->current.precompression_m = motor_m;
    } else {
        sea_lift_off(sea); /* nothing to push against: the foot flies out to its motor */
    }
}

/* Nothing pushes any more, or nothing will. */
static bool double_support_over(const struct walk_run *run)
{
    const struct walk *walk = run->walk;
    const struct sea *sea = &run->sea[walk->stance];
    const double extension_m = walk->state.q[WALKER3_ANKLE];
    const bool own = walk->own_push_active && walk->params.own_push_rest_m > extension_m;
    if (sea->latch != SEA_LATCH_CLOSED) {
        return !own && sea_position_at_m(sea, run->tau_s) <= extension_m;
    }
    return !own && !sea_may_release(sea) &&
           walk->time_s - walk->phase_since_s >= walk->params.unarmed_hold_s - SAME_TIME_S;
}

/* Everything that happens at this instant, before time goes on. */
static void settle(struct walk_run *run)
{
    struct walk *walk = run->walk;
    struct sea *sea = &run->sea[walk->stance];
    for (int side = 0; side < SIDE_COUNT; side++) {
        release_due(run, (enum side)side);
    }
    if (walk->phase == WALK_DOUBLE) {
        if (sea_may_release(sea) && !sea->release_pending &&
            walk->state.q[WALKER3_ANKLE] > sea->params.extension_trigger_m) {
            sea_ankle_extends(sea, walk->time_s);
        }
        if (double_support_over(run)) {
            walk_leave_ground(run);
        } else if (walk->time_s - walk->phase_since_s > walk->params.stuck_s) {
            walk_fail(walk, WALK_FAULT_STUCK);
        }
    }
    if (walk->phase != WALK_DOWN) {
        choose_contact(run);
    }
}

/* Largest step from here that does not jump over a moment known beforehand. */
static double bounded_step_s(const struct walk_run *run, double step_s)
{
    const struct walk *walk = run->walk;
    for (int side = 0; side < SIDE_COUNT; side++) {
        const double until_s = run->sea[side].release_time_s - walk->time_s;
        if (run->sea[side].release_pending && until_s < step_s) {
            step_s = until_s;
        }
    }
    if (walk->phase == WALK_DOUBLE) {
        const double until_s = walk->phase_since_s + walk->params.unarmed_hold_s - walk->time_s;
        if (until_s > SAME_TIME_S && until_s < step_s) {
            step_s = until_s;
        }
    }
    return step_s;
}

static bool is_moving(const struct walk *walk)
{
    return walk->phase == WALK_SINGLE || walk->phase == WALK_DOUBLE;
}

/* Integrates over the rest of a drive period, with the motors' motion known. */
static void span(struct walk_run *run, double tau_end_s)
{
    struct walk *walk = run->walk;
    for (int i = 0; i < SPAN_STEPS && tau_end_s - run->tau_s > SAME_TIME_S; i++) {
        settle(run);
        if (!is_moving(walk)) {
            return;
        }
        const double left_s = tau_end_s - run->tau_s;
        const double limit_s = walk->params.double_step_s;
        (void)walk_step_once(run, bounded_step_s(run, left_s < limit_s ? left_s : limit_s));
        if (!is_moving(walk)) {
            return;
        }
    }
}

/* Single support that no SEA touches. Returns the time that passed. */
static double coast(struct walk_run *run, double step_s)
{
    const double limit_s = run->walk->params.single_step_s;
    run->walk->contact.ankle_locked = true;
    return walk_step_once(run, step_s < limit_s ? step_s : limit_s);
}

/* Does an actuator touch the walker's motion, or its foot the ground, right now? */
static bool is_coupled(const struct walk_run *run)
{
    const struct walk *walk = run->walk;
    const struct sea *stance = &run->sea[walk->stance];
    const struct sea *swing = &run->sea[walk_swing_side(walk)];
    if (walk->phase == WALK_DOUBLE || stance->latch != SEA_LATCH_CLOSED ||
        walk->state.q[WALKER3_ANKLE] > 0.0) {
        return true;
    }
    if (stance->release_pending || swing->release_pending || sea_lets_go(stance) ||
        sea_lets_go(swing)) {
        return true;
    }
    return swing->latch != SEA_LATCH_CLOSED &&
           walk->state.q[WALKER3_STANCE] <= walk->state.q[WALKER3_SWING];
}

/* Begins the next drive period of both SEAs. */
static void open_period(struct walk_run *run, double at_s)
{
    struct walk *walk = run->walk;
    for (int i = 0; i < SIDE_COUNT; i++) {
        const enum side side = (enum side)i;
        struct sea *sea = &run->sea[side];
        if (!is_moving(walk)) {
            release_due(run, side);
            sea_lift_off(sea);
        }
        const double ankle_m = walk_ankle_m(walk, run->sea, side);
        const bool landed = walk_on_ground(walk, side) && is_moving(walk);
        if ((!landed || ankle_m <= 0.0) && sea_reclose(sea, ankle_m)) {
            walk_post(walk, WALK_EVENT_RECLOSED, side, at_s, sea->position_m);
        }
        sea_drive_period(sea, ankle_m);
    }
}

static void finish_period(struct walk_run *run)
{
    for (int side = 0; side < SIDE_COUNT; side++) {
        sea_finish_period(&run->sea[side]);
    }
}

/* A foot that carries less than this share of the weight may slide unnoticed: as it
 * leaves the ground the quotient of its two vanishing forces means nothing. */
static const double CARRYING_RATIO = 0.05;

/* What each step's record says about the ground. */
static void watch_ground(struct walk *walk, const struct sea sea[SIDE_COUNT])
{
    double ground_N[SIDE_COUNT][2], lock_N;
    struct walk_step *step = &walk->current;
    const struct walker3_params *body = &walk->params.body;
    const double weight_N = (body->hip_mass_kg + 2.0 * body->leg_mass_kg) * body->gravity_m_s2;
    if (!is_moving(walk)) {
        return;
    }
    walk_forces(walk, sea, ground_N, &lock_N);
    for (int side = 0; side < SIDE_COUNT; side++) {
        if (!walk_on_ground(walk, (enum side)side)) {
            continue;
        }
        const double along_N = ground_N[side][0] < 0.0 ? -ground_N[side][0] : ground_N[side][0];
        const double normal_N = ground_N[side][1];
        if (step->least_normal_force_N == 0.0 || normal_N < step->least_normal_force_N) {
            step->least_normal_force_N = normal_N;
        }
        if (normal_N < CARRYING_RATIO * weight_N) {
            continue;
        }
        if (along_N > step->friction_needed * normal_N) {
            step->friction_needed = along_N / normal_N;
        }
        if (walk->params.friction > 0.0 && along_N > walk->params.friction * normal_N) {
            walk_fail(walk, WALK_FAULT_SLIPPED);
            return;
        }
    }
}

void walk_advance(struct walk *walk, struct sea sea[SIDE_COUNT], double duration_s)
{
    struct walk_run run = {.walk = walk, .sea = sea};
    const double start_s = walk->time_s;
    const double period_s = sea[0].params.drive_period_s;
    const int periods = (int)(duration_s / period_s + 0.5);
    int opened = 0;
    double done_s = 0.0;
    while (done_s < duration_s - SAME_TIME_S && is_moving(walk)) {
        if (!is_coupled(&run)) {
            run.tau_s = 0.0;
            done_s += coast(&run, duration_s - done_s);
            continue;
        }
        int index = (int)(done_s / period_s);
        if (done_s - (index + 1) * period_s > -SAME_TIME_S) {
            index++;
        }
        while (opened <= index) {
            if (opened > 0) {
                finish_period(&run);
            }
            open_period(&run, start_s + opened * period_s);
            opened++;
        }
        run.tau_s = done_s - index * period_s;
        span(&run, period_s);
        done_s = (index + 1) * period_s;
        walk->time_s = start_s + done_s;
    }
    walk->time_s = start_s + duration_s;
    while (opened < periods) {
        if (opened > 0) {
            finish_period(&run);
        }
        open_period(&run, start_s + opened * period_s);
        opened++;
    }
    finish_period(&run);
    watch_ground(walk, sea);
}
