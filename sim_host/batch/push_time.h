/* How long double support lasts: t = integral of dr / r' from 0 to r0, r'^2 known in closed form.
 *
 * Where the ankle starts slowly (or, clamped, from rest) 1/r' is steep or infinite at r = 0. With
 * r' ~ sqrt(y0 + y1 r) there, r = s^2 - y0/y1 makes the integrand smooth; Gauss-Legendre on panels does the
 * rest, twice as many until two answers agree.
 */
#ifndef SIM_HOST_BATCH_PUSH_TIME_H
#define SIM_HOST_BATCH_PUSH_TIME_H

#include "sim_host/batch/push_off.h"

#define PUSH_TIME_NODES 6 /* pairs: twelve nodes a panel, exact to degree 23 */
#define PUSH_TIME_MAX_PANELS 256
#define PUSH_TIME_SETTLED 1e-11 /* relative */

/* Nodes and weights of twelve-point Gauss-Legendre quadrature on [-1, 1] (Abramowitz and Stegun, table 25.4). */
static const double push_time_node[PUSH_TIME_NODES] = {
    0.125233408511468915472441369464, 0.367831498998180193752691536644,
    0.587317954286617447296702418941, 0.769902674194304687036893833213,
    0.904117256370474856678465866119, 0.981560634246719250690549090149};
static const double push_time_weight[PUSH_TIME_NODES] = {
    0.249147045813402785000562436043, 0.233492536538354808760849898925,
    0.203167426723065921749064455810, 0.160078328543346226334652529543,
    0.106939325995318430960254718194, 0.047175336386511827194615961485};

/* r'^2 at an extension r. */
LANE_INLINE vd push_rate_squared(const struct push *push, vd r)
{
    const vd trailing = 1.0 + r, sides = 2.0 + r;
    const vd heron =
        (sides + push->step) * (sides - push->step) * (push->step + r) * (push->step - r);
    const vd share = 1.0 - 0.5 / trailing;
    const vd squared = share * share;
    const vd mass =
        (1.0 + 0.25 * push->leg + push->leg * squared) * (4.0 * trailing * trailing) / heron +
        push->leg * (1.0 - squared);
    return 2.0 * push_kinetic(push, r) / mass;
}

/* The integral in s from low to high, in `panels` panels, of 2 s / r'(s^2 - shift). */
LANE_INLINE vd push_time_sum(const struct push *push, vd low, vd high, vd shift, int panels)
{
    const vd half = (high - low) * (0.5 / (double)panels);
    vd sum = vd_all(0.0);
    for (int p = 0; p < panels; p++) {
        const vd middle = low + half * (double)(2 * p + 1);
        for (int i = 0; i < PUSH_TIME_NODES; i++) {
            const vd a = middle - half * push_time_node[i], b = middle + half * push_time_node[i];
            const vd at_a = a / vd_sqrt(push_rate_squared(push, a * a - shift));
            const vd at_b = b / vd_sqrt(push_rate_squared(push, b * b - shift));
            sum = sum + push_time_weight[i] * (at_a + at_b);
        }
    }
    return 2.0 * half * sum;
}

/* Duration in sqrt(l/g), for the lanes of `wanted`; others may hold anything. Good to 1e-10 unless r'
 * nearly vanishes on the way or at its end. */
LANE_INLINE vd push_time(const struct push *push, vi wanted)
{
    const vd zero = vd_all(0.0);
    const vd y0 = vd_max(push_rate_squared(push, zero), zero);
    /* A slope over a short stretch serves: any shift near the singularity does. */
    const vd near = push->rest * (1.0 / 64.0);
    const vd y1 = (push_rate_squared(push, near) - y0) / near;
    const vi rising = (y1 * push->rest > 0.01 * y0) & (y1 > zero);
    const vd shift = vd_pick(rising, y0 / y1, push->rest * 100.0);
    const vd low = vd_sqrt(shift), high = vd_sqrt(shift + push->rest);
    wanted &= push->rest > zero;
    vd time = push_time_sum(push, low, high, shift, 1);
    for (int panels = 2; panels <= PUSH_TIME_MAX_PANELS && vi_any(wanted); panels *= 2) {
        const vd finer = push_time_sum(push, low, high, shift, panels);
        const vi settled = vd_abs(finer - time) <= PUSH_TIME_SETTLED * finer;
        time = vd_pick(wanted, finer, time);
        wanted &= ~settled;
    }
    return vd_pick(push->rest > zero, time, zero);
}

#endif
