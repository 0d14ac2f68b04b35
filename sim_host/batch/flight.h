/* Single support of a block's walkers from where they are to an event: heel strike, or the apex.
 *
 * Each vector takes one step of each of its lanes at a time, of each lane's own length; a lane whose walker
 * has landed or failed takes the next of the block. What a lane computes depends on its walker alone.
 * The toe strikes where ts + tn falls through zero (rising is the mid-stance scuff), on an incline e of the line
 * from toe to toe through 2 e (model/ground.h); the apex is where ts falls through zero. Within a step either is a
 * root of a known polynomial; where the next foothold lies higher or lower, e follows the legs' opening.
 *
 * `ground` is NULL where all lanes are on level ground. A lane that is level among others that are not
 * computes the same bits as there.
 */
#ifndef SIM_HOST_BATCH_FLIGHT_H
#define SIM_HOST_BATCH_FLIGHT_H

#include <stddef.h>

#include "model/stride.h"
#include "sim_host/batch/slopes.h"

enum flight_goal { GOAL_STRIKE, GOAL_APEX };

#define FLIGHT_MAX_SEARCHES 70
#define FLIGHT_SETTLED \
    1e-8 /* a Newton correction so small leaves its square as the error, sqrt(l/g) */

/* The event's function as a polynomial in time: it falls through zero at the event. */
struct flight_event {
    int degree;
    vd term[BATCH_MAX_ORDER + 1];
};

LANE_INLINE vd event_of(enum flight_goal goal, vd stance, vd swing)
{
    return goal == GOAL_STRIKE ? stance + swing : stance;
}

/* Ground per lane: its slope, rad, and the next foothold's rise times the slope's cosine, leg lengths. */
struct flight_ground {
    vd slope, rise;
};

LANE_INLINE vi ground_is_level(const struct flight_ground *ground)
{
    return (ground->slope == vd_all(0.0)) & (ground->rise == vd_all(0.0));
}

/* Twice the incline from toe to toe at the legs' opening, and its derivative by the opening. A rise out of reach
 * gives the steepest. */
LANE_INLINE vd ground_twice_incline(const struct flight_ground *ground, vd opening, vd *by_opening)
{
    const vd one = vd_all(1.0), zero = vd_all(0.0);
    vd sine, cosine;
    vd_sincos(0.5 * vd_abs(opening), &sine, &cosine);
    const vd per_distance = 0.5 / sine;
    const vi rises = ground->rise != zero;
    const vd reached = vd_min(vd_max(ground->rise * per_distance, -one), one);
    const vd share = vd_pick(rises, reached, zero);
    const vd root = vd_sqrt(one - share * share);
    const vd slope = -2.0 * share * cosine * per_distance / root;
    *by_opening = vd_pick(root > zero, slope, zero);
    return 2.0 * (ground->slope + vd_asin(share, root));
}

/* The event's value at a state. */
LANE_INLINE vd event_at(enum flight_goal goal, const struct flight_ground *ground,
                        const struct flight_state *x)
{
    const vd value = event_of(goal, x->ts, x->tn);
    if (ground == NULL || goal == GOAL_APEX) {
        return value;
    }
    vd by_opening;
    return value - ground_twice_incline(ground, x->ts - x->tn, &by_opening);
}

/* Fault of a state in single support: enum stride_fault, the checks in model/stride.c's order. */
LANE_INLINE vi flight_fault(const struct flight_state *x)
{
    const vi lame = vd_abs(x->ts - x->tn) > vd_all(LANES_PI);
    vi fault = lame & STRIDE_INTER_LEG_ANGLE;
    fault = vi_pick(vd_abs(x->ts) > vd_all(LANES_HALF_PI), vi_all(STRIDE_FALLEN), fault);
    fault = vi_pick(x->ws >= vd_all(0.0), vi_all(STRIDE_WALKING_BACKWARDS), fault);
    const vi finite =
        vd_is_finite(x->ts) & vd_is_finite(x->tn) & vd_is_finite(x->ws) & vd_is_finite(x->wn);
    return vi_pick(finite, fault, vi_all(STRIDE_NOT_FINITE));
}

/* Where sign * polynomial falls through zero between low and high (positive at low, not at high), for the
 * lanes of `wanted`. Newton from `guess`, bisecting where it leaves the bracket; lanes that have settled stay. */
LANE_INLINE vd event_root(const struct flight_event *event, vd sign, vd low, vd high, vd guess,
                          vi wanted)
{
    vd t = guess;
    for (int i = 0; i < FLIGHT_MAX_SEARCHES && vi_any(wanted); i++) {
        vd value = event->term[event->degree], slope = vd_all(0.0);
        for (int k = event->degree - 1; k >= 0; k--) {
            slope = slope * t + value;
            value = value * t + event->term[k];
        }
        const vi beyond = sign * value <= vd_all(0.0);
        high = vd_pick(beyond, t, high);
        low = vd_pick(beyond, low, t);
        const vd change = value / slope;
        const vd newton = t - change;
        const vi settled = vd_abs(change) <= vd_all(FLIGHT_SETTLED);
        const vi inside = settled | ((newton > low) & (newton < high));
        t = vd_pick(wanted, vd_pick(inside, newton, 0.5 * (low + high)), t);
        wanted &= ~settled;
    }
    return t;
}

/* The same for the strike where the ground rises or falls: the event is no polynomial. */
LANE_INLINE vd event_root_on_ground(const struct taylor *t, const struct flight_ground *ground,
                                    vd low, vd high, vd guess, vi wanted)
{
    vd at = guess;
    for (int i = 0; i < FLIGHT_MAX_SEARCHES && vi_any(wanted); i++) {
        vd by_opening;
        const struct flight_state x = taylor_at(t, at);
        const vd opening = x.ts - x.tn;
        const vd turn = ground_twice_incline(ground, opening, &by_opening);
        const vd value = x.ts + x.tn - turn;
        const vd opens = vd_pick(opening < vd_all(0.0), x.wn - x.ws, x.ws - x.wn);
        const vd change = value / (x.ws + x.wn - by_opening * opens);
        const vi beyond = value <= vd_all(0.0);
        high = vd_pick(beyond, at, high);
        low = vd_pick(beyond, low, at);
        const vd newton = at - change;
        const vi settled = vd_abs(change) <= vd_all(FLIGHT_SETTLED);
        const vi inside = settled | ((newton > low) & (newton < high));
        at = vd_pick(wanted, vd_pick(inside, newton, 0.5 * (low + high)), at);
        wanted &= ~settled;
    }
    return at;
}

/* First guess of the root between two points with values v0 > 0 >= v1 and slopes s0, s1: two Newton steps on
 * the cubic through them. */
LANE_INLINE vd event_guess(vd v0, vd v1, vd s0, vd s1, vd low, vd width)
{
    const vd c = s0 * width, b = 3.0 * (v1 - v0) - 2.0 * c - s1 * width,
             a = 2.0 * (v0 - v1) + c + s1 * width;
    vd x = v0 / (v0 - v1);
    for (int i = 0; i < 2; i++) {
        const vd value = v0 + x * (c + x * (b + x * a));
        const vd slope = c + x * (2.0 * b + 3.0 * x * a);
        x = x - value / slope;
    }
    const vi good = (x > vd_all(0.0)) & (x < vd_all(1.0));
    return low + width * vd_pick(good, x, vd_all(0.5));
}

/* What is known of the event on one part of a step. */
struct flight_part {
    vd low, high, v0, v1, s0, s1; /* times; the event's value and slope at both */
};

struct flight_bracket {
    vi found;
    vd low, high, guess;
};

/* Whether the event falls through zero on a part of a step: from plus to minus, over a hump that
 * hides between two negative ends, or into a dip between two positive ones. Where the next foothold lies higher or
 * lower only while ts + tn falls: what the toe does before is the scuff, too. */
LANE_INLINE struct flight_bracket flight_search(const struct taylor *t, enum flight_goal goal,
                                                const struct flight_ground *ground,
                                                const struct flight_part *p, vi wanted)
{
    const vd zero = vd_all(0.0);
    const vi above = p->v0 > zero, ends_above = p->v1 > zero;
    struct flight_bracket b = {wanted & above & ~ends_above, p->low, p->high, zero};
    b.guess = event_guess(p->v0, p->v1, p->s0, p->s1, p->low, p->high - p->low);
    if (goal == GOAL_APEX) {
        return b; /* ts falls all the way: a walker whose ts rises has failed */
    }
    vi hump = wanted & ~above & ~ends_above & (p->s0 > zero) & (p->s1 < zero);
    vi dip = wanted & above & ends_above & (p->s0 < zero) & (p->s1 > zero);
    if (ground != NULL) {
        const vi rough = ground->rise != zero, falls = p->s1 < zero;
        hump |= wanted & rough & ~ends_above & (p->s0 > zero) & falls;
        dip |= wanted & rough & above & (p->s0 < zero) & ~falls;
        b.found &= ~rough | (falls & (p->s0 <= zero));
    }
    if (vi_any(hump | dip)) {
        struct flight_event rate = {t->order - 1, {zero}};
        for (int k = 0; k < t->order; k++) {
            rate.term[k] = t->ws[k] + t->wn[k];
        }
        const vd sign = vd_pick(hump, vd_all(1.0), vd_all(-1.0));
        const vd top =
            event_root(&rate, sign, p->low, p->high, 0.5 * (p->low + p->high), hump | dip);
        const struct flight_state x = taylor_at(t, top);
        const vi top_above = event_at(goal, ground, &x) > zero;
        const vi over = hump & top_above, into = dip & ~top_above;
        b.low = vd_pick(over, top, b.low);
        b.high = vd_pick(into, top, b.high);
        b.guess = vd_pick(over | into, 0.5 * (b.low + b.high), b.guess);
        b.found |= over | into;
    }
    return b;
}

/* How one step ends, lane by lane. */
struct flight_end {
    struct flight_state x;
    vd length;  /* the step's, or the time to the event */
    vi fault;   /* enum stride_fault */
    vi arrived; /* at the event, and without fault */
};

/* The event's time within the bracket, for the lanes of `found`. */
LANE_INLINE vd flight_landing(const struct taylor *t, enum flight_goal goal,
                              const struct flight_ground *ground, const struct flight_bracket *b,
                              vi found)
{
    struct flight_event event = {t->order, {vd_all(0.0)}};
    for (int k = 0; k <= t->order; k++) {
        event.term[k] = event_of(goal, t->ts[k], t->tn[k]);
    }
    if (ground == NULL || goal == GOAL_APEX) {
        return event_root(&event, vd_all(1.0), b->low, b->high, b->guess, found);
    }
    const vi level = ground_is_level(ground);
    const vd flat = event_root(&event, vd_all(1.0), b->low, b->high, b->guess, found & level);
    const vd rough = event_root_on_ground(t, ground, b->low, b->high, b->guess, found & ~level);
    return vd_pick(level, flat, rough);
}

/* Looks at both halves of a step of length h in turn: the event, or a fault, whichever is first. */
LANE_INLINE struct flight_end flight_land(const struct taylor *t, enum flight_goal goal,
                                          const struct flight_ground *ground, vd h)
{
    struct flight_state half, full;
    const struct flight_state start = {t->ts[0], t->tn[0], t->ws[0], t->wn[0]};
    const vd middle = 0.5 * h, zero = vd_all(0.0);
    taylor_at_two(t, middle, h, &half, &full);
    const struct flight_part first = {zero,
                                      middle,
                                      event_at(goal, ground, &start),
                                      event_at(goal, ground, &half),
                                      event_of(goal, start.ws, start.wn),
                                      event_of(goal, half.ws, half.wn)};
    const struct flight_part second = {middle,   h,
                                       first.v1, event_at(goal, ground, &full),
                                       first.s1, event_of(goal, full.ws, full.wn)};
    const struct flight_bracket b1 = flight_search(t, goal, ground, &first, vi_all(-1));
    const vi half_fault = flight_fault(&half);
    const vi sound = half_fault == vi_all(STRIDE_OK);
    const struct flight_bracket b2 = flight_search(t, goal, ground, &second, ~b1.found & sound);
    const vi found = b1.found | b2.found;

    struct flight_end end = {full, h, vi_all(STRIDE_OK), found};
    if (vi_any(found)) {
        const struct flight_bracket b = {found, vd_pick(b1.found, b1.low, b2.low),
                                         vd_pick(b1.found, b1.high, b2.high),
                                         vd_pick(b1.found, b1.guess, b2.guess)};
        const vd at = flight_landing(t, goal, ground, &b, found);
        const struct flight_state x = taylor_at(t, at);
        end.x.ts = vd_pick(found, x.ts, full.ts);
        end.x.tn = vd_pick(found, x.tn, full.tn);
        end.x.ws = vd_pick(found, x.ws, full.ws);
        end.x.wn = vd_pick(found, x.wn, full.wn);
        end.length = vd_pick(found, at, h);
    }
    end.fault = flight_fault(&end.x);
    end.fault = vi_pick(sound | b1.found, end.fault, half_fault);
    end.arrived = found & (end.fault == vi_all(STRIDE_OK));
    return end;
}

#endif
