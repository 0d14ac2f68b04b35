/* From heel strike to lift-off, in closed form.
 *
 * Double support has one degree of freedom, the ankle's extension r, and conserves energy: with effective
 * mass mu(r), gravity's potential V(r) and the spring,
 *     mu r'^2 / 2 + V + k (r0 - r)^2 / 2 = E    for all r,
 * so the rate at lift-off follows from that after the collision without following the motion, as long as
 * r'^2 stays positive on the way (else the ankle turns back). Only the duration is an integral.
 * Same equations as model/double_support.h and model/collision.h, in units of M, l and sqrt(l/g).
 */
#ifndef SIM_HOST_BATCH_PUSH_OFF_H
#define SIM_HOST_BATCH_PUSH_OFF_H

#include "model/stride.h"
#include "sim_host/batch/dual.h"

/* One double support's constants. */
struct push {
    vd leg;          /* m / M */
    vd stiffness;    /* k l / (M g) */
    vd rest;         /* r0 / l */
    vd step;         /* d / l, toe to toe */
    vd start;        /* mu r'^2 / 2 after the collision */
    vd lifted;       /* V after the collision, computed as on the way */
    vd sine, cosine; /* of the incline from toe to toe; used where is_inclined */
    int is_inclined;
};

/* The triangle of both legs and the ground at an extension r, and what moves with it. */
struct push_chain {
    struct dual height, cos_d, sin_d, mass, potential;
    struct dual trailing; /* l + r */
    struct dual ahead;    /* hip behind the leading toe */
};

LANE_INLINE struct push_chain push_chain_at(vd leg, struct dual step, struct dual r, int n)
{
    const vd one = vd_all(1.0);
    struct push_chain p;
    p.trailing = dual_line(one, r, one, n);
    /* Heron: (2 l l1 sin D)^2, and twice the hip's height times d. */
    const struct dual long_sides = dual_line(one, p.trailing, one, n);
    const struct dual heron =
        dual_mul(dual_mul(dual_add(long_sides, step, n), dual_sub(long_sides, step, n), n),
                 dual_mul(dual_add(step, r, n), dual_sub(step, r, n), n), n);
    const struct dual root = dual_sqrt(heron, n);
    const struct dual inverse = dual_inverse(p.trailing, n);
    const struct dual half_inverse = dual_line(vd_all(0.5), inverse, vd_all(0.0), n);
    const struct dual per_step = dual_inverse(step, n);
    p.sin_d = dual_mul(root, half_inverse, n);
    p.height = dual_mul(dual_line(vd_all(0.5), root, vd_all(0.0), n), per_step, n);
    /* l1^2 + 1 - d^2 = 2 l1 cos D; d^2 - (l1^2 - 1) = 2 d (d - X) */
    const struct dual square = dual_mul(step, step, n);
    const struct dual gain = dual_mul(r, dual_line(one, p.trailing, one, n), n); /* l1^2 - 1 */
    p.cos_d = dual_mul(dual_line(one, dual_sub(gain, square, n), vd_all(2.0), n), half_inverse, n);
    p.ahead =
        dual_mul(dual_line(vd_all(0.5), dual_sub(square, gain, n), vd_all(0.0), n), per_step, n);

    /* The trailing leg's mass lies at this share of the way to the hip. */
    const struct dual share = dual_line(-one, half_inverse, one, n);
    const struct dual squared = dual_mul(share, share, n);
    const struct dual at_hip = dual_line(leg, squared, 1.0 + 0.25 * leg, n);
    const struct dual hip = dual_inverse(dual_mul(p.sin_d, p.sin_d, n), n);
    p.mass = dual_add(dual_mul(at_hip, hip, n), dual_line(-leg, squared, leg, n), n);
    p.potential = dual_mul(dual_line(leg, share, 1.0 + 0.5 * leg, n), p.height, n);
    return p;
}

/* V at an extension r. */
LANE_INLINE vd push_potential(const struct push *push, vd r)
{
    const vd trailing = 1.0 + r, sides = 2.0 + r;
    const vd heron =
        (sides + push->step) * (sides - push->step) * (push->step + r) * (push->step - r);
    const vd weight = 1.0 + 1.5 * push->leg - 0.5 * push->leg / trailing;
    const vd level = weight * vd_sqrt(heron) / (2.0 * push->step);
    if (!push->is_inclined) {
        return level;
    }
    const vd along = (push->step * push->step + r * sides) / (2.0 * push->step);
    return level * push->cosine + weight * along * push->sine;
}

/* mu r'^2 / 2 at an extension r; at 0 exactly what it starts with. */
LANE_INLINE vd push_kinetic(const struct push *push, vd r)
{
    const vd released = push->stiffness * r * (push->rest - 0.5 * r);
    return push->start + (push->lifted - push_potential(push, r)) + released;
}

/* Its derivative at r = 0: the force that starts the ankle. */
LANE_INLINE vd push_force_at_rest(const struct push *push)
{
    const vd height = vd_sqrt(1.0 - 0.25 * push->step * push->step);
    /* The hip rises by sin(lean) / sin D = 1 / (2 height) per extension. */
    if (!push->is_inclined) {
        return push->stiffness * push->rest - (1.0 + push->leg) * 0.5 / height -
               0.5 * push->leg * height;
    }
    const vd rises = 0.5 / height * push->cosine + push->sine / push->step;
    const vd lies = height * push->cosine + 0.5 * push->step * push->sine;
    return push->stiffness * push->rest - (1.0 + push->leg) * rises - 0.5 * push->leg * lies;
}

#define PUSH_SAMPLES 8
#define PUSH_SEARCHES 60

/* Smallest kinetic energy between two extensions that embrace one minimum. */
LANE_INLINE vd push_smallest(const struct push *push, vd low, vd high)
{
    vd least = push_kinetic(push, 0.5 * (low + high));
    for (int i = 0; i < PUSH_SEARCHES; i++) {
        const vd third = (high - low) * (1.0 / 3.0);
        const vd a = low + third, b = high - third;
        const vd at_a = push_kinetic(push, a), at_b = push_kinetic(push, b);
        const vi left = at_a < at_b;
        high = vd_pick(left, b, high);
        low = vd_pick(left, low, a);
        least = vd_min(least, vd_min(at_a, at_b));
    }
    return least;
}

/* Mask of the lanes whose ankle stops before lift-off: samples, and a search where one may lie lower between
 * them. start: kinetic energy after the collision; end: at lift-off. */
LANE_INLINE vi push_turns_back(const struct push *push, vd start, vd end, vi wanted)
{
    const vd pace = push->rest * (1.0 / PUSH_SAMPLES);
    const vd force = push_force_at_rest(push);
    const vi falling = force <= vd_all(0.0);
    vi stops = ((start <= vd_all(0.0)) & falling) | ~(end > vd_all(0.0));
    vi dips = vi_all(0);
    vd dip_at = vd_all(0.0);
    /* Before the first sample: high enough to count as a slope down where the ankle starts by slowing. */
    vd before = vd_pick(falling, start - force * pace, vd_all(-1.0)), here = start;
    for (int i = 0; i < PUSH_SAMPLES; i++) {
        const vd after = i + 1 == PUSH_SAMPLES ? end : push_kinetic(push, pace * (double)(i + 1));
        stops |= (after < vd_all(0.0));
        /* A dip: the parabola through three samples, its depth taken fourfold. */
        const vd rise = after - before, bend = (after - here) + (before - here);
        const vi dip = (here <= before) & (here <= after) & (2.0 * here * bend <= rise * rise);
        dip_at = vd_pick(dip & ~dips, pace * (double)i, dip_at);
        dips |= dip;
        before = here;
        here = after;
    }
    const vi extends = push->rest > vd_all(0.0);
    dips &= wanted & extends & ~stops;
    if (vi_any(dips)) {
        const vd low = vd_max(dip_at - pace, vd_all(0.0));
        stops |= dips & (push_smallest(push, low, dip_at + pace) <= vd_all(0.0));
    }
    return stops & extends;
}

/* The potential on the incline: the hip's way along the line of the toes is a height, too. */
LANE_INLINE void push_chain_turn(const struct push *push, struct push_chain *p)
{
    const vd weight = 1.0 + 1.5 * push->leg - 0.5 * push->leg / p->trailing.v;
    const vd along = push->step - p->ahead.v;
    p->potential.v = p->potential.v * push->cosine + weight * along * push->sine;
}

struct push_result {
    struct dual ts, tn, ws, wn; /* just after lift-off, legs renamed */
    struct push push;
    vd ankle_rate; /* after collision and clamp */
    vi clamped, fault;
};

/* Rate of the ankle after the collision (paper eq. 11, corrected), for half the angle between the legs. */
LANE_INLINE struct dual push_start(vd leg, struct dual sine, struct dual cosine, struct dual ws,
                                   struct dual wn, int n)
{
    const struct dual sin_d = dual_line(vd_all(-2.0), dual_mul(sine, cosine, n), vd_all(0.0), n);
    const struct dual cos_d = dual_line(vd_all(-2.0), dual_mul(sine, sine, n), vd_all(1.0), n);
    const struct dual drive =
        dual_sub(dual_line(3.0 * leg + 4.0, dual_mul(cos_d, ws, n), vd_all(0.0), n),
                 dual_line(leg, wn, vd_all(0.0), n), n);
    const struct dual divisor = dual_line(3.0 * leg, dual_mul(sin_d, sin_d, n), 2.0 * leg + 4.0, n);
    return dual_mul(dual_mul(sin_d, drive, n), dual_inverse(divisor, n), n);
}

/* x: ts, tn, ws, wn at the strike (ts < 0, ts + tn twice the incline); rest: r0; incline: from toe to toe, NULL where
 * all lanes are level (derivatives only then). Lanes outside `wanted` may hold anything. */
LANE_INLINE struct push_result push_off(vd leg, vd stiffness, struct dual rest,
                                        const struct dual x[COLUMN_COUNT], const vd *incline,
                                        vi wanted, int n)
{
    const vd zero = vd_all(0.0), half = vd_all(0.5), two = vd_all(2.0);
    struct push_result result;
    const struct dual half_angle =
        dual_line(half, dual_sub(x[COLUMN_TN], x[COLUMN_TS], n), zero, n);
    vd s, c;
    vd_sincos(half_angle.v, &s, &c);
    const struct dual sine = dual_chain(half_angle, s, c, n);
    const struct dual cosine = dual_chain(half_angle, c, -s, n);
    const struct dual step = dual_line(two, sine, zero, n);
    struct dual start = push_start(leg, sine, cosine, x[COLUMN_WS], x[COLUMN_WN], n);
    result.clamped = start.v < zero;
    start = dual_line(vd_pick(result.clamped, zero, vd_all(1.0)), start, zero, n);
    result.ankle_rate = start.v;

    struct push_chain first = push_chain_at(leg, step, dual_all(zero, n), n);
    struct push_chain last = push_chain_at(leg, step, rest, n);
    struct push push = {.leg = leg, .stiffness = stiffness, .rest = rest.v, .step = step.v};
    if (incline != NULL) {
        push.is_inclined = 1;
        vd_sincos(*incline, &push.sine, &push.cosine);
        push_chain_turn(&push, &first);
        push_chain_turn(&push, &last);
    }
    const struct dual kinetic =
        dual_line(half, dual_mul(first.mass, dual_mul(start, start, n), n), zero, n);
    const struct dual spring = dual_line(0.5 * stiffness, dual_mul(rest, rest, n), zero, n);
    const struct dual energy = dual_add(dual_add(kinetic, first.potential, n), spring, n);
    struct dual left = dual_sub(energy, last.potential, n);
    left.v = vd_max(left.v, zero); /* a NaN becomes 0, too, and is found below */
    const struct dual rate =
        dual_sqrt(dual_mul(dual_line(two, left, zero, n), dual_inverse(last.mass, n), n), n);
    push.start = kinetic.v;
    push.lifted = push_potential(&push, zero);
    result.push = push;

    const struct dual per_sine = dual_inverse(last.sin_d, n);
    const struct dual per_leg = dual_inverse(last.trailing, n);
    const struct dual swing = dual_mul(per_sine, rate, n);
    const struct dual lean =
        dual_mul(dual_sub(step, last.ahead, n), per_leg, n); /* sine of the trailing leg's */
    result.ts = dual_asin(last.ahead, last.height, n);
    result.tn =
        dual_line(-vd_all(1.0), dual_asin(lean, dual_mul(last.height, per_leg, n), n), zero, n);
    result.ws = dual_line(-vd_all(1.0), swing, zero, n);
    result.wn =
        dual_line(-vd_all(1.0), dual_mul(dual_mul(last.cos_d, per_leg, n), swing, n), zero, n);

    if (incline != NULL) {
        result.ts.v = result.ts.v + *incline;
        result.tn.v = result.tn.v + *incline;
    }

    const vi no_room = ~(push.step > push.rest);
    const vi stops = push_turns_back(&push, kinetic.v, left.v, wanted & ~no_room);
    vi fault = vi_pick(result.ts.v <= zero, vi_all(STRIDE_LIFT_OFF_PAST_APEX), vi_all(STRIDE_OK));
    fault = vi_pick(stops, vi_all(STRIDE_NO_LIFT_OFF), fault);
    result.fault = vi_pick(no_room, vi_all(STRIDE_NO_ROOM_TO_EXTEND), fault);
    return result;
}

#endif
