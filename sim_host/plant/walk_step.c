/* One step of the integrator, and landing on what happens inside it. */
#include <stddef.h>

#include "sim_host/plant/walk_internal.h"

static const double PI = 3.14159265358979323846;

/* A foot counts as ahead from this share of the leg on: where the legs pass each
 * other the toe's height is zero whatever the walk does. */
static const double AHEAD_RATIO = 1e-3;

/* The stance foot may be so far (share of the leg) off the ground before it is flight. */
static const double FLIGHT_RATIO = 0.02;

/* Bisections of one drive period reach the last bit within 60. */
enum { ROOT_ITERATIONS = 80 };

/* Quantities that are positive before their event and fall through zero at it. */
typedef double event_value(const struct walk_run *run, const struct walker3_state *state,
                           double tau_s);

static const struct sea *stance_sea(const struct walk_run *run)
{
    return &run->sea[run->walk->stance];
}

static double swing_extension_at(const struct walk_run *run, double tau_s)
{
    const struct sea *sea = &run->sea[walk_swing_side(run->walk)];
    return walk_foot_extension_m(sea, sea_position_at_m(sea, tau_s));
}

static double until_strike(const struct walk_run *run, const struct walker3_state *state,
                           double tau_s)
{
    double gap_m, ahead_m;
    walk_toe_gap(run->walk, state, swing_extension_at(run, tau_s), &gap_m, &ahead_m);
    return gap_m;
}

static double until_fallen(const struct walk_run *run, const struct walker3_state *state,
                           double tau_s)
{
    const double angle_rad = state->q[WALKER3_STANCE];
    (void)tau_s;
    return run->walk->params.fall_angle_rad - (angle_rad < 0.0 ? -angle_rad : angle_rad);
}

static double until_apex(const struct walk_run *run, const struct walker3_state *state,
                         double tau_s)
{
    (void)run;
    (void)tau_s;
    return state->q[WALKER3_STANCE];
}

static double until_heel_down(const struct walk_run *run, const struct walker3_state *state,
                              double tau_s)
{
    (void)run;
    (void)tau_s;
    return state->q[WALKER3_ANKLE];
}

static double until_extended(const struct walk_run *run, const struct walker3_state *state,
                             double tau_s)
{
    (void)tau_s;
    return stance_sea(run)->params.extension_trigger_m - state->q[WALKER3_ANKLE];
}

static double until_lift_off(const struct walk_run *run, const struct walker3_state *state,
                             double tau_s)
{
    const struct walk *walk = run->walk;
    const struct sea *sea = stance_sea(run);
    const double extension_m = state->q[WALKER3_ANKLE];
    const double own_m = walk->params.own_push_rest_m - extension_m;
    double device_m = -1.0;
    if (sea->latch != SEA_LATCH_CLOSED) {
        device_m = sea_position_at_m(sea, tau_s) - extension_m;
    }
    return walk->own_push_active && own_m > device_m ? own_m : device_m;
}

struct landing {
    double at_s; /* after the start of the step */
    struct walker3_state state;
};

/* Root of value() inside a step, by the Illinois variant of the false position:
 * every trial is one step of the integrator from the step's start, so what is
 * landed is a point of the very trajectory. */
static void land(const struct walk_run *run, const struct walker3_ankle *ankle, double step_s,
                 event_value *value, double from, double to, struct landing *landing)
{
    const struct walk *walk = run->walk;
    double low_s = 0.0, high_s = step_s, low = from, high = to;
    int last_side = 0;
    for (int i = 0; i < ROOT_ITERATIONS; i++) {
        double at_s = low_s + (high_s - low_s) * (low / (low - high));
        if (!(at_s > low_s && at_s < high_s)) {
            break; /* neighbours: the step of the time is reached */
        }
        walker3_step(&walk->params.body, &walk->state, &walk->contact, ankle, run->tau_s, at_s,
                     &landing->state);
        const double now = value(run, &landing->state, run->tau_s + at_s);
        if (now > 0.0) {
            low_s = at_s;
            low = now;
            high *= last_side == 1 ? 0.5 : 1.0;
            last_side = 1;
        } else {
            high_s = at_s;
            high = now;
            low *= last_side == -1 ? 0.5 : 1.0;
            last_side = -1;
            if (now == 0.0) {
                break;
            }
        }
        if (high_s - low_s < 1e-15) {
            break;
        }
    }
    landing->at_s = high_s;
    walker3_step(&walk->params.body, &walk->state, &walk->contact, ankle, run->tau_s, high_s,
                 &landing->state);
}

/* If value() falls through zero before *landing, *landing becomes that moment. */
static bool lands_first(const struct walk_run *run, const struct walker3_ankle *ankle,
                        double step_s, const struct walker3_state *next, event_value *value,
                        struct landing *landing)
{
    const double from = value(run, &run->walk->state, run->tau_s);
    const double to = value(run, next, run->tau_s + step_s);
    struct landing found;
    if (!(from > 0.0 && to <= 0.0)) {
        return false;
    }
    land(run, ankle, step_s, value, from, to, &found);
    if (found.at_s > landing->at_s) {
        return false;
    }
    *landing = found;
    return true;
}

enum happening { NOTHING, STRIKE, FALL, HEEL_DOWN, LIFT_OFF, EXTENDED };

static double between_legs_rad(const struct walker3_state *state)
{
    return state->q[WALKER3_STANCE] - state->q[WALKER3_SWING];
}

/* Whether the swing foot may touch down in the step that ends in *next. It swings
 * back by then: while theta_s + theta_n still rises it is only passing the stance
 * foot, and what the toe does there is the scuff that is ignored. */
static bool may_strike(const struct walk_run *run, const struct walker3_state *next, double tau_s)
{
    const struct walk *walk = run->walk;
    double gap_m, ahead_m;
    if (!walk->foot_was_above || next->q[WALKER3_STANCE] >= 0.0 ||
        next->dq[WALKER3_STANCE] + next->dq[WALKER3_SWING] >= 0.0) {
        return false;
    }
    walk_toe_gap(walk, next, swing_extension_at(run, tau_s), &gap_m, &ahead_m);
    return gap_m <= 0.0 && ahead_m > AHEAD_RATIO * walk->params.body.leg_length_m;
}

static enum happening first_event(struct walk_run *run, const struct walker3_ankle *ankle,
                                  double step_s, const struct walker3_state *next,
                                  struct landing *landing)
{
    const struct walk *walk = run->walk;
    const struct sea *sea = stance_sea(run);
    enum happening first = NOTHING;
    if (lands_first(run, ankle, step_s, next, until_fallen, landing)) {
        first = FALL;
    }
    if (!walk->contact.ankle_locked) {
        if (lands_first(run, ankle, step_s, next, until_heel_down, landing)) {
            first = HEEL_DOWN;
        }
        if (sea_may_release(sea) && !sea->release_pending &&
            lands_first(run, ankle, step_s, next, until_extended, landing)) {
            first = EXTENDED;
        }
        if (walk->phase == WALK_DOUBLE &&
            (sea->latch != SEA_LATCH_CLOSED || walk->own_push_active) &&
            lands_first(run, ankle, step_s, next, until_lift_off, landing)) {
            first = LIFT_OFF;
        }
    }
    if (walk->phase == WALK_SINGLE && may_strike(run, next, run->tau_s + step_s) &&
        lands_first(run, ankle, step_s, next, until_strike, landing)) {
        first = STRIKE;
    }
    return first;
}

static void note_apex(struct walk_run *run, const struct walker3_ankle *ankle, double step_s,
                      const struct walker3_state *next)
{
    struct landing apex = {.at_s = step_s};
    if (run->walk->phase == WALK_SINGLE &&
        lands_first(run, ankle, step_s, next, until_apex, &apex)) {
        walk_record_apex(run->walk, run->walk->time_s + apex.at_s, &apex.state);
    }
}

/* Work of both pushes over the step, by the trapezoid of force times rate. */
static void account_work(struct walk_run *run, const struct walker3_ankle *ankle,
                         const struct walker3_state *next, double step_s)
{
    struct walk *walk = run->walk;
    struct walker3_ankle device = *ankle, own = *ankle;
    if (walk->contact.ankle_locked) {
        return;
    }
    device.own_N_per_m = 0.0;
    own.device_N_per_m = 0.0;
    const double r0 = walk->state.q[WALKER3_ANKLE], r1 = next->q[WALKER3_ANKLE];
    const double v0 = walk->state.dq[WALKER3_ANKLE], v1 = next->dq[WALKER3_ANKLE];
    const double t0 = run->tau_s, t1 = run->tau_s + step_s;
    const double device_J =
        0.5 * step_s *
        (walker3_ankle_force_N(&device, t0, r0) * v0 + walker3_ankle_force_N(&device, t1, r1) * v1);
    const double own_J =
        0.5 * step_s *
        (walker3_ankle_force_N(&own, t0, r0) * v0 + walker3_ankle_force_N(&own, t1, r1) * v1);
    walk->device_work_J[walk->stance] += device_J;
    walk->own_work_J += own_J;
    walk->current.push_off_J += device_J;
    walk->current.own_push_J += own_J;
}

static bool is_finite(const struct walker3_state *state)
{
    double sum = 0.0;
    for (int i = 0; i < WALKER3_DOF; i++) {
        sum += state->q[i] + state->dq[i];
    }
    return sum - sum == 0.0;
}

static void handle(struct walk_run *run, enum happening happening)
{
    struct walk *walk = run->walk;
    switch (happening) {
    case NOTHING:
        break;
    case STRIKE:
        walk_heel_strike(run);
        break;
    case FALL:
        walk_fail(walk, walk->state.q[WALKER3_STANCE] < 0.0 ? WALK_FAULT_FALLEN_FORWARD
                                                            : WALK_FAULT_FALLEN_BACKWARD);
        break;
    case HEEL_DOWN:
        walk->state.q[WALKER3_ANKLE] = 0.0;
        walker3_lock_ankle(&walk->params.body, &walk->state, &walk->contact);
        break;
    case LIFT_OFF:
        walk_leave_ground(run);
        break;
    case EXTENDED:
        sea_ankle_extends(&run->sea[walk->stance], walk->time_s);
        break;
    }
}

/* What ends a walk without an event of its own. */
static void check_ending(struct walk_run *run, double legs_before_rad)
{
    struct walk *walk = run->walk;
    const struct walker3_state *state = &walk->state;
    const struct sea *sea = stance_sea(run);
    const double length_m = walk->params.body.leg_length_m;
    const double legs_rad = between_legs_rad(state);
    if (walk->phase == WALK_DOWN) {
        return;
    }
    if (legs_rad > PI || legs_rad < -PI) {
        walk_fail(walk, WALK_FAULT_LEGS_CROSSED);
    } else if (walk->phase == WALK_SINGLE) {
        if (state->q[WALKER3_STANCE] > 0.0 && state->dq[WALKER3_STANCE] >= 0.0) {
            walk_fail(walk, WALK_FAULT_BACKWARDS);
        } else if (legs_before_rad > 0.0 && legs_rad <= 0.0 &&
                   swing_extension_at(run, run->tau_s) > walk->params.trip_extension_m) {
            walk_fail(walk, WALK_FAULT_TRIPPED);
        } else if (sea->latch != SEA_LATCH_CLOSED && !walk->contact.ankle_locked &&
                   state->q[WALKER3_ANKLE] - sea_position_at_m(sea, run->tau_s) >
                       FLIGHT_RATIO * length_m) {
            walk_fail(walk, WALK_FAULT_FLIGHT);
        }
    }
}

/* The foot may land only after it has been above the ground, ahead of the body. */
static void watch_foot(struct walk_run *run)
{
    struct walk *walk = run->walk;
    double gap_m, ahead_m;
    if (walk->phase != WALK_SINGLE || between_legs_rad(&walk->state) >= 0.0) {
        walk->foot_was_above = false;
        return;
    }
    walk_toe_gap(walk, &walk->state, swing_extension_at(run, run->tau_s), &gap_m, &ahead_m);
    walk->foot_was_above = gap_m > 0.0;
}

double walk_step_once(struct walk_run *run, double step_s)
{
    struct walk *walk = run->walk;
    struct walker3_ankle ankle;
    struct landing landing = {.at_s = step_s};
    const double legs_before_rad = between_legs_rad(&walk->state);
    walk_ankle_spring(walk, stance_sea(run), &ankle);
    walker3_step(&walk->params.body, &walk->state, &walk->contact, &ankle, run->tau_s, step_s,
                 &landing.state);
    if (!is_finite(&landing.state)) {
        walk_fail(walk, WALK_FAULT_NOT_FINITE);
        return step_s;
    }
    const struct walker3_state next = landing.state;
    const enum happening happening = first_event(run, &ankle, step_s, &next, &landing);
    note_apex(run, &ankle, landing.at_s, &landing.state);
    account_work(run, &ankle, &landing.state, landing.at_s);
    walk->state = landing.state;
    walk->time_s += landing.at_s;
    run->tau_s += landing.at_s;
    const enum side stance = walk->stance;
    handle(run, happening);
    if (walk->stance == stance) {
        check_ending(run, legs_before_rad);
    }
    watch_foot(run);
    return landing.at_s;
}
