/* Derivatives of the flight: the power series of one direction's variation, beside the motion's own.
 *
 * The equations of sim_host/batch/taylor.h differentiated term by term; the same 2x2 system throughout.
 */
#ifndef SIM_HOST_BATCH_SLOPES_H
#define SIM_HOST_BATCH_SLOPES_H

#include "sim_host/batch/taylor.h"

/* Variation of each of the series in struct taylor. */
struct variation {
    vd ws[BATCH_MAX_ORDER], wn[BATCH_MAX_ORDER];
    vd s[BATCH_MAX_ORDER + 1], c[BATCH_MAX_ORDER + 1], u[BATCH_MAX_ORDER + 1],
        w[BATCH_MAX_ORDER + 1];
    vd s2[BATCH_MAX_ORDER], c2[BATCH_MAX_ORDER], u2[BATCH_MAX_ORDER], w2[BATCH_MAX_ORDER];
};

/* Variation of taylor_convolve's sums, the terms of index 0 that are known included. */
LANE_INLINE struct taylor_sums variation_convolve(const struct taylor *t, const struct variation *v,
                                                  int k)
{
    const vd zero = vd_all(0.0);
    struct taylor_sums sum = {v->c[0] * t->ws[k + 1] + t->c[k + 1] * v->ws[0],
                              v->s[0] * t->ws[k + 1] + t->s[k + 1] * v->ws[0],
                              v->w[0] * t->wn[k + 1] + t->w[k + 1] * v->wn[0],
                              v->u[0] * t->wn[k + 1] + t->u[k + 1] * v->wn[0],
                              v->c[0] * t->u2[k] - v->s[0] * t->w2[k],
                              v->w[0] * t->s2[k] - v->u[0] * t->c2[k]};
    vd stance = zero, swing = zero;
    for (int j = k; j >= 1; j--) {
        const int i = k + 1 - j, h = k - j;
        const vd dc = vd_hold(v->c[j]), c = vd_hold(t->c[j]), w = vd_hold(t->ws[i]),
                 dw = vd_hold(v->ws[i]);
        sum.cw = sum.cw + dc * w + c * dw;
        sum.stance = sum.stance + dc * t->u2[h] + c * v->u2[h];
        const vd ds = vd_hold(v->s[j]), s = vd_hold(t->s[j]);
        sum.sw = sum.sw + ds * w + s * dw;
        stance = stance + ds * t->w2[h] + s * v->w2[h];
    }
    for (int j = k; j >= 1; j--) {
        const int i = k + 1 - j, h = k - j;
        const vd dw = vd_hold(v->w[j]), w = vd_hold(t->w[j]), rate = vd_hold(t->wn[i]),
                 change = vd_hold(v->wn[i]);
        sum.ww = sum.ww + dw * rate + w * change;
        sum.swing = sum.swing + dw * t->s2[h] + w * v->s2[h];
        const vd du = vd_hold(v->u[j]), u = vd_hold(t->u[j]);
        sum.uw = sum.uw + du * rate + u * change;
        swing = swing + du * t->c2[h] + u * v->c2[h];
    }
    sum.cw = sum.cw + v->c[k + 1] * t->ws[0];
    sum.sw = sum.sw + v->s[k + 1] * t->ws[0];
    sum.ww = sum.ww + v->w[k + 1] * t->wn[0];
    sum.uw = sum.uw + v->u[k + 1] * t->wn[0];
    sum.stance = sum.stance - stance;
    sum.swing = sum.swing - swing;
    return sum;
}

LANE_INLINE void variation_next(const struct taylor *t, struct variation *v,
                                const struct flight_walker *walker, int k)
{
    const struct taylor_sums sum = variation_convolve(t, v, k);
    const double n = (double)(k + 1);
    const vd s2 = n * sum.cw, c2 = -n * sum.sw, u2 = n * sum.ww, w2 = -n * sum.uw;
    const vd stance =
        walker->weight * v->s[k] + walker->half_leg * (sum.stance + (t->c[0] * u2 - t->s[0] * w2));
    const vd swing = 2.0 * (sum.swing + (t->w[0] * s2 - t->u[0] * c2) - v->u[k]);
    const vd alpha = stance * t->alpha_by_stance + swing * t->alpha_by_swing;
    const vd beta = stance * t->beta_by_stance + swing * t->beta_by_swing;

    const double once = taylor_inverse[k + 1], twice = once * taylor_inverse[k + 2];
    v->ws[k + 1] = alpha * once;
    v->wn[k + 1] = beta * once;
    v->s2[k] = s2 + t->c[0] * alpha;
    v->c2[k] = c2 - t->s[0] * alpha;
    v->u2[k] = u2 + t->w[0] * beta;
    v->w2[k] = w2 - t->u[0] * beta;
    v->s[k + 2] = v->s2[k] * twice;
    v->c[k + 2] = v->c2[k] * twice;
    v->u[k + 2] = v->u2[k] * twice;
    v->w[k + 2] = v->w2[k] * twice;
}

/* Moves one direction's variation dx from the start of the expansion t to a time h after it. */
LANE_INLINE void variation_move(const struct taylor *t, const struct flight_walker *walker, vd h,
                                struct flight_state *dx)
{
    struct variation v;
    v.ws[0] = dx->ws;
    v.wn[0] = dx->wn;
    v.s[0] = t->c[0] * dx->ts;
    v.c[0] = -t->s[0] * dx->ts;
    v.u[0] = t->w[0] * dx->tn;
    v.w[0] = -t->u[0] * dx->tn;
    v.s[1] = t->c[0] * dx->ws + v.c[0] * t->ws[0];
    v.c[1] = -t->s[0] * dx->ws - v.s[0] * t->ws[0];
    v.u[1] = t->w[0] * dx->wn + v.w[0] * t->wn[0];
    v.w[1] = -t->u[0] * dx->wn - v.u[0] * t->wn[0];
    for (int k = 0; k + 2 <= t->order; k++) {
        variation_next(t, &v, walker, k);
    }
    const vd zero = vd_all(0.0);
    vd ts = zero, tn = zero, ws = zero, wn = zero;
    for (int k = t->order - 1; k >= 0; k--) {
        ts = ts * h + v.ws[k] * taylor_inverse[k + 1];
        tn = tn * h + v.wn[k] * taylor_inverse[k + 1];
        ws = ws * h + v.ws[k];
        wn = wn * h + v.wn[k];
    }
    dx->ts = dx->ts + ts * h;
    dx->tn = dx->tn + tn * h;
    dx->ws = ws;
    dx->wn = wn;
}

#endif
