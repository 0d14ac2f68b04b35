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
    vd cos_d, inverse; /* of the 2x2 system */
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

LANE_INLINE struct taylor_sums taylor_convolve(const struct taylor *t, int k)
{
    const vd zero = vd_all(0.0);
    vd cw = zero, sw = zero, ww = zero, uw = zero;
    vd cu = zero, sv = zero, ws = zero, uc = zero;
    /* The newest coefficients last: the sums of old ones need not wait for them. */
    for (int j = k; j >= 1; j--) {
        const vd c = t->c[j], s = t->s[j], w = t->w[j], u = t->u[j];
        const vd stance = t->ws[k + 1 - j], swing = t->wn[k + 1 - j];
        cw = cw + c * stance;
        sw = sw + s * stance;
        ww = ww + w * swing;
        uw = uw + u * swing;
        cu = cu + c * t->u2[k - j];
        sv = sv + s * t->w2[k - j];
        ws = ws + w * t->s2[k - j];
        uc = uc + u * t->c2[k - j];
    }
    const struct taylor_sums sums = {cw + t->c[k + 1] * t->ws[0],
                                     sw + t->s[k + 1] * t->ws[0],
                                     ww + t->w[k + 1] * t->wn[0],
                                     uw + t->u[k + 1] * t->wn[0],
                                     cu - sv,
                                     ws - uc};
    return sums;
}

/* Coefficients k + 1 of the rates and k + 2 of sines and cosines from all before. */
LANE_INLINE void taylor_next(struct taylor *t, const struct flight_walker *walker, int k)
{
    const struct taylor_sums sum = taylor_convolve(t, k);
    const double n = (double)(k + 1);
    const vd s2 = n * sum.cw, c2 = -n * sum.sw, u2 = n * sum.ww, w2 = -n * sum.uw;
    const vd stance =
        walker->weight * t->s[k] + walker->half_leg * (sum.stance + (t->c[0] * u2 - t->s[0] * w2));
    const vd swing = 2.0 * (sum.swing + (t->w[0] * s2 - t->u[0] * c2) - t->u[k]);
    const vd alpha = (stance + walker->half_leg * t->cos_d * swing) * t->inverse;
    const vd beta = swing + 2.0 * t->cos_d * alpha;

    const double once = taylor_inverse[k + 1], twice = once * taylor_inverse[k + 2];
    t->ws[k + 1] = alpha * once;
    t->wn[k + 1] = beta * once;
    t->ts[k + 2] = alpha * twice;
    t->tn[k + 2] = beta * twice;
    t->s2[k] = s2 + t->c[0] * alpha;
    t->c2[k] = c2 - t->s[0] * alpha;
    t->u2[k] = u2 + t->w[0] * beta;
    t->w2[k] = w2 - t->u[0] * beta;
    t->s[k + 2] = t->s2[k] * twice;
    t->c[k + 2] = t->c2[k] * twice;
    t->u[k + 2] = t->u2[k] * twice;
    t->w[k + 2] = t->w2[k] * twice;
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
    t->cos_d = t->c[0] * t->w[0] + t->s[0] * t->u[0];
    t->inverse = 1.0 / (walker->inertia - 2.0 * walker->half_leg * t->cos_d * t->cos_d);
    for (int k = 0; k + 2 <= order; k++) {
        taylor_next(t, walker, k);
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
