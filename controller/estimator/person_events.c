#include "controller/estimator/person_events.h"

/* A strike's time follows from the times at which the smoothed rate goes through two levels
 * (ratios of walking_speed): event = second + reach * (second - first) + after. The leg slows
 * from 0 to -0.6; at that pace it would soon have the planted foot's rate of -1. Reach has no
 * unit, so the rule serves fast and slow walkers. Reach and after are one calibration for all
 * people, against recorded foot contacts. */
#define STRIKE_FIRST_RATIO REAL(0.0)
#define STRIKE_SECOND_RATIO REAL(-0.6)
#define STRIKE_REACH REAL(0.5)
#define STRIKE_AFTER_S REAL(0.006)

/* Toe-off: the rate has risen to this ratio of walking_speed, the leg swings forwards;
 * the foot has left the ground so long before that, and before the mean of that and
 * the end of the ankle's push. The one calibration for all people, as above. */
#define TOE_OFF_RATIO REAL(0.3)
#define TOE_OFF_BEFORE_TURN_S REAL(0.0145)
#define TOE_OFF_BEFORE_BOTH_S REAL(0.019)

/* The ankle's highest rate in a push, in walking speeds; about 0.35 is usual. */
#define PUSH_LEAST_RATIO REAL(0.08)
/* A turn and an end of a push further apart than this do not belong together; and so
 * long after the turn an event is not held back for the ankle. */
#define PUSH_APART_S REAL(0.08)
#define PUSH_WAIT_S REAL(0.03)

/* The turn is quick; a first crossing longer ago than this belongs to something else. */
#define TURN_MAX_S REAL(0.2)

/* A step's swing is faster than its stance (the foot catches up with the hip and
 * overtakes it); half of walking_speed distinguishes it from a sway. */
#define SWING_RATIO REAL(0.5)
#define STILL_RATIO REAL(0.1)
/* Legs closer together than this are side by side: 8 cm on a 0.9 m leg. */
#define APART_RAD REAL(0.09)
#define SWING_MAX_S REAL(1.5)
#define STILL_S REAL(0.35)

#define HALF_WINDOW_S ((real)LEG_RATE_HALF_WINDOW * CONTROL_PERIOD_S)

real person_events_rate(const real angle_rad[GAIT_HISTORY], uint32_t centre_tick)
{
    /* Twice the sum of n^2 over the half window, a whole number. */
    enum {
        SQUARES =
            LEG_RATE_HALF_WINDOW * (LEG_RATE_HALF_WINDOW + 1) * (2 * LEG_RATE_HALF_WINDOW + 1) / 3
    };
    real sum = REAL(0.0);
    for (uint32_t n = 1; n <= LEG_RATE_HALF_WINDOW; n++) {
        sum += (real)n * (angle_rad[(centre_tick + n) % (uint32_t)GAIT_HISTORY] -
                          angle_rad[(centre_tick - n) % (uint32_t)GAIT_HISTORY]);
    }
    return sum / ((real)SQUARES * CONTROL_PERIOD_S);
}

static void enter(struct person_events *leg, enum leg_contact contact, uint32_t tick)
{
    leg->contact = contact;
    leg->since_tick = tick;
    leg->turned = false;
    leg->swung = false;
    leg->landing = false;
}

/* Ticks from `tick` back to where the rate went through level, from the last tick's
 * rate to this one's. */
static real crossing_ticks_ago(const struct person_events *leg, real rate, real level)
{
    const real change = rate - leg->rate_before_rad_s;
    return change != REAL(0.0) ? real_clamp((rate - level) / change, REAL(0.0), REAL(1.0))
                               : REAL(0.0);
}

static bool falls_through(const struct person_events *leg, real rate, real level)
{
    return leg->rate_before_rad_s > level && rate <= level;
}

static bool rises_through(const struct person_events *leg, real rate, real level)
{
    return leg->rate_before_rad_s < level && rate >= level;
}

static void mark_first(struct person_events *leg, real rate, real level, uint32_t tick)
{
    leg->first_tick = tick;
    leg->first_before_ticks = crossing_ticks_ago(leg, rate, level);
}

/* The second level is crossed now: age of the event placed by both. */
static real age_of(const struct person_events *leg, real rate, real level, real reach, real after_s,
                   uint32_t tick)
{
    const real ago = crossing_ticks_ago(leg, rate, level);
    const real between = (real)(tick - leg->first_tick) + leg->first_before_ticks - ago;
    const real longest = TURN_MAX_S * (real)CONTROL_RATE_HZ;
    const real shift = reach * real_clamp(between, REAL(0.0), longest);
    return HALF_WINDOW_S + (ago - shift) * CONTROL_PERIOD_S - after_s;
}

static void in_stance(struct person_events *leg, const struct leg_view *view, uint32_t tick)
{
    const real rate = view->rate_rad_s;
    const real level = TOE_OFF_RATIO * view->walking_speed_rad_s;
    if (rises_through(leg, rate, level) && view->ahead_rad < -APART_RAD) {
        mark_first(leg, rate, level, tick);
        enter(leg, LEG_SWING, tick);
        leg->turned = true;
    } else if (rate > SWING_RATIO * view->walking_speed_rad_s) {
        enter(leg, LEG_SWING, tick); /* a first step: from beside the other foot */
    }
}

/* The leg has turned: its toe-off, as soon as the ankle's part in it is known. */
static struct leg_event place_toe_off(struct person_events *leg, real least_1_s, uint32_t tick)
{
    const struct leg_event nothing = {LEG_EVENT_NONE, REAL(0.0)};
    const real since_turn_s =
        seconds_since(tick, leg->first_tick) + leg->first_before_ticks * CONTROL_PERIOD_S;
    if (!leg->turned ||
        (ankle_push_under_way(&leg->push, least_1_s) && since_turn_s < PUSH_WAIT_S)) {
        return nothing;
    }
    const real turn_age_s = HALF_WINDOW_S + since_turn_s;
    const real push_age_s = seconds_since(tick, leg->push.over_tick) + ANKLE_PUSH_LAG_S;
    leg->turned = false;
    if (leg->push.over && real_abs(push_age_s - turn_age_s) < PUSH_APART_S) {
        return (struct leg_event){LEG_EVENT_TOE_OFF,
                                  REAL(0.5) * (turn_age_s + push_age_s) + TOE_OFF_BEFORE_BOTH_S};
    }
    return (struct leg_event){LEG_EVENT_TOE_OFF, turn_age_s + TOE_OFF_BEFORE_TURN_S};
}

static struct leg_event in_swing(struct person_events *leg, const struct leg_view *view,
                                 uint32_t tick)
{
    const real rate = view->rate_rad_s;
    const real level = STRIKE_SECOND_RATIO * view->walking_speed_rad_s;
    const real first = STRIKE_FIRST_RATIO * view->walking_speed_rad_s;
    struct leg_event event = {LEG_EVENT_NONE, REAL(0.0)};
    if (rate > SWING_RATIO * view->walking_speed_rad_s) {
        leg->swung = true;
    }
    leg->landing =
        leg->swung && view->ahead_rad > APART_RAD && rate < SWING_RATIO * view->walking_speed_rad_s;
    if (falls_through(leg, rate, first)) {
        mark_first(leg, rate, first, tick);
    }
    if (rate <= level) {
        /* Without a swing, or with the foot still behind, it was a step given up. */
        if (leg->swung && view->ahead_rad > APART_RAD) {
            event = (struct leg_event){
                LEG_EVENT_STRIKE, age_of(leg, rate, level, STRIKE_REACH, STRIKE_AFTER_S, tick)};
        }
        enter(leg, LEG_STANCE, tick);
    } else if (seconds_since(tick, leg->since_tick) > SWING_MAX_S) {
        enter(leg, LEG_UNKNOWN, tick);
    }
    return event;
}

/* An event placed ahead of now, in a slow turn, waits for its time. */
static struct leg_event pop_due(struct person_events *leg, struct leg_event found)
{
    if (found.kind != LEG_EVENT_NONE) {
        leg->waiting = found;
    } else if (leg->waiting.kind != LEG_EVENT_NONE) {
        leg->waiting.age_s += CONTROL_PERIOD_S;
    }
    if (leg->waiting.kind == LEG_EVENT_NONE || leg->waiting.age_s < REAL(0.0)) {
        return (struct leg_event){LEG_EVENT_NONE, REAL(0.0)};
    }
    const struct leg_event event = leg->waiting;
    leg->waiting.kind = LEG_EVENT_NONE;
    return event;
}

struct leg_event person_events_update(struct person_events *leg, const struct leg_view *view,
                                      uint32_t tick)
{
    struct leg_event event = {LEG_EVENT_NONE, REAL(0.0)};
    const real least_1_s = PUSH_LEAST_RATIO * view->walking_speed_rad_s;
    ankle_push_update(&leg->push, view->extension, view->fresh, view->ahead_rad < REAL(0.0),
                      least_1_s, tick);
    if (real_abs(view->rate_rad_s) > STILL_RATIO * view->walking_speed_rad_s) {
        leg->moved_tick = tick;
    }
    switch (leg->contact) {
    case LEG_STANCE:
        in_stance(leg, view, tick);
        break;
    case LEG_SWING:
        event = in_swing(leg, view, tick);
        break;
    default: /* the first clear movement shows where the leg is */
        if (view->rate_rad_s > SWING_RATIO * view->walking_speed_rad_s) {
            enter(leg, LEG_SWING, tick);
        } else if (view->rate_rad_s < -SWING_RATIO * view->walking_speed_rad_s) {
            enter(leg, LEG_STANCE, tick);
        }
        break;
    }
    if (leg->contact != LEG_UNKNOWN && seconds_since(tick, leg->moved_tick) > STILL_S) {
        enter(leg, LEG_UNKNOWN, tick);
    }
    leg->rate_before_rad_s = view->rate_rad_s;
    event.age_s += view->strike_bias_s;
    struct leg_event toe_off = place_toe_off(leg, least_1_s, tick);
    toe_off.age_s += view->toe_off_bias_s;
    return pop_due(leg, toe_off.kind != LEG_EVENT_NONE ? toe_off : event);
}
