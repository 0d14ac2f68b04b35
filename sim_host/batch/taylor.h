/* Single support of BATCH_LANES walkers as power series in time, by recurrence.
 *
 * In units of the walker (hip mass, leg length, sqrt(l/g)) only m/M remains. With S, C = sin, cos ts and
 * U, W = sin, cos tn as series of their own, torques about the stance toe and about the hip read
 *     (1 + 5m/4) ts'' = (1 + 3m/2) S + (m/2) (C U'' - S W''),    tn'' = 2 (W S'' - U C'' - U),
 * which is model/single_support.h with the leg's difference D nowhere: eight convolutions in all. The
 * newest coefficient of each second derivative holds the unknown accelerations linearly, hence a 2x2 system.
 */
#ifndef SIM_HOST_BATCH_TAYLOR_H
#define SIM_HOST_BATCH_TAYLOR_H

#include "sim_host/batch/block.h"
#include "sim_host/batch/lanes_trig.h"

/* 1/n; a product with these takes the place of a division. */
static const double taylor_inverse[BATCH_MAX_ORDER + 2] = {
    0.0,      1.0,      1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6,  1.0 / 7,
    1.0 / 8,  1.0 / 9,  1.0 / 10, 1.0 / 11, 1.0 / 12, 1.0 / 13, 1.0 / 14, 1.0 / 15,
    1.0 / 16, 1.0 / 17, 1.0 / 18, 1.0 / 19, 1.0 / 20, 1.0 / 21, 1.0 / 22, 1.0 / 23,
    1.0 / 24, 1.0 / 25, 1.0 / 26, 1.0 / 27, 1.0 / 28, 1.0 / 29};

/* Angles and rates of one moment, in radians and radians per sqrt(l/g). */
struct flight_state {
    vd ts, tn, ws, wn;
};

/* Constants of the equations per lane. */
struct flight_walker {
    vd half_leg; /* m / 2M */
    vd inertia;  /* 1 + 5m/4M */
    vd weight;   /* 1 + 3m/2M */
};

struct taylor {
    int order;                                           /* of the angles */
    vd ts[BATCH_MAX_ORDER + 1], tn[BATCH_MAX_ORDER + 1]; /* coefficients of the angles */
    vd ws[BATCH_MAX_ORDER], wn[BATCH_MAX_ORDER];         /* of the rates */
    vd s[BATCH_MAX_ORDER + 1], c[BATCH_MAX_ORDER + 1], u[BATCH_MAX_ORDER + 1],
        w[BATCH_MAX_ORDER + 1];
    vd s2[BATCH_MAX_ORDER], c2[BATCH_MAX_ORDER], u2[BATCH_MAX_ORDER], w2[BATCH_MAX_ORDER];
    vd alpha_by_stance, alpha_by_swing, beta_by_stance,
        beta_by_swing; /* inverse of the 2x2 system */
};

LANE_INLINE struct flight_walker flight_walker_of(vd mass_ratio)
{
    const struct flight_walker walker = {0.5 * mass_ratio, 1.0 + 1.25 * mass_ratio,
                                         1.0 + 1.5 * mass_ratio};
    return walker;
}

/* Sums of products whose indices add up to k + 1 (rates) or k (second derivatives), factor j from 1 up. */
struct taylor_sums {
    vd cw, sw, ww, uw; /* C ws, S ws, W wn, U wn */
    vd stance, swing;  /* C U'' - S W'', W S'' - U C'' */
};

/* One leg's share of the sums for k and for k + 1: of its cosine and sine with its rate, and with the other leg's
 * second derivatives. */
struct taylor_leg {
    vd cosine_rate, sine_rate, coupling;
    vd next_cosine_rate, next_sine_rate, next_coupling;
};

/* The terms j = 2..k of k's sums and j = 2..k + 1 of the next's. Two sums at a time load each operand once, and
 * eight at a time fit the registers of AVX2. Newest coefficients last: the old ones need not wait for them. */
LANE_INLINE struct taylor_leg taylor_convolve_leg(const vd *cosine, const vd *sine, const vd *rate,
                                                  const vd *other_s2, const vd *other_c2, int k)
{
    const vd zero = vd_all(0.0);
    vd cw = zero, sw = zero, next_cw = zero, next_sw = zero;
    vd w = rate[1], s2 = other_s2[0], c2 = other_c2[0];
    vd cs = zero, sc = zero, next_cs = cosine[k + 1] * s2, next_sc = sine[k + 1] * c2;
    for (int j = k; j >= 2; j--) {
        const vd c = vd_hold(cosine[j]), s = vd_hold(sine[j]);
        cw = cw + c * w;
        sw = sw + s * w;
        w = vd_hold(rate[k + 2 - j]);
        next_cw = next_cw + c * w;
        next_sw = next_sw + s * w;
        cs = cs + c * s2;
        sc = sc + s * c2;
        s2 = vd_hold(other_s2[k + 1 - j]);
        c2 = vd_hold(other_c2[k + 1 - j]);
        next_cs = next_cs + c * s2;
        next_sc = next_sc + s * c2;
    }
    next_cw = next_cw + cosine[k + 1] * rate[1];
    next_sw = next_sw + sine[k + 1] * rate[1];
    const struct taylor_leg leg = {cw, sw, cs - sc, next_cw, next_sw, next_cs - next_sc};
    return leg;
}

/* Adds to the sums for k the terms with the newest coefficients. */
LANE_INLINE void taylor_complete(const struct taylor *t, int k, struct taylor_sums *sum)
{
    sum->cw = (sum->cw + t->c[k + 1] * t->ws[0]) + t->c[1] * t->ws[k];
    sum->sw = (sum->sw + t->s[k + 1] * t->ws[0]) + t->s[1] * t->ws[k];
    sum->ww = (sum->ww + t->w[k + 1] * t->wn[0]) + t->w[1] * t->wn[k];
    sum->uw = (sum->uw + t->u[k + 1] * t->wn[0]) + t->u[1] * t->wn[k];
    sum->stance = sum->stance + (t->c[1] * t->u2[k - 1] - t->s[1] * t->w2[k - 1]);
    sum->swing = sum->swing + (t->w[1] * t->s2[k - 1] - t->u[1] * t->c2[k - 1]);
}

/* Coefficients k + 1 of the rates and k + 2 of sines and cosines from the sums for k. What the newest sums are
 * multiplied with does not wait for them: the way from one order to the next is short. */
LANE_INLINE void taylor_next(struct taylor *t, const struct flight_walker *walker, int k,
                             const struct taylor_sums *sum)
{
    const double n = (double)(k + 1);
    const vd leg = n * walker->half_leg;
    const vd stance = (walker->weight * t->s[k] + walker->half_leg * sum->stance) +
                      ((leg * t->c[0]) * sum->ww + (leg * t->s[0]) * sum->uw);
    const vd swing = 2.0 * (sum->swing - t->u[k]) +
                     (((2.0 * n) * t->w[0]) * sum->cw + ((2.0 * n) * t->u[0]) * sum->sw);
    const vd alpha = stance * t->alpha_by_stance + swing * t->alpha_by_swing;
    const vd beta = stance * t->beta_by_stance + swing * t->beta_by_swing;

    const double once = taylor_inverse[k + 1], twice = once * taylor_inverse[k + 2];
    t->ws[k + 1] = alpha * once;
    t->wn[k + 1] = beta * once;
    t->ts[k + 2] = alpha * twice;
    t->tn[k + 2] = beta * twice;
    t->s2[k] = n * sum->cw + t->c[0] * alpha;
    t->c2[k] = -n * sum->sw - t->s[0] * alpha;
    t->u2[k] = n * sum->ww + t->w[0] * beta;
    t->w2[k] = -n * sum->uw - t->u[0] * beta;
    t->s[k + 2] = t->s2[k] * twice;
    t->c[k + 2] = t->c2[k] * twice;
    t->u[k + 2] = t->u2[k] * twice;
    t->w[k + 2] = t->w2[k] * twice;
}

/* Two orders: those after k >= 1 and, within the order asked for, k + 1. */
LANE_INLINE void taylor_two(struct taylor *t, const struct flight_walker *walker, int k)
{
    const struct taylor_leg stance = taylor_convolve_leg(t->c, t->s, t->ws, t->u2, t->w2, k);
    const struct taylor_leg swing = taylor_convolve_leg(t->w, t->u, t->wn, t->s2, t->c2, k);
    struct taylor_sums now = {stance.cosine_rate, stance.sine_rate, swing.cosine_rate,
                              swing.sine_rate,    stance.coupling,  swing.coupling};
    struct taylor_sums next = {stance.next_cosine_rate, stance.next_sine_rate,
                               swing.next_cosine_rate,  swing.next_sine_rate,
                               stance.next_coupling,    swing.next_coupling};
    taylor_complete(t, k, &now);
    taylor_next(t, walker, k, &now);
    if (k + 3 <= t->order) {
        taylor_complete(t, k + 1, &next);
        taylor_next(t, walker, k + 1, &next);
    }
}

/* alpha - (m/2) cos D beta = stance and beta - 2 cos D alpha = swing, over the inertia, solved. */
LANE_INLINE void taylor_solve(struct taylor *t, const struct flight_walker *walker)
{
    const vd cos_d = t->c[0] * t->w[0] + t->s[0] * t->u[0];
    const vd inverse = 1.0 / (walker->inertia - 2.0 * walker->half_leg * cos_d * cos_d);
    t->alpha_by_stance = inverse;
    t->alpha_by_swing = walker->half_leg * cos_d * inverse;
    t->beta_by_stance = 2.0 * cos_d * inverse;
    t->beta_by_swing = walker->inertia * inverse;
}

/* The motion from x on, to the given order (4..BATCH_MAX_ORDER) of the angles. */
LANE_INLINE void taylor_expand(struct taylor *t, const struct flight_walker *walker,
                               const struct flight_state *x, int order)
{
    t->order = order;
    t->ts[0] = x->ts;
    t->tn[0] = x->tn;
    t->ts[1] = t->ws[0] = x->ws;
    t->tn[1] = t->wn[0] = x->wn;
    vd_sincos(x->ts, &t->s[0], &t->c[0]);
    vd_sincos(x->tn, &t->u[0], &t->w[0]);
    t->s[1] = t->c[0] * x->ws;
    t->c[1] = -t->s[0] * x->ws;
    t->u[1] = t->w[0] * x->wn;
    t->w[1] = -t->u[0] * x->wn;
    taylor_solve(t, walker);
    const struct taylor_sums first = {t->c[1] * t->ws[0], t->s[1] * t->ws[0], t->w[1] * t->wn[0],
                                      t->u[1] * t->wn[0], vd_all(0.0),        vd_all(0.0)};
    taylor_next(t, walker, 0, &first);
    for (int k = 1; k + 2 <= order; k += 2) {
        taylor_two(t, walker, k);
    }
}

/* Longest step whose last two terms of the rates stay below 2^log2_tolerance, at most BATCH_MAX_STEP. */
LANE_INLINE vd taylor_step(const struct taylor *t, double log2_tolerance)
{
    const int last = t->order - 1;
    const vd e1 = vd_abs(t->ws[last]) + vd_abs(t->wn[last]);
    const vd e2 = vd_abs(t->ws[last - 1]) + vd_abs(t->wn[last - 1]);
    const vd by_last = (log2_tolerance - vd_rough_log2(e1)) * taylor_inverse[last];
    const vd by_next = (log2_tolerance - vd_rough_log2(e2)) * taylor_inverse[last - 1];
    return vd_min(vd_rough_exp2(vd_min(by_last, by_next)), vd_all(BATCH_MAX_STEP));
}

/* The state a time h after the expansion. */
LANE_INLINE struct flight_state taylor_at(const struct taylor *t, vd h)
{
    const int last = t->order - 1;
    struct flight_state x = {t->ts[last + 1], t->tn[last + 1], t->ws[last], t->wn[last]};
    for (int k = last - 1; k >= 0; k--) {
        x.ts = x.ts * h + t->ts[k + 1];
        x.tn = x.tn * h + t->tn[k + 1];
        x.ws = x.ws * h + t->ws[k];
        x.wn = x.wn * h + t->wn[k];
    }
    x.ts = x.ts * h + t->ts[0];
    x.tn = x.tn * h + t->tn[0];
    return x;
}

/* taylor_at for two moments, in the time of one. */
LANE_INLINE void taylor_at_two(const struct taylor *t, vd h1, vd h2, struct flight_state *x1,
                               struct flight_state *x2)
{
    const int last = t->order - 1;
    struct flight_state x = {t->ts[last + 1], t->tn[last + 1], t->ws[last], t->wn[last]};
    struct flight_state y = x;
    for (int k = last - 1; k >= 0; k--) {
        const vd a = t->ts[k + 1], b = t->tn[k + 1], c = t->ws[k], d = t->wn[k];
        x.ts = x.ts * h1 + a;
        y.ts = y.ts * h2 + a;
        x.tn = x.tn * h1 + b;
        y.tn = y.tn * h2 + b;
        x.ws = x.ws * h1 + c;
        y.ws = y.ws * h2 + c;
        x.wn = x.wn * h1 + d;
        y.wn = y.wn * h2 + d;
    }
    x.ts = x.ts * h1 + t->ts[0];
    y.ts = y.ts * h2 + t->ts[0];
    x.tn = x.tn * h1 + t->tn[0];
    y.tn = y.tn * h2 + t->tn[0];
    *x1 = x;
    *x2 = y;
}

#endif
