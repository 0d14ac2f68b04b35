/* A vector of numbers with their derivatives in n directions, n known when compiled: 0 costs nothing. */
#ifndef SIM_HOST_BATCH_DUAL_H
#define SIM_HOST_BATCH_DUAL_H

#include "sim_host/batch/block.h"
#include "sim_host/batch/lanes_trig.h"

struct dual {
    vd v, d[BATCH_DIRECTIONS];
};

LANE_INLINE struct dual dual_all(vd x, int n)
{
    struct dual y;
    y.v = x;
    for (int i = 0; i < n; i++) {
        y.d[i] = vd_all(0.0);
    }
    return y;
}

LANE_INLINE struct dual dual_add(struct dual a, struct dual b, int n)
{
    a.v = a.v + b.v;
    for (int i = 0; i < n; i++) {
        a.d[i] = a.d[i] + b.d[i];
    }
    return a;
}

LANE_INLINE struct dual dual_sub(struct dual a, struct dual b, int n)
{
    a.v = a.v - b.v;
    for (int i = 0; i < n; i++) {
        a.d[i] = a.d[i] - b.d[i];
    }
    return a;
}

LANE_INLINE struct dual dual_mul(struct dual a, struct dual b, int n)
{
    for (int i = 0; i < n; i++) {
        a.d[i] = a.d[i] * b.v + a.v * b.d[i];
    }
    a.v = a.v * b.v;
    return a;
}

/* factor * a + offset, with constants. */
LANE_INLINE struct dual dual_line(vd factor, struct dual a, vd offset, int n)
{
    a.v = factor * a.v + offset;
    for (int i = 0; i < n; i++) {
        a.d[i] = factor * a.d[i];
    }
    return a;
}

/* value, whose derivative by a is slope. */
LANE_INLINE struct dual dual_chain(struct dual a, vd value, vd slope, int n)
{
    a.v = value;
    for (int i = 0; i < n; i++) {
        a.d[i] = slope * a.d[i];
    }
    return a;
}

LANE_INLINE struct dual dual_inverse(struct dual a, int n)
{
    const vd y = 1.0 / a.v;
    return dual_chain(a, y, -(y * y), n);
}

LANE_INLINE struct dual dual_sqrt(struct dual a, int n)
{
    const vd y = vd_sqrt(a.v);
    return dual_chain(a, y, 0.5 / y, n);
}

/* The angle whose sine is a and whose cosine is root.v. */
LANE_INLINE struct dual dual_asin(struct dual a, struct dual root, int n)
{
    return dual_chain(a, vd_asin(a.v, root.v), 1.0 / root.v, n);
}

#endif
